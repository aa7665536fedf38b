// Character classes of file formats: ASCII only, whatever the locale.
#pragma once

#include <string>
#include <string_view>

namespace pliant {

[[nodiscard]] constexpr bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
[[nodiscard]] constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Line ends, escapes and the like.
[[nodiscard]] constexpr bool is_control(char c) {
    return static_cast<unsigned char>(c) < ' ' || c == 127;
}

/// A text from elsewhere, such as a name, that can neither end a comment nor move a terminal's cursor: control
/// characters become blanks.
[[nodiscard]] inline std::string one_line(std::string_view text) {
    std::string line(text);
    for (char& c : line) c = is_control(c) ? ' ' : c;
    return line;
}

[[nodiscard]] inline std::string lower_case(std::string_view text) {
    std::string out(text);
    for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return out;
}

/// Without leading and trailing blanks, tabs and line ends.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n";
    const std::size_t begin = text.find_first_not_of(blanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

}  // namespace pliant
