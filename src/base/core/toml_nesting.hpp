// How deep the tables and lists of a TOML text are nested, found without parsing it: toml++ and its tables work
// recursively, so that a small text with deep nesting would overflow the stack.
#pragma once

#include <string_view>

namespace pliant::config {

/// Bounds the depth of any node: each bracket adds a level, each dotted key one for each of its dots.
struct Nesting {
    int brackets = 0;  ///< open at the same time, at most
    int dots = 0;      ///< in one key, at most
};

/// Of valid TOML; of another text up to its first error.
[[nodiscard]] Nesting nesting_of(std::string_view toml);

/// True if a parser must not be given this text. No robot, printer, plan or study file comes near.
[[nodiscard]] bool nested_too_deep(std::string_view toml);

}  // namespace pliant::config
