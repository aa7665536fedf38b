// Texts that are one number and nothing else.
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

namespace pliant {

/// True if all of `text` is a number of this type, which `value` receives; whole numbers with the given base.
template <class Number, class... Base>
[[nodiscard]] bool parse_all(std::string_view text, Number& value, Base... base) {
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value, base...);
    return code == std::errc() && end == text.data() + text.size() && !text.empty();
}

/// A number without the plus sign that people write before it and std::from_chars does not read. That of "+-1" stays:
/// it is no number.
[[nodiscard]] constexpr std::string_view without_plus(std::string_view number) {
    const bool signed_once = number.size() > 1 && number[0] == '+' && number[1] != '-';
    return signed_once ? number.substr(1) : number;
}

}  // namespace pliant
