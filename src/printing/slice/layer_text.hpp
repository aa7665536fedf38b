// How texts for people name layers. Indices, files and interfaces count from 0, people from 1.
#pragma once

#include <fmt/format.h>

#include <string>

namespace pliant::slice {

/// "layer 5" for the layer of index 4.
[[nodiscard]] inline std::string layer_text(int layer) {
    return fmt::format("layer {}", layer + 1);
}

/// "layers 5 to 8" for those of index 4 to 7, "layer 5" if that is the only one.
[[nodiscard]] inline std::string layers_text(int first, int last) {
    return first == last ? layer_text(first) : fmt::format("layers {} to {}", first + 1, last + 1);
}

}  // namespace pliant::slice
