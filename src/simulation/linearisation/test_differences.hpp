// Shared by the tests of linearisations: states of small robots, and finite differences to check derivatives against.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/friction_rounds.hpp"
#include "simulation/stepper/motion_in_time.hpp"

namespace pliant::sim::testing {

/// Numbers between -1 and 1, the same on every system.
class Noise {
public:
    explicit Noise(unsigned seed) : engine_(seed) {}
    double operator()() { return static_cast<double>(engine_()) / 2147483648.0 - 1; }
    Eigen::VectorXd vector(Eigen::Index size) {
        Eigen::VectorXd v(size);
        for (double& entry : v) entry = (*this)();
        return v;
    }

private:
    std::mt19937 engine_;
};

struct Settled {
    State state;
    Controls controls;
    int settled = 0;
};

/// Time step of the tether that holds a free robot at equilibrium, s.
inline constexpr double tether_s = 0.5;

/// The inertia of a step in time, or of a tether; null if neither is needed.
inline std::shared_ptr<const Inertia> step_inertia(const Model& model, const History& history, double dt,
                                                   const Damping* damping) {
    const bool is_free = !model.free_pieces().empty() || !model.objects().empty();
    if (damping != nullptr) return MotionInTime(model, *damping).inertia(history, dt);
    if (!is_free) return nullptr;
    return MotionInTime(model, {}).inertia(MotionInTime::still(history.x), tether_s);
}

/// The first steps of a program, of `dt` each, as long as they converge in a few iterations; with damping, in time.
/// `settled` counts them.
inline Settled settle(const Equilibrium& system, int steps, double dt, double tolerance,
                      const Damping* damping = nullptr) {
    const FactoredLaplacian laplacian(system);
    SolverChain solvers = make_chain(Solver::newton, system, laplacian);
    Progress silent;
    Settled last{system.rest(), system.controls(0), 0};
    History history = MotionInTime(system.model(), {}).at_rest(last.state.x);
    // Free pieces and objects have an equilibrium, and a tangent, only within a step.
    if (!system.model().free_pieces().empty() || !system.model().objects().empty())
        last.controls.inertia = step_inertia(system.model(), history, dt, damping);
    for (int step = 1; step <= steps; ++step) {
        Controls controls = system.controls(step * dt);
        controls.inertia = step_inertia(system.model(), history, dt, damping);
        State next = last.state;
        system.place_supports(controls, next.x);
        if (!system.evaluate(next, controls).possible() ||
            system.largest_step(last.state.x, next.x - last.state.x, last.controls,
                                controls.obstacles - last.controls.obstacles) < 1)
            return last;
        const std::vector<Drive> drives = system.controls((step - 1) * dt).drives;
        const bool converged = settle_friction(system, solvers, {tolerance, 30}, 5, {last.state, last.controls, drives},
                                               controls, next, silent)
                                   .converged;
        if (!converged) return last;
        history = damping != nullptr ? MotionInTime::after(*controls.inertia, next.x) : MotionInTime::still(next.x);
        last = {std::move(next), std::move(controls), step};
    }
    return last;
}

/// Largest relative errors of a linearisation.
struct Measured {
    double product = 0;    ///< against differences
    double transpose = 0;  ///< of <w, A v> against <A^T w, v>
    double solution = 0;   ///< |b - A x| / |b|, of both sides
    double input = 0;      ///< of dF/dp against differences
};

/// Relative error of two vectors of unknowns: the forces, and each other row, relative to their own size; at least
/// `least` (solved) for the other rows.
inline double relative_error(const Linearisation& at, const Eigen::VectorXd& measured, const Eigen::VectorXd& expected,
                             const Eigen::VectorXd& least) {
    const auto m = static_cast<Eigen::Index>(at.solved().size());
    const Eigen::Index n = at.size() - m;
    const auto share = [](double off, double of) { return off == 0 ? 0 : off / of; };
    double error = share((measured - expected).head(n).norm(), expected.head(n).norm());
    for (Eigen::Index k = n; k < at.size(); ++k)
        error = std::max(error,
                         share(std::fabs(measured[k] - expected[k]), std::max(std::fabs(expected[k]), least[k - n])));
    return error;
}

/// The smallest error of central differences over step sizes from `largest` down: large steps have truncation errors,
/// small ones rounding errors; a wrong derivative is wrong at all of them.
inline double best_error(double largest, const std::function<double(double step)>& error_of) {
    double best = 1e300;
    for (double step = largest; step > 1e-6 * largest; step /= 8) best = std::min(best, error_of(step));
    return best;
}

/// Four-point central difference: its error is of fourth order in the step.
inline Eigen::VectorXd difference(const std::function<Eigen::VectorXd(double)>& f, double h) {
    return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}

/// The state moved along a change.
inline State moved(const State& state, const Change& along, double step) {
    return {state.x + step * along.positions, state.multiplier + step * along.multipliers};
}

/// A random direction in the unknowns, or weights of the equations, of order 1 for the nodes; other entries are scaled
/// to have a comparable effect.
inline Eigen::VectorXd some_direction(const Linearisation& at, Side side, Noise& noise) {
    const auto multiply = [&](const Eigen::VectorXd& v) {
        return side == Side::direct ? at.multiply(v) : at.multiply_transposed(v);
    };
    const auto m = static_cast<Eigen::Index>(at.solved().size());
    const Eigen::Index n = at.size() - m;
    Eigen::VectorXd v = noise.vector(at.size());
    Eigen::VectorXd motion = v;
    motion.tail(m).setZero();
    const Eigen::VectorXd done = multiply(motion);
    for (Eigen::Index k = n; k < at.size(); ++k) {
        const Eigen::VectorXd own = multiply(Eigen::VectorXd::Unit(at.size(), k));
        const double force = own.head(n).norm();
        constexpr double any = 1e300;
        const double by_force = force > 0 ? done.head(n).norm() / force : any;
        // Sealed gas is strongly nonlinear if its pressure changes by more than its current value.
        const double by_row = own[k] != 0 && done[k] != 0 ? std::fabs(done[k] / own[k]) : any;
        const double size = std::min(by_force, by_row);
        v[k] *= size < any ? size : 1;  // a cable between held nodes has no effect
    }
    return at.unknowns_of(at.change_of(v));  // zero along directions held by rollers
}

inline Controls with_input(const Linearisation& at, const Parameter& p, double change, State& state) {
    using Kind = Parameter::Kind;
    const Equilibrium& system = at.system();
    const Description& d = system.model().description();
    Controls controls = at.controls();
    const auto actuator = [&] { return static_cast<Eigen::Index>(p.index); };
    switch (p.kind) {
        case Kind::length:
            controls.drives[p.index].value *= 1 + change / p.value;
            break;
        case Kind::volume:
        case Kind::gas:
            controls.drives[p.index].value += change;
            break;
        case Kind::tension:
            state.multiplier[actuator()] = controls.drives[p.index].value += change;
            break;
        case Kind::pressure:
            state.multiplier[actuator()] = controls.drives[p.index].value -= change;
            break;
        case Kind::support_share:
            controls.support_share[p.index] += change;
            system.place_supports(controls, state.x);
            break;
        case Kind::load_share: {
            const Load& load = d.loads[p.index];
            for (std::size_t k = 0; k < load.nodes.size(); ++k)
                controls.external_N.segment<3>(3 * load.nodes[k]) +=
                    change * load.shares[k] * linalg::vector(load.force_N);
            break;
        }
        case Kind::gravity_share: {
            const auto& mass = system.model().elements().node_mass_kg();
            for (std::size_t n = 0; n < mass.size(); ++n)
                controls.external_N.segment<3>(3 * static_cast<Eigen::Index>(n)) +=
                    change * mass[n] * linalg::vector(d.gravity_m_s2);
            break;
        }
        case Kind::obstacle_share: {
            const contact::Contact& contact = *system.model().contact(true);
            for (int n = contact.first_node(p.index); n < contact.first_node(p.index + 1); ++n)
                controls.obstacles.segment<3>(3 * (n - contact.robot_node_count())) +=
                    change * linalg::vector(d.contact->obstacles[p.index].move_m);
            break;
        }
        case Kind::joint_wanted:
            controls.joint_wanted[p.index] += change;
            break;
        default:
            FAIL("not an input");
    }
    return controls;
}

/// dF/dp against differences of the equations.
inline double input_error(Linearisation& at, const Parameter& input) {
    const Derivative by = derivative(at, input);
    const auto m = static_cast<Eigen::Index>(at.solved().size());
    Eigen::VectorXd least = Eigen::VectorXd::Zero(m);
    const double motion = by.direct.positions.norm();
    for (Eigen::Index k = 0; motion > 0 && k < m; ++k) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(at.size());
        row[at.size() - m + k] = 1;
        least[k] = 1e-3 * motion * at.motion_weights(row).norm();
    }
    using Kind = Parameter::Kind;
    const bool linear = input.kind == Kind::tension || input.kind == Kind::pressure || input.kind == Kind::load_share ||
                        input.kind == Kind::gravity_share;
    const double value = std::fabs(input.value);
    const double largest = linear ? 10 * std::max(value, 1.0) : 0.02 * (value > 0 ? value : 1);
    return best_error(largest, [&](double h) {
        const auto equations = [&](double change) {
            State state = at.state();
            const Controls controls = with_input(at, input, change, state);
            return at.equations(state, controls);
        };
        return relative_error(at, difference(equations, h), by.equations, least);
    });
}

/// Checks products, solves and inputs of a state. `size_m`: the length over which forces change.
inline Measured errors_of(Linearisation& at, double size_m, unsigned seed = 1) {
    Measured worst;
    Noise noise(seed);
    const auto m = static_cast<Eigen::Index>(at.solved().size());
    for (int k = 0; k < 2; ++k) {
        const Eigen::VectorXd v = some_direction(at, Side::direct, noise),
                              w = some_direction(at, Side::transposed, noise);
        const Eigen::VectorXd Av = at.multiply(v);
        const Eigen::VectorXd none = Eigen::VectorXd::Zero(m);
        const Change along = at.change_of(v);
        worst.product =
            std::max(worst.product, best_error(0.01 * size_m, [&](double h) {
                         const Eigen::VectorXd by_difference = difference(
                             [&](double s) { return at.equations(moved(at.state(), along, s), at.controls()); }, h);
                         return relative_error(at, by_difference, Av, none);
                     }));
        const Eigen::VectorXd Aw = at.multiply_transposed(w);
        worst.transpose =
            std::max(worst.transpose, std::fabs(w.dot(Av) - Aw.dot(v)) / (w.cwiseAbs().dot(Av.cwiseAbs())));
        const auto x = at.solve(Av), y = at.solve_transposed(Aw);
        REQUIRE_MESSAGE(x, x.error().message);
        REQUIRE_MESSAGE(y, y.error().message);
        const Eigen::Index n = at.size() - m;
        const Eigen::VectorXd off = Av - at.multiply(*x), off_transposed = Aw - at.multiply_transposed(*y);
        worst.solution = std::max({worst.solution, off.head(n).norm() / Av.head(n).norm(),
                                   off_transposed.head(n).norm() / Aw.head(n).norm()});
    }
    for (const Parameter& input : inputs(at)) {
        const double error = input_error(at, input);
        INFO(input.name);
        CHECK(error < 1e-7);
        worst.input = std::max(worst.input, error);
    }
    return worst;
}

}  // namespace pliant::sim::testing
