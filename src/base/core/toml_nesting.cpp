#include "base/core/toml_nesting.hpp"

#include <algorithm>
#include <string>

namespace pliant::config {
namespace {

constexpr int most_brackets = 128;
constexpr int most_dots = 32;

/// The position after the string that begins at `at`; one of a single line ends with its line at the latest.
std::size_t after_string(std::string_view text, std::size_t at) {
    const char quote = text[at];
    const std::string three(3, quote);
    const bool long_one = text.substr(at, 3) == three;
    for (at += long_one ? 3 : 1; at < text.size(); ++at) {
        if (quote == '"' && text[at] == '\\')
            ++at;  // whatever follows belongs to the string
        else if (long_one && text.substr(at, 3) == three)
            return std::min(text.find_first_not_of(quote, at), text.size());
        else if (!long_one && (text[at] == quote || text[at] == '\n'))
            return at + 1;
    }
    return text.size();
}

}  // namespace

Nesting nesting_of(std::string_view text) {
    Nesting deepest;
    int brackets = 0, dots = 0;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '"' || c == '\'') {
            at = after_string(text, at);
            continue;
        }
        if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
            continue;
        }
        if (c == '.') deepest.dots = std::max(deepest.dots, ++dots);
        if (c == '[' || c == '{') deepest.brackets = std::max(deepest.brackets, ++brackets);
        if (c == ']' || c == '}') brackets = std::max(0, brackets - 1);
        if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) dots = 0;
        ++at;
    }
    return deepest;
}

bool nested_too_deep(std::string_view toml) {
    const Nesting nesting = nesting_of(toml);
    return nesting.brackets > most_brackets || nesting.dots > most_dots;
}

}  // namespace pliant::config
