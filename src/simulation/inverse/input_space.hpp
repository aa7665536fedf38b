// The actuators that may be moved, as one vector: each entry goes from 0, the lower end of a range, to 1, the upper.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/linearisation/parameters.hpp"
#include "simulation/parts/inverse_task.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim::inverse {

class InputSpace {
public:
    /// Both must outlive it.
    InputSpace(const Stepper& stepper, const InverseTask& task);

    [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(task_->inputs.size()); }
    [[nodiscard]] const Steered& input(Eigen::Index i) const { return task_->inputs[static_cast<std::size_t>(i)]; }
    /// Nothing driven, or what of the range is nearest to that.
    [[nodiscard]] Eigen::VectorXd rest() const;
    /// In what the targets name.
    [[nodiscard]] double value(Eigen::Index i, double share) const;
    [[nodiscard]] double share(Eigen::Index i, double value) const;
    /// What drives the robot now, or would keep it as it is where it is driven otherwise; within the ranges.
    [[nodiscard]] Eigen::VectorXd shares(const RobotState& robot) const;
    /// The robot is driven by what the targets name.
    [[nodiscard]] bool drives(const RobotState& robot) const;
    /// Of the whole robot: what is not steered follows the program.
    [[nodiscard]] Inputs inputs(const Eigen::VectorXd& shares, double time) const;

    /// A cable that is driven by length and does not pull.
    [[nodiscard]] bool is_slack(const RobotState& robot, Eigen::Index i) const;
    /// A larger share asks for a longer cable, or for more air.
    [[nodiscard]] bool drives_longer(Eigen::Index i) const { return drive_factor(i) > 0; }
    /// Takes up what is slack: those cables are asked for the length that they have, as far as their range goes.
    /// Nothing else changes.
    void take_up(RobotState& robot, Eigen::VectorXd& shares) const;

    /// How the equations change with each entry.
    [[nodiscard]] std::vector<Derivative> derivatives(Linearisation& at) const;
    /// The largest change of each entry within `seconds`, or in one waypoint; above 1 where nothing limits it.
    [[nodiscard]] Eigen::VectorXd largest_change(double seconds) const;

private:
    [[nodiscard]] double drive_factor(Eigen::Index i) const;
    const Stepper* stepper_;
    const InverseTask* task_;
};

}  // namespace pliant::sim::inverse
