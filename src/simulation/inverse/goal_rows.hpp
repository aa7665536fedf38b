// How far a state is from its goals, in tolerances, and how that changes with the state.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "simulation/inverse/input_space.hpp"

namespace pliant::sim::inverse {

/// How a goal fares. SI.
struct GoalState {
    double error = 0;       ///< m, rad or N; of several markers the largest
    bool reached = false;   ///< within its tolerance
    std::vector<Vec3> got;  ///< as Goal::wanted: places of markers; a direction; a force, or its size
};

/// Residuals: half the sum of their squares is what is made small. Of goals each in tolerances, times the root of its
/// weight; of prices each in its unit.
struct RowGradients {
    Eigen::SparseMatrix<double, Eigen::RowMajor> by_positions;  ///< (rows, 3n)
    Eigen::MatrixXd by_multipliers;                             ///< (rows, actuators)
    Eigen::MatrixXd by_inputs;                                  ///< (rows, inputs) without what goes through the state
};

/// Prices of inputs beside the goals: none where `factor` is 0. The residuals of the goals count `goals` times.
struct PriceTerm {
    double factor = 0;
    double goals = 1;
    Eigen::VectorXd before;  ///< (inputs) what a change is counted from
};

class GoalRows {
public:
    /// All outlive it.
    GoalRows(const Stepper& stepper, const InverseTask& task, const InputSpace& space);

    [[nodiscard]] std::vector<GoalState> goals(const RobotState& robot, std::size_t waypoint) const;
    [[nodiscard]] Eigen::VectorXd values(const RobotState& robot, const Eigen::VectorXd& inputs, std::size_t waypoint,
                                         const PriceTerm& price) const;
    /// In the same order. `at`: of this state.
    [[nodiscard]] RowGradients gradients(Linearisation& at, std::size_t waypoint, const PriceTerm& price) const;
    /// Some actuator has a price.
    [[nodiscard]] bool has_prices() const;
    /// Half the sum of all squares of prices at `factor` 1.
    [[nodiscard]] double price(const RobotState& robot, const Eigen::VectorXd& inputs,
                               const Eigen::VectorXd& before) const;

private:
    [[nodiscard]] double effort_unit(Eigen::Index input) const;
    [[nodiscard]] Eigen::VectorXd price_values(const RobotState& robot, const Eigen::VectorXd& inputs,
                                               const Eigen::VectorXd& before) const;
    [[nodiscard]] double scale(const Goal& goal) const;

    const Stepper* stepper_;
    const InverseTask* task_;
    const InputSpace* space_;
    double least_weight_ = 1;
    double tension_N_ = 1, pressure_Pa_ = 1;
};

}  // namespace pliant::sim::inverse
