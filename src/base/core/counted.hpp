// "1 layer", "2 layers".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pliant {

/// A count and its noun; the plural adds an s.
[[nodiscard]] inline std::string counted(std::size_t count, std::string_view word) {
    return std::to_string(count) + " " + std::string(word) + (count == 1 ? "" : "s");
}

}  // namespace pliant
