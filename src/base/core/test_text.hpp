// Text helpers for tests: search, and replacing a word.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <string_view>

namespace pliant::test {

inline bool holds(std::string_view text, std::string_view part) {
    return text.find(part) != std::string_view::npos;
}

/// `text` with the first `from`, which must occur, replaced by `to`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE_MESSAGE(at != std::string::npos, from);
    return text.replace(at, from.size(), to);
}

}  // namespace pliant::test
