// Where a printer's images and its platform are: as the slicer and the checks of jobs take them.
#pragma once

#include "printing/job/platform_edge.hpp"
#include "printing/machine/printer.hpp"
#include "printing/slice/body.hpp"

namespace pliant::machine {

[[nodiscard]] slice::Raster raster_of(const Projector& projector);

/// Of the printer's platform in its image.
[[nodiscard]] job::PlatformEdge platform_edge(const Printer& printer);

}  // namespace pliant::machine
