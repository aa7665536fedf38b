// Points at which integrals over the faces of tets are evaluated.
#pragma once

#include <array>
#include <cstddef>

namespace pliant::sim {

/// A point of an integration rule on a face of 3 or 6 nodes: shape functions and their derivatives along the sides u
/// (corner 0 to 1) and v (0 to 2).
struct FaceSample {
    double weight;  ///< sum 1/2 over the rule, the area of the reference triangle
    std::array<double, 6> N, Nu, Nv;
};

/// `b`: barycentric coordinates.
[[nodiscard]] inline FaceSample linear_sample(double weight, const std::array<double, 3>& b) {
    return {weight, {b[0], b[1], b[2]}, {-1, 1, 0}, {-1, 0, 1}};
}

[[nodiscard]] inline FaceSample quadratic_sample(double weight, const std::array<double, 3>& b) {
    constexpr std::array<double, 3> du = {-1, 1, 0};  // of the barycentric coordinates
    constexpr std::array<double, 3> dv = {-1, 0, 1};
    FaceSample s{weight, {}, {}, {}};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        s.N[i] = b[i] * (2 * b[i] - 1);
        s.Nu[i] = (4 * b[i] - 1) * du[i];
        s.Nv[i] = (4 * b[i] - 1) * dv[i];
        s.N[3 + i] = 4 * b[i] * b[j];
        s.Nu[3 + i] = 4 * (b[i] * du[j] + b[j] * du[i]);
        s.Nv[3 + i] = 4 * (b[i] * dv[j] + b[j] * dv[i]);
    }
    return s;
}

}  // namespace pliant::sim
