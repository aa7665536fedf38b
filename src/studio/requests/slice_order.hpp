// Slicing requests of a page: JSON with the options of `pliant slice`, listed in docs/reference/studio.md.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/prepare/order.hpp"

namespace pliant::studio {

/// Errors name the key as the command-line option `--option`, so that the page finds its field: not an object, an
/// unknown key, a value of the wrong type. The values themselves are checked by prepare.
[[nodiscard]] Result<prepare::Order> read_slice_order(std::string_view json);

/// The robot text to slice instead of the one in the editor, key "robot"; nullopt without it. Errors: it is not a
/// string.
[[nodiscard]] Result<std::optional<std::string>> robot_text_of(std::string_view json);

/// The value of the key "printer", "tower" without it.
[[nodiscard]] Result<std::string> printer_name_of(std::string_view json);

}  // namespace pliant::studio
