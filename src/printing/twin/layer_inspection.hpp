// Compares the layers of a job with those of the block, in order: volumes, pixels, heights and areas for the report.
#pragma once

#include <string>

#include "printing/twin/inspect.hpp"

namespace pliant::twin {

/// Properties of a job's images.
struct ImageKind {
    bool exact = true;  ///< pixels are coverage; otherwise light for a projector with `grey` or a mask
    bool grey = false;  ///< some pixels are neither full nor dark
};

/// Fills in the report's figures on layers, pixels and images, and the volumes of its materials (one for each of the
/// job's). Errors: an image is unavailable.
[[nodiscard]] Result<ImageKind> inspect_layers(Report& report, Twin& twin, const job::Manifest& job,
                                               const RunSource& images, double light_slack_s);

/// Records the first deviation of the print; later ones are ignored. `material` below 0: none.
void note_first(Report& report, const job::Manifest& job, int layer, int material, const std::string& what);

}  // namespace pliant::twin
