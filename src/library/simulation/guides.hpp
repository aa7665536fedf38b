// The guide points that a gradient is wanted by.
#pragma once

#include <vector>

#include "library/simulation/data.hpp"
#include "simulation/gradient/variation.hpp"

namespace pliant::library {

struct Guides {
    std::vector<GuidePoint> shown;
    std::vector<sim::GuidePoint> points;
};

/// Throws where one is tied to no tetrahedron.
[[nodiscard]] Guides guides_of(const Model::Data& model);

}  // namespace pliant::library
