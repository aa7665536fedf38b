// Deviations of a state from its goals, in units of their tolerances, and their derivatives.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "simulation/inverse/input_space.hpp"

namespace pliant::sim::inverse {

/// Result for one goal. SI.
struct GoalState {
    double error = 0;       ///< m, rad or N; the largest over several markers
    bool reached = false;   ///< within its tolerance
    std::vector<Vec3> got;  ///< in the format of Goal::wanted: positions of markers; a direction; a force, or its
                            ///< magnitude
};

/// The results for the goals of a task at one of its waypoints.
[[nodiscard]] std::vector<GoalState> goal_states(const Equilibrium& system, const InverseTask& task,
                                                 const RobotState& robot, std::size_t waypoint);
/// How far one result of a goal is from another at this waypoint, in what its tolerance is in: for a plane along its
/// normal; the largest over several markers.
[[nodiscard]] double difference(const Goal& goal, const GoalState& one, const GoalState& other, std::size_t waypoint);

/// Residuals, half of whose sum of squares is minimised. Those of goals are in tolerances, times the square root of the
/// goal's weight; those of penalties each in its own unit.
struct RowGradients {
    Eigen::SparseMatrix<double, Eigen::RowMajor> by_positions;  ///< (rows, 3n)
    Eigen::MatrixXd by_multipliers;                             ///< (rows, actuators)
    Eigen::MatrixXd by_inputs;                                  ///< (rows, inputs) explicit derivative, at a fixed
                                                                ///< state
};

/// Penalties on inputs in addition to the goals: none if `factor` is 0. The residuals of the goals are multiplied by
/// `goals`.
struct PriceTerm {
    double factor = 0;
    double goals = 1;
    Eigen::VectorXd before;  ///< (inputs) reference for changes
};

class GoalRows {
public:
    /// All arguments must outlive it.
    GoalRows(const Stepper& stepper, const InverseTask& task, const InputSpace& space);

    [[nodiscard]] std::vector<GoalState> goals(const RobotState& robot, std::size_t waypoint) const;
    [[nodiscard]] Eigen::VectorXd values(const RobotState& robot, const Eigen::VectorXd& inputs, std::size_t waypoint,
                                         const PriceTerm& price) const;
    /// The goal of each of these values, without those of penalties.
    [[nodiscard]] std::vector<std::size_t> goals_of_rows(const RobotState& robot, std::size_t waypoint) const;
    /// Derivatives, in the same order. `at`: linearised at this state.
    [[nodiscard]] RowGradients gradients(Linearisation& at, std::size_t waypoint, const PriceTerm& price) const;
    /// True if any actuator has a penalty.
    [[nodiscard]] bool has_prices() const;
    /// Half the sum of squares of all penalties at `factor` 1.
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
