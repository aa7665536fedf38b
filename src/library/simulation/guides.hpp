// The guide points for gradients.
#pragma once

#include <vector>

#include "library/simulation/data.hpp"
#include "simulation/gradient/variation.hpp"

namespace pliant::library {

struct Guides {
    std::vector<GuidePoint> shown;
    std::vector<sim::GuidePoint> points;
};

/// Throws if one is not attached to a tetrahedron.
[[nodiscard]] Guides guides_of(const Model::Data& model);

}  // namespace pliant::library
