// Drucker's criterion, as Abaqus checks it: for an incompressible body with logarithmic strains (e1, e2), the matrix of
// d(s_i - s_3) / d e_j, s the true stresses, must be positive definite.
#include <Eigen/Dense>
#include <cmath>

#include "simulation/calibrate/fit.hpp"
#include "simulation/material/response.hpp"

namespace pliant::calibrate {
namespace {

Eigen::Vector2d stress_differences(const material::Law& law, const Eigen::Vector2d& e) {
    const Eigen::Vector3d l(std::exp(e[0]), std::exp(e[1]), std::exp(-e[0] - e[1]));
    const material::Matrix3 P = material::stress(law, l.asDiagonal());
    const double third = P(2, 2) * l[2];
    return {P(0, 0) * l[0] - third, P(1, 1) * l[1] - third};
}

bool stable(const material::Law& law, const Eigen::Vector2d& e) {
    const double h = 1e-5;
    Eigen::Matrix2d D;
    for (int j = 0; j < 2; ++j) {
        Eigen::Vector2d step = Eigen::Vector2d::Zero();
        step[j] = h;
        D.col(j) = (stress_differences(law, e + step) - stress_differences(law, e - step)) / (2 * h);
    }
    return D.trace() > 0 && D.determinant() > 0;
}

struct Loading {
    const char* name;
    double second;  ///< e2 over e1
};

}  // namespace

std::vector<std::string> unstable_ranges(const material::Law& law, double low, double high) {
    constexpr Loading loadings[] = {{"pull or push", -0.5}, {"balloon (equal in two directions)", 1}, {"planar", 0}};
    constexpr int samples = 200;
    std::vector<std::string> found;
    for (const Loading& loading : loadings) {
        double first = 0;
        double last = 0;
        for (int i = 0; i <= samples; ++i) {
            const double l = low + (high - low) * i / samples;
            const double e = std::log(l);
            if (stable(law, {e, loading.second * e})) continue;
            if (first == 0) first = l;
            last = l;
        }
        if (first != 0)
            found.push_back(
                fmt::format("not stable (Drucker) under {} at stretches {:.2f} to {:.2f}", loading.name, first, last));
    }
    return found;
}

}  // namespace pliant::calibrate
