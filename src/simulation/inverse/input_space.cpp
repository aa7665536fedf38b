#include "simulation/inverse/input_space.hpp"

#include <algorithm>

#include "base/linalg/vectors.hpp"

namespace pliant::sim::inverse {

using Kind = Parameter::Kind;

InputSpace::InputSpace(const Stepper& stepper, const InverseTask& task) : stepper_(&stepper), task_(&task) {}

double InputSpace::value(Eigen::Index i, double share) const {
    const Steered& in = input(i);
    return share >= 1 ? in.high : in.low + share * (in.high - in.low);
}

double InputSpace::share(Eigen::Index i, double value) const {
    const Steered& in = input(i);
    return (value - in.low) / (in.high - in.low);
}

Eigen::VectorXd InputSpace::rest() const {
    Eigen::VectorXd shares(size());
    for (Eigen::Index i = 0; i < size(); ++i) shares[i] = std::clamp(share(i, input(i).rest), 0.0, 1.0);
    return shares;
}

Eigen::VectorXd InputSpace::shares(const RobotState& robot) const {
    Eigen::VectorXd shares(size());
    for (Eigen::Index i = 0; i < size(); ++i) {
        const std::size_t a = input(i).actuator;
        const Drive low = stepper_->system().drive(a, input(i).low), now = robot.inputs.drives[a];
        const double value = now.kind == low.kind ? now.value : stepper_->hold(robot, a, low.kind).value;
        shares[i] = std::clamp((value - low.value) / drive_factor(i), 0.0, 1.0);
    }
    return shares;
}

bool InputSpace::drives(const RobotState& robot) const {
    return std::ranges::all_of(task_->inputs, [&](const Steered& in) {
        return robot.inputs.drives[in.actuator].kind == stepper_->system().drive(in.actuator, in.low).kind;
    });
}

Inputs InputSpace::inputs(const Eigen::VectorXd& shares, double time) const {
    Inputs inputs = stepper_->program(time);
    for (Eigen::Index i = 0; i < size(); ++i)
        inputs.drives[input(i).actuator] = stepper_->system().drive(input(i).actuator, value(i, shares[i]));
    return inputs;
}

/// Change of the drive's value over a whole range; targets are linear in it.
double InputSpace::drive_factor(Eigen::Index i) const {
    const Equilibrium& system = stepper_->system();
    const Steered& in = input(i);
    return system.drive(in.actuator, in.high).value - system.drive(in.actuator, in.low).value;
}

bool InputSpace::can_slacken(const RobotState& robot, Eigen::Index i) const {
    const std::size_t a = input(i).actuator;
    return robot.inputs.drives[a].kind == Drive::Kind::measure && stepper_->system().actuators()[a].only_pulls();
}

bool InputSpace::is_slack(const RobotState& robot, Eigen::Index i) const {
    const std::size_t a = input(i).actuator;
    return can_slacken(robot, i) && !(robot.now.state.multiplier[static_cast<Eigen::Index>(a)] > 0);
}

void InputSpace::take_up(RobotState& robot, Eigen::VectorXd& shares, const Eigen::VectorXd& lower,
                         const Eigen::VectorXd& upper) const {
    const Equilibrium& system = stepper_->system();
    for (Eigen::Index i = 0; i < size(); ++i) {
        if (!is_slack(robot, i)) continue;
        const std::size_t a = input(i).actuator;
        const double length = system.actuators()[a].measure(linalg::view(robot.x()));
        const double taut = (length - system.drive(a, input(i).low).value) / drive_factor(i);
        shares[i] = std::clamp(taut, lower[i], upper[i]);
        const Drive drive = system.drive(a, value(i, shares[i]));
        robot.inputs.drives[a] = robot.drives[a] = drive;
    }
}

std::vector<Derivative> InputSpace::derivatives(Linearisation& at) const {
    const std::vector<Parameter> all = sim::inputs(at);
    std::vector<Derivative> list;
    for (Eigen::Index i = 0; i < size(); ++i) {
        const Parameter& parameter = all[input(i).actuator];  // those of the actuators come first
        Derivative by = derivative(at, parameter);
        // The drive of a chamber holds minus the pressure.
        const double factor = parameter.kind == Kind::pressure ? -drive_factor(i) : drive_factor(i);
        by.equations *= factor;
        by.direct.positions *= factor;
        by.direct.multipliers *= factor;
        by.forces *= factor;
        list.push_back(std::move(by));
    }
    return list;
}

Eigen::VectorXd InputSpace::largest_change(double seconds) const {
    Eigen::VectorXd change(size());
    for (Eigen::Index i = 0; i < size(); ++i) {
        const Steered& in = input(i);
        change[i] = in.rate ? *in.rate * (task_->timed ? seconds : 1) / (in.high - in.low) : 2;
    }
    return change;
}

}  // namespace pliant::sim::inverse
