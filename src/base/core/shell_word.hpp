// A text as one word of a command that a person pastes into a shell.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "base/core/process.hpp"

namespace pliant {

/// In single quotes unless it is plain.
inline std::string shell_word(const std::string& text) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
               std::string_view("_-./:,+=@%").find(c) != std::string_view::npos;
    };
    return !text.empty() && std::all_of(text.begin(), text.end(), is_plain) ? text : in_shell_quotes(text);
}

}  // namespace pliant
