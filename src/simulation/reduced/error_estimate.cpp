#include "simulation/reduced/error_estimate.hpp"

#include <algorithm>

#include "base/linalg/vectors.hpp"

namespace pliant::sim::reduced {
double longest(const Eigen::VectorXd& motion) {
    double most = 0;
    for (Eigen::Index k = 0; k + 2 < motion.size(); k += 3) most = std::max(most, motion.segment<3>(k).norm());
    return most;
}

ErrorEstimator::ErrorEstimator(const ReducedModel& model, Stepper& stepper)
    : model_(&model), stepper_(&stepper), tangent_(model.check_part()) {}

Estimate ErrorEstimator::estimate(const ReducedState& state) {
    Estimate found;
    const Eigen::MatrixXd& modes = model_->reduction().modes;
    const State whole{model_->positions(state.at.amplitudes), state.at.multipliers};
    const Evaluation left = stepper_->system().evaluate(whole, controls_at(stepper_->system(), state.inputs));
    if (!left.possible()) return found;
    const ProjectedModel& part = model_->check_part();
    Eigen::VectorXd amplitudes = Eigen::VectorXd::Zero(modes.cols());
    amplitudes.head(state.at.amplitudes.size()) = state.at.amplitudes;
    const Controls controls = part.controls(state.inputs);
    const State sampled{part.positions(amplitudes), left.multiplier};
    const Evaluation evaluation = part.system().evaluate(sampled, controls);
    if (!evaluation.possible()) return found;
    tangent_.assemble(sampled, evaluation, controls);
    const std::optional<Projected> next = tangent_.step(modes.transpose() * left.out_of_balance);
    if (!next) return found;
    const Eigen::VectorXd motion = modes * next->amplitudes;
    found.error_m = longest(motion);
    for (const Marker& marker : stepper_->model().description().markers) {
        Eigen::Vector3d off = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < marker.point.nodes.size(); ++k)
            off += marker.point.weights[k] * motion.segment<3>(3 * marker.point.nodes[k]);
        found.marker_errors_m.push_back(off.norm());
    }
    found.multiplier_errors = next->multipliers - left.multiplier;
    found.corrected = {whole.x + motion, next->multipliers};
    return found;
}

std::optional<RobotState> ErrorEstimator::exact(const ReducedState& state, const Estimate& estimate,
                                                const Progress& progress) {
    const auto at = [&](const Inputs& inputs) {
        RobotState robot = stepper_->rest();
        robot.inputs = inputs;
        robot.controls = stepper_->controls(robot, inputs);
        robot.drives = robot.controls.drives;
        return robot;
    };
    RobotState robot = at(state.inputs);
    // Contact begins on the path of a step: a state that passes through itself is solved again, on such a path.
    if (estimate.corrected.x.size() > 0 && stepper_->settle_beside(robot, estimate.corrected, progress).arrived &&
        !stepper_->system().crossing(robot.now.state, robot.controls))
        return robot;
    const std::size_t nearest = model_->nearest_sample(state.inputs);
    robot = at(model_->inputs_of_sample(nearest, state.inputs));
    robot.now.state = model_->reduction().samples[nearest].state;
    if (stepper_->drive(robot, state.inputs, progress).arrived) return robot;
    return std::nullopt;
}

}  // namespace pliant::sim::reduced
