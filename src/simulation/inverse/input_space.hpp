// The steered actuators as one vector: each entry runs from 0, the lower end of its range, to 1, the upper.
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
    /// The undriven inputs, or the nearest ones within the ranges.
    [[nodiscard]] Eigen::VectorXd rest() const;
    /// In the unit of the target.
    [[nodiscard]] double value(Eigen::Index i, double share) const;
    [[nodiscard]] double share(Eigen::Index i, double value) const;
    /// The current inputs, within the ranges; for an actuator driven otherwise, those that would keep it as it is.
    [[nodiscard]] Eigen::VectorXd shares(const RobotState& robot) const;
    /// True if every steered actuator is driven by the quantity that its target names.
    [[nodiscard]] bool drives(const RobotState& robot) const;
    /// Inputs of the whole robot: everything that is not steered follows the program.
    [[nodiscard]] Inputs inputs(const Eigen::VectorXd& shares, double time) const;

    /// True for a cable that is driven by length.
    [[nodiscard]] bool can_slacken(const RobotState& robot, Eigen::Index i) const;
    /// True for a cable that is driven by length and slack.
    [[nodiscard]] bool is_slack(const RobotState& robot, Eigen::Index i) const;
    /// True if a larger entry means a longer cable, or more air.
    [[nodiscard]] bool drives_longer(Eigen::Index i) const { return drive_factor(i) > 0; }
    /// Takes up slack: the prescribed length of slack cables is set to their actual length, within these bounds of the
    /// shares. Nothing else changes.
    void take_up(RobotState& robot, Eigen::VectorXd& shares, const Eigen::VectorXd& lower,
                 const Eigen::VectorXd& upper) const;

    /// Derivatives of the equations with respect to each entry.
    [[nodiscard]] std::vector<Derivative> derivatives(Linearisation& at) const;
    /// The largest change of each entry within `seconds`, or per waypoint; above 1 if nothing limits it.
    [[nodiscard]] Eigen::VectorXd largest_change(double seconds) const;

private:
    [[nodiscard]] double drive_factor(Eigen::Index i) const;
    const Stepper* stepper_;
    const InverseTask* task_;
};

}  // namespace pliant::sim::inverse
