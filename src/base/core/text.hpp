// Small helpers for messages.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace pliant {

/// Number of single-character insertions, deletions and replacements between two words (Levenshtein).
[[nodiscard]] int edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word` (none farther than half its length), or "".
[[nodiscard]] std::string nearest_name(std::string_view word, std::span<const std::string> candidates);

/// "a, b and c".
[[nodiscard]] std::string join_names(std::span<const std::string> names);

}  // namespace pliant
