// Which start of the computer this is.
#pragma once

#include <optional>
#include <string>

namespace pliant {

/// Identifies the boot of the computer; empty if the system does not say.
[[nodiscard]] std::optional<std::string> boot_name();

}  // namespace pliant
