// A token that stays: for a studio whose address should be the same after a restart.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"

namespace pliant::studio {

/// The token in the file, which is made with a random one, for its owner alone, where there is none. Errors: a file
/// that others than its owner and its group can read; a token that is not 16 to 256 letters and digits; a file that
/// cannot be read or made.
[[nodiscard]] Result<std::string> read_or_make_token(const std::filesystem::path& file);

}  // namespace pliant::studio
