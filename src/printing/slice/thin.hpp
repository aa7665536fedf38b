// Features that are narrower than what a resin holds.
#pragma once

#include <string>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// What is too thin in one layer of one material.
struct ThinSpot {
    int layer = 0, material = 0;
    std::int64_t pixels = 0;
    int row = 0, column = 0;  ///< of the first of them
};

/// Pixels of at least half light that no disc of diameter `least_um` inside the material's image comes near: walls
/// narrower than that and tips sharper than about 60 degrees. True to a pixel. With r the disc's radius: the image less
/// what the image shrunk by r, grown by 2 r, holds. Cost: the runs times r; less than two pixels find nothing.
[[nodiscard]] std::vector<ThinSpot> thin_spots(const ComposedLayer& layer, int k, double least_um,
                                               const Raster& raster);

/// One line per material: the layers, and where most of it is.
[[nodiscard]] std::vector<std::string> describe(const std::vector<ThinSpot>& spots,
                                                const std::vector<std::string>& materials, double least_um,
                                                const Raster& raster);

}  // namespace pliant::slice
