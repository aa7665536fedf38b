// Tightly converged states of slightly different robots, for testing gradients.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "simulation/gradient/variation.hpp"
#include "simulation/linearisation/test_parameters.hpp"
#include "simulation/linearisation/test_robots.hpp"

namespace pliant::sim::testing {

/// True if all cables that are driven by length pull, or are slack and no longer than prescribed.
inline bool can_be(const Equilibrium& system, const Controls& controls, const State& state) {
    for (std::size_t a = 0; a < system.actuators().size(); ++a) {
        const Actuator& actuator = system.actuators()[a];
        if (!actuator.only_pulls() || controls.drives[a].kind != Drive::Kind::measure) continue;
        const double tension = state.multiplier[static_cast<Eigen::Index>(a)];
        const double length = actuator.measure(linalg::view(state.x), controls.shares[a]);
        if (tension < 0 || (tension == 0 && length > controls.drives[a].value)) return false;
    }
    return true;
}

/// The equilibrium at these controls near an initial guess, by plain Newton iterations with the exact tangent. False
/// also if a cable would have to push, or is slack where it should pull.
inline bool converge(const Equilibrium& system, const Controls& controls, State& state) {
    system.place_supports(controls, state.x);
    double before = 1e300;
    for (int k = 0; k < 30; ++k) {
        auto at = Linearisation::create(system, state, controls);
        if (!at) return false;
        state.multiplier = at->state().multiplier;
        const auto step = at->solve(at->equations(state, controls));
        if (!step) return false;
        const Change change = at->change_of(*step);
        state.x -= change.positions;
        for (const std::size_t a : at->solved())
            state.multiplier[static_cast<Eigen::Index>(a)] -= change.multipliers[static_cast<Eigen::Index>(a)];
        for (const std::size_t a : at->solved()) {
            if (at->is_slack(a)) state.multiplier[static_cast<Eigen::Index>(a)] = 0;  // remove rounding errors
        }
        const double size = change.positions.norm();
        if (size < 1e-14 * state.x.norm() || (k > 3 && size > 0.5 * before))
            return size < 1e-11 * state.x.norm() && can_be(system, controls, state);
        before = size;
    }
    return false;
}

/// From a guess that may be far away.
inline State settled_from(const Equilibrium& system, const Controls& controls, State state) {
    const FactoredLaplacian laplacian(system);
    SolverChain solvers = make_chain(Solver::newton, system, laplacian);
    Progress silent;
    system.place_supports(controls, state.x);
    const StepOutcome outcome = solvers.solve(system, controls, {1e-8, 100}, state, silent);
    REQUIRE_MESSAGE(outcome.converged, outcome.reason);
    state.multiplier = outcome.evaluation.multiplier;
    REQUIRE(converge(system, controls, state));
    return state;
}

/// The controls of a robot at the state under test.
using ControlsOf = std::function<Controls(Equilibrium&)>;

/// Measures of a modified robot, converged anew; NaN if that fails.
inline Eigen::VectorXd values_of(const Equilibrium& system, const Controls& controls, State state,
                                 const std::vector<Measure>& measures) {
    Eigen::VectorXd values = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(measures.size()), std::nan(""));
    if (!converge(system, controls, state)) return values;
    for (std::size_t k = 0; k < measures.size(); ++k)
        values[static_cast<Eigen::Index>(k)] = slope(system, state, controls, measures[k]).value;
    return values;
}

/// Magnitude of each measure: for reactions, which may largely cancel, the sum of the magnitudes of their terms.
inline Eigen::VectorXd sizes_of(const Linearisation& at, const std::vector<Slope>& slopes) {
    const Eigen::VectorXd forces = at.system().evaluate(at.state(), at.controls()).out_of_balance.cwiseAbs();
    Eigen::VectorXd sizes(static_cast<Eigen::Index>(slopes.size()));
    for (std::size_t k = 0; k < slopes.size(); ++k) {
        double& size = sizes[static_cast<Eigen::Index>(k)];
        size = std::fabs(slopes[k].value);
        if (slopes[k].state.by_forces.size() > 0)
            size = std::max(size, slopes[k].state.by_forces.head(forces.size()).cwiseAbs().dot(forces));
    }
    return sizes;
}

/// Largest error of derivatives (measures) against differences, each relative to its own size or, where rounding hides
/// that, to the change of the measure if the number changed by its full size.
inline double gradient_error(const Eigen::VectorXd& told, const Eigen::VectorXd& sizes, double size,
                             const std::function<Eigen::VectorXd(double change)>& values_at) {
    constexpr double clearly_right = 1e-7;  // small enough: no shorter step is tried
    std::vector<double> best(static_cast<std::size_t>(told.size()), 1e300);
    const auto worst = [&] { return *std::max_element(best.begin(), best.end()); };
    for (double h = 0.02 * size; h > 2e-7 * size && worst() > clearly_right; h /= 8) {
        const Eigen::VectorXd by_difference = difference(values_at, h);
        for (Eigen::Index k = 0; k < told.size(); ++k) {
            const double hidden = 1e-5 * sizes[k] / size;
            const double beside = std::max({std::fabs(by_difference[k]), hidden, 1e-300});
            double& least = best[static_cast<std::size_t>(k)];
            const double error = std::fabs(told[k] - by_difference[k]) / beside;
            if (error < least) least = error;
        }
    }
    return worst();
}

/// Everything that can be measured on a robot, forces and positions along some direction.
inline std::vector<Measure> all_measures(const Description& d) {
    using Kind = Measure::Kind;
    std::vector<Measure> all;
    const Vec3 some{0.3, -0.5, 0.8};
    for (std::size_t k = 0; k < d.markers.size(); ++k) all.push_back({Kind::marker, k, some});
    for (std::size_t k = 0; k < d.cables.size(); ++k) {
        for (const Kind kind : {Kind::tension, Kind::length, Kind::length_ratio}) all.push_back({kind, k});
    }
    for (std::size_t k = 0; k < d.chambers.size(); ++k) {
        for (const Kind kind : {Kind::pressure, Kind::volume, Kind::volume_ratio}) all.push_back({kind, k});
    }
    for (std::size_t k = 0; k < d.pressures.size(); ++k) all.push_back({Kind::pressure, k, {}, {}, true});
    for (std::size_t k = 0; k < d.springs.size(); ++k) {
        for (const Kind kind : {Kind::spring_length, Kind::spring_force}) all.push_back({kind, k});
    }
    for (std::size_t k = 0; k < d.supports.size(); ++k) all.push_back({Kind::reaction, k, some});
    if (!d.contact) return all;
    for (std::size_t k = 0; k < d.contact->obstacles.size(); ++k) all.push_back({Kind::contact_force, k, some});
    if (d.contact->settings.self) all.push_back({Kind::self_contact});
    return all;
}

}  // namespace pliant::sim::testing
