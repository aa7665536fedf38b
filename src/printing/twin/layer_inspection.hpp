// The layers of a job beside those of the block, in order: volumes, pixels, heights and areas for the report.
#pragma once

#include <string>

#include "printing/twin/inspect.hpp"

namespace pliant::twin {

/// What the images of a job are like.
struct ImageKind {
    bool exact = true;  ///< pixels are coverage; else light for a projector with `grey` or a mask
    bool grey = false;  ///< some pixels are neither full nor dark
};

/// Fills in what the report says of layers, pixels and images, and the volumes of its materials (one for each of the
/// job's). Errors: an image cannot be had.
[[nodiscard]] Result<ImageKind> inspect_layers(Report& report, Twin& twin, const job::Manifest& job,
                                               const RunSource& images, double light_slack_s);

/// Names the first deviation of the print; later ones change nothing. `material` below 0: of none.
void note_first(Report& report, const job::Manifest& job, int layer, int material, const std::string& what);

}  // namespace pliant::twin
