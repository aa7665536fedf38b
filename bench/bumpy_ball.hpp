// A body of many triangles for the benchmarks of slicing.
#pragma once

#include <cmath>
#include <numbers>

#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::bench {

/// A ball with bumps, closed, 2 * around * (down - 1) triangles; in the unit of `radius`.
inline mesh::TriMesh bumpy_ball(int around, int down, double radius) {
    mesh::TriMesh mesh;
    mesh.points = {{0, 0, -radius}, {0, 0, radius}};
    const auto point = [&](int i, int j) { return i == 0 ? 0 : i == down ? 1 : 2 + (i - 1) * around + j % around; };
    for (int i = 1; i < down; ++i) {
        for (int j = 0; j < around; ++j) {
            const double t = std::numbers::pi * i / down, p = 2 * std::numbers::pi * j / around;
            const double s = std::sin(t);
            const double r = radius * (1 + 0.1 * s * s * s * std::cos(9 * p) * std::sin(7 * t));
            mesh.points.push_back({r * s * std::cos(p), r * s * std::sin(p), -radius * std::cos(t)});
        }
    }
    for (int i = 0; i < down; ++i) {
        for (int j = 0; j < around; ++j) {
            const int a = point(i, j), b = point(i, j + 1), c = point(i + 1, j + 1), d = point(i + 1, j);
            if (i > 0) mesh.triangles.push_back({a, b, c});
            if (i < down - 1) mesh.triangles.push_back({a, c, d});
        }
    }
    return mesh;
}

}  // namespace pliant::bench
