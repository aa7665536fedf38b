// Equilibria of a reduced model: Newton's method on the amplitudes of the modes and the multipliers of the actuators.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "simulation/reduced/reduced_model.hpp"

namespace pliant::sim::reduced {

struct ReducedState {
    Inputs inputs;
    Projected at;
};

struct ReducedReport {
    bool found = false;
    int iterations = 0;
};

/// Not thread-safe: it has work space. The result depends only on the state and the inputs.
class ReducedSolver {
public:
    /// `model` must outlive it.
    explicit ReducedSolver(const ReducedModel& model);

    /// The sample with the nearest inputs.
    [[nodiscard]] ReducedState start(const Inputs& inputs) const;
    /// Moves `state` to the equilibrium at `inputs`: from where it is or from the nearest sample, whichever is nearer;
    /// if that fails from the other one, and then in small pieces. If nothing is found it is unchanged.
    [[nodiscard]] ReducedReport solve(ReducedState& state, const Inputs& inputs);

private:
    [[nodiscard]] bool is_near(const ReducedState& state, const ReducedState& sample, const Inputs& inputs) const;
    [[nodiscard]] bool newton(ReducedState& state, const Inputs& inputs, int& iterations);

    const ReducedModel* model_;
    ProjectedTangent tangent_;
};

}  // namespace pliant::sim::reduced
