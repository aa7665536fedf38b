// JSON as text and from text. The parser and the printer of nlohmann-json are large templates: they are compiled once,
// here, and not in every file that reads or writes JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace pliant {

/// `indent`: -1 for one line. Bytes that are not UTF-8, as in the name of a file, become U+FFFD.
[[nodiscard]] std::string json_text(const nlohmann::json& json, int indent = -1);
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent = -1);

/// A discarded value (`is_discarded()`), which is no object, no list and no number, if the text is not JSON.
[[nodiscard]] nlohmann::json parse_json(std::string_view text);
/// The same; the keys of objects stay in their order.
[[nodiscard]] nlohmann::ordered_json parse_ordered_json(std::string_view text);

}  // namespace pliant
