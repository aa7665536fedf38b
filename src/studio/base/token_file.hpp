// A persistent token, for a studio whose address should stay the same after a restart.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"

namespace pliant::studio {

/// Reads the token from the file; if there is no file it is created with a random token, readable by its owner alone.
/// Errors: a file that others than its owner and group can read; a token that is not 16 to 256 letters and digits; a
/// file that cannot be read or created.
[[nodiscard]] Result<std::string> read_or_make_token(const std::filesystem::path& file);

}  // namespace pliant::studio
