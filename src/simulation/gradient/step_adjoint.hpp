// One step of a program, gone back over: what its end is worth becomes what its beginning is worth.
#pragma once

#include <memory>
#include <vector>

#include "simulation/contact/friction.hpp"
#include "simulation/gradient/friction_slips.hpp"
#include "simulation/gradient/variation.hpp"

namespace pliant::sim {

/// How an objective changes with where a step ends, through the steps after it; all zero after the last one.
struct Carried {
    Eigen::VectorXd x, v;                ///< (3n) by position and velocity at the end of the step
    Eigen::VectorXd x_before, v_before;  ///< (3n) the same of the step before
    Eigen::VectorXd obstacles;           ///< (3 obstacle nodes) by where the obstacles are
    /// Of the step after it, and by the slip with which each of its pairs begins, along the pair's tangents.
    std::shared_ptr<const contact::Friction> friction{};
    Slips slips{};
    [[nodiscard]] static Carried nothing(const Equilibrium& system);
    [[nodiscard]] bool is_nothing() const;
};

/// Puts what is carried, and what the end of this step is worth in itself, on everything that the step depends on; and
/// carries on what is worth the end of the step before.
[[nodiscard]] Result<Variation> go_back_over(Linearisation& at, const Slope& own, const By& by, Carried& carried);

}  // namespace pliant::sim
