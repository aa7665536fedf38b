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

}  // namespace pliant
