// Where a printer's images and its platform are: as the slicer and the checks of jobs take them.
#pragma once

#include <string>
#include <vector>

#include "printing/job/platform_edge.hpp"
#include "printing/machine/printer.hpp"
#include "printing/slice/body.hpp"

namespace pliant::machine {

[[nodiscard]] slice::Raster raster_of(const Projector& projector);

/// The keys by which images for one projector come out otherwise on the other, as in "mirror_x"; besides the number and
/// size of the pixels.
[[nodiscard]] std::vector<std::string> other_images(const Projector& a, const Projector& b);

/// Of the printer's platform in its image.
[[nodiscard]] job::PlatformEdge platform_edge(const Printer& printer);

}  // namespace pliant::machine
