// "1 layer", "2 layers".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pliant {

/// A count and its noun, for one and for several.
[[nodiscard]] inline std::string counted(std::size_t count, std::string_view one, std::string_view several) {
    return std::to_string(count) + " " + std::string(count == 1 ? one : several);
}
/// The plural adds an s.
[[nodiscard]] inline std::string counted(std::size_t count, std::string_view word) {
    return counted(count, word, std::string(word) + "s");
}

}  // namespace pliant
