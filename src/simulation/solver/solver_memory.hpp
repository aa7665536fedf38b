// State of a solver between steps, as a value. Restoring it reproduces the same iterations to the bit, whatever was
// solved in between: the factor itself is not stored, but the state at which it was made.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "base/linalg/analysis.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/step_memory.hpp"
#include "simulation/solver/tangent_inverse.hpp"

namespace pliant::sim {

/// What newton knows about its current inverse, and the convergence rate of steps with it.
struct NewtonRates {
    static constexpr double smallest_share_of_projection = 1.0 / 16;
    static constexpr double hoped_left = 0.05;

    double share_ = 0;                                    ///< share of the projection in H
    bool cautious_ = false;                               ///< the full projection was requested
    double share_wanted_ = smallest_share_of_projection;  ///< share when it was last needed
    bool usable_ = false;                                 ///< the inverse solves
    bool hasty_ = false;                                  ///< in this step of the program an old inverse has failed
    bool reused_ = false;                                 ///< the current direction comes from an old tangent
    // Error reduction factor of a step with an inverse from an earlier state.
    double left_ = hoped_left;           ///< expected for the next one
    double left_at_first_ = hoped_left;  ///< of the first one in a later step of the program than that of the inverse
    double left_by_last_ = 1;            ///< of the last one, with whatever inverse
    double left_by_new_ = 0;             ///< of the last one with an inverse of its own state; 0 before that and far
                                         ///< from equilibrium
    int uses_ = 0;                       ///< of the inverse since that step
    int age_ = 0;                        ///< of the inverse, in steps of the program
    bool tried_later_ = false;           ///< in a later step than its own
    bool two_levels_ = false;            ///< used as long as they are fast enough
};

/// Shared parts are immutable: copies are cheap.
struct SolverMemory {
    using Cliques = std::vector<std::vector<int>>;

    struct Tangent {
        State state;
        Controls controls;
    };
    std::shared_ptr<const Tangent> tangent;  ///< state at which it was made; null: none yet
    /// A matrix: the tangent at a state, with a share of its projection.
    struct Matrix {
        std::shared_ptr<const Tangent> tangent;
        double share = 0;
        bool operator==(const Matrix&) const = default;
    };
    Matrix base;  ///< of levels: the matrix that the coarse level was made for; tangent null: the inverse's own
    TangentInverse::Memory inverse;
    NewtonRates rates;
    std::shared_ptr<const Cliques> touching;  ///< contact groups included in the pattern; null: none
    bool forgets_touching = false;            ///< the next pattern is built without them
    std::vector<std::shared_ptr<const StepPair>> pairs;
    std::shared_ptr<const StepPair> learnt;           ///< latest pair, not yet included; null: none
    std::shared_ptr<const Eigen::VectorXd> followed;  ///< (3n) positions at the last rotation of the factor; null:
                                                      ///< never

    // Derived from `touching`; empty if not computed.
    std::shared_ptr<const TangentLayout> layout;
    std::shared_ptr<const linalg::Analysis> analysis;
};

}  // namespace pliant::sim
