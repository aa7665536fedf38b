// What is printed: texts for people without control characters, JSON for programs always in UTF-8.
#pragma once

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace pliant::app {

/// On one line: control characters, as a file's name or a table's cell may hold, are written as \x1b, \n and the like,
/// so that they reach no terminal.
[[nodiscard]] std::string one_line(std::string_view text);
/// The same for a text of several lines, which stay.
[[nodiscard]] std::string visible_lines(std::string_view text);

/// `indent`: -1 for one line. Bytes that are not UTF-8, as in the name of a file, are replaced.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = 1) {
    return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

template <class Json>
void print_json(const Json& json, int indent = 1) {
    fmt::print("{}\n", json_text(json, indent));
}

}  // namespace pliant::app
