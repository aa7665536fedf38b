// Features narrower than a resin can print.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// A thin feature of one material.
struct ThinSpot {
    int layer = 0, last_layer = 0, material = 0;
    std::int64_t pixels = 0;                                           ///< in the layer where it is largest
    int row = 0, column = 0;                                           ///< of the first pixel in the first layer
    int first_row = 0, end_row = 0, first_column = 0, end_column = 0;  ///< its box in the last layer
};

/// Pixels of at least half light outside all discs of diameter `least_um` that fit inside the material's image: walls
/// narrower than that and tips sharper than about 60 degrees; one spot for each connected piece. At any angle, a wall
/// that is narrower by a pixel is found, and one that is not narrower is not. With r the disc's radius: the image minus
/// the image shrunk by r and grown by 2 r, in quarters of a pixel. Cost: the runs times r; diameters of a pixel find
/// nothing.
[[nodiscard]] std::vector<ThinSpot> thin_spots(const ComposedLayer& layer, int k, double least_um,
                                               const Raster& raster);

/// Those of all layers, in order, each feature once: pieces of layers one above the other whose boxes overlap.
[[nodiscard]] std::vector<ThinSpot> joined(const std::vector<ThinSpot>& spots);

/// One line per material: how many features, the layers, and the place of the largest area.
[[nodiscard]] std::vector<std::string> describe(const std::vector<ThinSpot>& features,
                                                const std::vector<std::string>& materials, double least_um,
                                                const Raster& raster);

}  // namespace pliant::slice
