// A polyline as a closed tube of triangles.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::report {

struct Tube {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;                  ///< unit
    std::vector<std::array<int, 3>> triangles;  ///< the same for every polyline of as many points
};

/// A tube of 10 sides with flat caps. At least two points; segments of zero length take the direction of a neighbour.
[[nodiscard]] Tube tube_around(std::span<const Vec3> points, double radius_m);

}  // namespace pliant::report
