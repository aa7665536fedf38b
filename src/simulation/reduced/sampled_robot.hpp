// A robot of a few of its tets, each of which counts as often as its weight says: hyper-reduction.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/parts/description.hpp"
#include "simulation/reduced/sparse_weights.hpp"

namespace pliant::sim::reduced {

/// Errors: what a reduced model does not cover; in one line, which names it.
[[nodiscard]] Status check_reducible(const Description& d);

struct SampledRobot {
    Description description;  ///< with everything that acts on nodes, without supports, contact and sensors
    /// What each of its nodes moves with in the whole robot: one node or, where a cable, load or marker is attached to
    /// many, their weighted mean.
    std::vector<Attachment> nodes;
};

/// `tets`: columns are indices of tets. Precondition: check_reducible().
[[nodiscard]] SampledRobot sampled_robot(const Description& d, const std::vector<Weight>& tets);

}  // namespace pliant::sim::reduced
