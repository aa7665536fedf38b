#include "simulation/inverse/marker_drag.hpp"

#include <algorithm>
#include <utility>

namespace pliant::sim::inverse {
namespace {

constexpr double tolerance_m = 1e-4;
constexpr double largest_increment = 0.1;  // of the ranges, between two displayed states

InverseTask task_of(std::vector<Steered> inputs, std::size_t marker) {
    InverseTask task;
    task.inputs = std::move(inputs);
    Goal goal;
    goal.name = "hand";
    goal.markers = {marker};
    goal.wanted = {{Vec3{}}};
    goal.tolerance = tolerance_m;
    task.goals = {std::move(goal)};
    task.times = {0};
    return task;
}

}  // namespace

MarkerDrag::MarkerDrag(Stepper& stepper, std::vector<Steered> inputs, std::size_t marker)
    : model_(&stepper.model()), task_(task_of(std::move(inputs), marker)), seeker_(stepper, task_) {}

double MarkerDrag::distance(const RobotState& robot, const Vec3& wanted_m) const {
    const auto& x = robot.x();
    const Attachment& point = model_->description().markers[marker()].point;
    return norm(position(point, {x.data(), static_cast<std::size_t>(x.size())}) - wanted_m);
}

Led MarkerDrag::lead(RobotState& robot, const Vec3& wanted_m, const Progress& progress) {
    task_.goals.front().wanted = {{wanted_m}};
    Point start{robot, seeker_.space().shares(robot)};
    if (!seeker_.space().drives(robot)) {
        // A slider may have driven it by another quantity, to which the gradients would refer.
        std::string why;
        const auto taken = seeker_.move(start, start.inputs, robot.inputs.time, seeker_.whole_range(), progress, &why);
        if (!taken) return {true, false, distance(robot, wanted_m), {{Limit::Kind::no_state, "", why}}};
        start = *taken;
    }
    Bounds bounds = seeker_.whole_range();
    for (Eigen::Index i = 0; i < start.inputs.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        bounds.rate_lower[k] = start.inputs[i] > largest_increment;
        bounds.rate_upper[k] = start.inputs[i] < 1 - largest_increment;
        bounds.lower[i] = std::max(0.0, start.inputs[i] - largest_increment);
        bounds.upper[i] = std::min(1.0, start.inputs[i] + largest_increment);
    }
    Found found = seeker_.seek(start, start, 0, bounds, progress);
    robot = std::move(found.point.robot);
    const auto goes_on = [](const Limit& limit) { return limit.kind == Limit::Kind::rate; };
    Led led{false, found.reached, found.goals.front().error, {}};
    led.settled = found.reached || (!found.cancelled && std::ranges::none_of(found.limits, goes_on));
    if (led.settled && !led.reached) led.limits = std::move(found.limits);
    return led;
}

std::vector<double> MarkerDrag::values(const RobotState& robot) const {
    const Eigen::VectorXd shares = seeker_.space().shares(robot);
    std::vector<double> values;
    for (Eigen::Index i = 0; i < shares.size(); ++i) values.push_back(seeker_.space().value(i, shares[i]));
    return values;
}

}  // namespace pliant::sim::inverse
