// What a robot is made to do: how many steps, by which solver, at rest or in time.
#pragma once

#include <optional>

#include "robot/description/solver.hpp"

namespace pliant::robot {

/// Rayleigh damping: C = mass * M + stiffness * K, K the positive part of the tangent at the start of each step.
struct Damping {
    double mass_per_s = 0;
    double stiffness_s = 0;
};

/// How a step in time leads on.
enum class Integrator {
    bdf2,               ///< takes a little energy out of what it does not resolve, and never adds any
    energy_conserving,  ///< keeps the energy of what is neither damped nor touches anything
};

/// Motion in time instead of rest at every instant.
struct Dynamics {
    Damping damping;
    Integrator integrator = Integrator::bdf2;
    double time_tolerance_m = 0;  ///< above 0: steps are as long as this error of each allows
};

struct Program {
    int steps = 30;
    double duration = 1;  ///< time at the end; steps are equally long
    double tolerance = 1e-4;
    Solver solver = Solver::automatic;
    std::optional<Dynamics> dynamics = std::nullopt;
    int iteration_limit = 0;  ///< per solved step; 0: the solver's own
    /// Where an equilibrium turns out to be unstable: it is left by this largest motion of a node, for the stable one
    /// that the energy then falls to. 0: only a warning.
    double imperfection_m = 0;
    /// Whether the results are looked at for instability and for surfaces that cross, which takes as long as a few
    /// steps. Off only to time the solver.
    bool checks = true;
};

}  // namespace pliant::robot
