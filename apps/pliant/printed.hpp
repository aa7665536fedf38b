// What is printed: texts for people without control characters, JSON for programs always in UTF-8.
#pragma once

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "base/core/json.hpp"

namespace pliant::app {

/// On one line: control characters, as a file's name or a table's cell may hold, are written as \x1b, \n and the like,
/// so that they reach no terminal.
[[nodiscard]] std::string one_line(std::string_view text);
/// The same for a text of several lines, which stay.
[[nodiscard]] std::string visible_lines(std::string_view text);

template <class Json>
void print_json(const Json& json, int indent = 1) {
    fmt::print("{}\n", json_text(json, indent));
}

}  // namespace pliant::app
