#include "simulation/stepper/inputs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

constexpr double cable_share = 0.04, chamber_share = 0.1;  // of the measure at rest
constexpr double strain_share = 0.01;                      // of the softest stiffness, for tensions and pressures

/// Largest stiffness of the softest material, not counting meshed space that actuators drive.
double softest_body_Pa(const Description& d) {
    double softest = std::numeric_limits<double>::infinity();
    for (std::size_t m = 0; m < d.materials.size(); ++m) {
        const auto is_space = [&](const Growth& growth) { return growth.material == static_cast<int>(m); };
        if (std::none_of(d.growths.begin(), d.growths.end(), is_space))
            softest = std::min(softest, material::stiffness_bound(d.materials[m].law));
    }
    return softest;
}

}  // namespace

Inputs between(const Inputs& from, const Inputs& to, double share) {
    if (share >= 1) return to;
    Inputs inputs = to;
    inputs.time = from.time + share * (to.time - from.time);
    for (std::size_t a = 0; a < to.drives.size(); ++a)
        inputs.drives[a].value = from.drives[a].value + share * (to.drives[a].value - from.drives[a].value);
    inputs.force_N = from.force_N + share * (to.force_N - from.force_N);
    return inputs;
}

InputUnits::InputUnits(const Equilibrium& system, double time_unit) : system_(system), time_unit_(time_unit) {
    const double softest = softest_body_Pa(system.model().description());
    const double length = std::cbrt(mesh::volume(system.model().mesh()));
    tension_N_ = strain_share * softest * length * length;
    pressure_Pa_ = strain_share * softest;
}

Eigen::VectorXd InputUnits::change(const Inputs& from, const Inputs& to) const {
    Eigen::VectorXd d(4 + static_cast<Eigen::Index>(to.drives.size()));
    d[0] = (to.time - from.time) / time_unit_;
    d.segment<3>(1) = (to.force_N - from.force_N) / tension_N_;
    for (std::size_t a = 0; a < to.drives.size(); ++a)
        d[4 + static_cast<Eigen::Index>(a)] = (to.drives[a].value - from.drives[a].value) / unit(a, to.drives[a].kind);
    return d;
}

double InputUnits::distance(const Inputs& from, const Inputs& to) const {
    const Eigen::VectorXd d = change(from, to);
    double most = std::fabs(d[0]);
    for (Eigen::Index k = 4; k < d.size(); ++k) most = std::max(most, std::fabs(d[k]));
    return most;
}

double InputUnits::onward_share(const Inputs& before, const Inputs& now, const Inputs& next) const {
    const Eigen::VectorXd last = change(before, now), coming = change(now, next);
    const double length = last.squaredNorm();
    if (!(length > 0) || !(coming.squaredNorm() > 0)) return 0;
    const double share = last.dot(coming) / length;
    const double aside = (coming - share * last).norm();
    constexpr double straight = 0.3, farthest = 4;
    return aside <= straight * coming.norm() && std::fabs(share) <= farthest ? share : 0;
}

double InputUnits::unit(std::size_t a, Drive::Kind kind) const {
    const bool cable = a < system_.cable_count();
    const double rest = system_.actuators()[a].rest_measure();
    switch (kind) {
        case Drive::Kind::measure:
            return (cable ? cable_share : chamber_share) * rest;
        case Drive::Kind::multiplier:
            return cable ? tension_N_ : pressure_Pa_;
        case Drive::Kind::gas:
            return chamber_share * system_.model().description().ambient_pressure_Pa * rest;
    }
    return 1;
}

}  // namespace pliant::sim
