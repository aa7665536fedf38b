// Materials that come from one vat and are lit alike need one exposure, not one each.
#pragma once

#include <span>
#include <vector>

#include "printing/prepare/make_job.hpp"

namespace pliant::job {

/// The materials of a job, and as which of them each drawn material is printed.
struct PrintedTogether {
    std::vector<Material> materials;
    std::vector<int> printed_as;  ///< (drawn), index into `materials`
};

/// Puts materials of one resin together, in the order in which `drawn` first names them, where bottom exposure,
/// exposure, ExposureRule and compensation agree and none is part of a bond, whose pixels are lit twice on purpose.
/// What is put together is called "a+b" and has a, b as `parts`; the volumes and areas are theirs.
[[nodiscard]] PrintedTogether printed_together(std::span<const Material> drawn, const JobSettings& settings);

/// A layer with an image per printed material in place of one per drawn material.
void put_together(slice::ComposedLayer& layer, std::span<const int> printed_as);

}  // namespace pliant::job
