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

/// Motion in time instead of rest at every instant.
struct Dynamics {
    Damping damping;
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
