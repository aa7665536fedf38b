// A bar bent to an arc, for the tests of this module.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace pliant::sim::testing {

/// Positions (3n) along x, bent to an arc; plane cross-sections stay plane.
inline Eigen::VectorXd bent(const Eigen::VectorXd& rest, double radius_m) {
    Eigen::VectorXd x = rest;
    for (Eigen::Index i = 0; i < x.size(); i += 3) {
        const double angle = x[i] / radius_m, r = radius_m - x[i + 2];
        x[i] = r * std::sin(angle);
        x[i + 2] = radius_m - r * std::cos(angle);
    }
    return x;
}

}  // namespace pliant::sim::testing
