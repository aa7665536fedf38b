// Merges materials that share a vat and are exposed alike: they need one exposure, not one each.
#pragma once

#include <span>
#include <vector>

#include "printing/prepare/make_job.hpp"

namespace pliant::job {

/// The printed materials of a job, and which of them each drawn material becomes.
struct PrintedTogether {
    std::vector<Material> materials;
    std::vector<int> printed_as;  ///< (drawn), index into `materials`
};

/// Merges materials of one resin, in the order in which `drawn` first names them, if bottom exposure, exposure,
/// ExposureRule and compensation agree and none is part of a bond, whose pixels are exposed twice on purpose. The
/// merged material is called "a+b" and has a, b as `parts`; volumes and areas are summed.
[[nodiscard]] PrintedTogether printed_together(std::span<const Material> drawn, const JobSettings& settings);

/// Converts a layer from one image per drawn material to one per printed material.
void put_together(slice::ComposedLayer& layer, std::span<const int> printed_as);

}  // namespace pliant::job
