// What a solver keeps from one step to the next, as a value. A solver that is given it again takes the same way to the
// same bits, whatever it has done in between: a factor is not kept, but where it was made.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "base/linalg/analysis.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/step_memory.hpp"
#include "simulation/solver/tangent_inverse.hpp"

namespace pliant::sim {

/// What newton knows of the inverse at hand, and how quickly steps with it converge.
struct NewtonRates {
    static constexpr double smallest_share_of_projection = 1.0 / 16;
    static constexpr double hoped_left = 0.05;

    double share_ = 0;                                    ///< of the projection in H
    bool cautious_ = false;                               ///< all of it was asked for
    double share_wanted_ = smallest_share_of_projection;  ///< when it was needed last
    bool usable_ = false;                                 ///< the inverse solves
    bool hasty_ = false;                                  ///< in this step of the program an old inverse has led astray
    bool reused_ = false;                                 ///< the present direction is not from the tangent at hand
    // Of the error, what a step with an inverse from an earlier state leaves.
    double left_ = hoped_left;           ///< by the next one, as far as is known
    double left_at_first_ = hoped_left;  ///< by the first one in a later step of the program than the inverse is from
    double left_by_last_ = 1;            ///< by the last one, with whatever inverse
    double left_by_new_ = 0;             ///< by the last one of its own state; 0 before and far from equilibrium
    int uses_ = 0;                       ///< of the inverse since that step
    int age_ = 0;                        ///< of the inverse, in steps of the program
    bool tried_later_ = false;           ///< in a later one than its own
    bool two_levels_ = false;            ///< as long as they are quick enough
};

/// Shared parts are never changed: a copy costs next to nothing.
struct SolverMemory {
    using Cliques = std::vector<std::vector<int>>;

    struct Tangent {
        State state;
        Controls controls;
    };
    std::shared_ptr<const Tangent> tangent;  ///< where it was made; null: nowhere yet
    TangentInverse::Memory inverse;
    NewtonRates rates;
    std::shared_ptr<const Cliques> touching;  ///< that the pattern has room for; null: none
    bool forgets_touching = false;            ///< the next pattern is made without them
    std::vector<std::shared_ptr<const StepPair>> pairs;
    std::shared_ptr<const StepPair> learnt;           ///< not yet among them; null: nothing
    std::shared_ptr<const Eigen::VectorXd> followed;  ///< (3n) how the body stood when it was last turned; null: never

    // Follow from `touching`; empty where they have not been made.
    std::shared_ptr<const TangentLayout> layout;
    std::shared_ptr<const linalg::Analysis> analysis;
};

}  // namespace pliant::sim
