// What a page asks for when it slices: JSON with the options of `pliant slice` as docs/reference/studio.md lists them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/prepare/order.hpp"

namespace pliant::studio {

/// Errors name the key as `--option` of the command line, so that the page finds its field: no object, an unknown key,
/// a value of another type. What a text means is checked by prepare.
[[nodiscard]] Result<prepare::Order> read_slice_order(std::string_view json);

/// The text of a robot that is to be sliced in place of the one in the editor, key "robot"; nullopt without it. Errors:
/// it is no text.
[[nodiscard]] Result<std::optional<std::string>> robot_text_of(std::string_view json);

/// The value of the key "printer", "tower" without it.
[[nodiscard]] Result<std::string> printer_name_of(std::string_view json);

}  // namespace pliant::studio
