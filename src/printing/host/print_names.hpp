// How texts for people name layers and materials. Numbers in journals and interfaces count from 0, people from 1.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

namespace pliant::host {

/// "layer 5" for the layer of index 4.
[[nodiscard]] inline std::string layer_text(int layer) {
    return fmt::format("layer {}", layer + 1);
}

/// The material's name, or "material 2" for the index 1 where no name is known.
[[nodiscard]] inline std::string material_text(const std::vector<std::string>& names, int material) {
    const bool known = material >= 0 && static_cast<std::size_t>(material) < names.size();
    return known ? names[static_cast<std::size_t>(material)] : fmt::format("material {}", material + 1);
}

}  // namespace pliant::host
