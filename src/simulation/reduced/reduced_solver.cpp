#include "simulation/reduced/reduced_solver.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace pliant::sim::reduced {
namespace {

constexpr int most_iterations = 20, most_halvings = 8;
constexpr int most_pieces = 16;  ///< of the path from the nearest sample
// Newton's last change, relative to the reach of the samples and to the largest multiplier: it squares with each step.
constexpr double last_change = 1e-4;
constexpr double far = 1.0;  ///< of the reach: no step is longer

double largest(const Eigen::VectorXd& numbers) {
    return numbers.size() > 0 ? numbers.cwiseAbs().maxCoeff() : 0;
}

}  // namespace

ReducedSolver::ReducedSolver(const ReducedModel& model) : model_(&model), tangent_(model.part()) {}

ReducedState ReducedSolver::start(const Inputs& inputs) const {
    const std::size_t nearest = model_->nearest_sample(inputs);
    const Sample& sample = model_->reduction().samples[nearest];
    return {model_->inputs_of_sample(nearest, inputs), {sample.amplitudes, sample.state.multiplier}};
}

/// True if the state is at least as near to the inputs as the nearest sample.
bool ReducedSolver::is_near(const ReducedState& state, const ReducedState& sample, const Inputs& inputs) const {
    for (std::size_t a = 0; a < inputs.drives.size(); ++a)
        if (state.inputs.drives[a].kind != inputs.drives[a].kind) return false;
    return model_->distance(state.inputs, inputs) <= model_->distance(sample.inputs, inputs);
}

ReducedReport ReducedSolver::solve(ReducedState& state, const Inputs& inputs) {
    ReducedReport report;
    const ReducedState sample = start(inputs);
    const bool near = is_near(state, sample, inputs);
    for (const ReducedState* from : {near ? &state : &sample, near ? &sample : &state}) {
        ReducedState next = *from;
        report.found = newton(next, inputs, report.iterations);
        if (!report.found) continue;
        state = std::move(next);
        return report;
    }
    for (int pieces = 2; pieces <= most_pieces; pieces *= 2) {
        ReducedState next = sample;
        report.found = true;
        for (int piece = 1; report.found && piece <= pieces; ++piece)
            report.found =
                newton(next, between(sample.inputs, inputs, static_cast<double>(piece) / pieces), report.iterations);
        if (!report.found) continue;
        state = std::move(next);
        return report;
    }
    return report;
}

bool ReducedSolver::newton(ReducedState& state, const Inputs& inputs, int& iterations) {
    const ProjectedModel& part = model_->part();
    const Controls controls = part.controls(inputs);
    state.inputs = inputs;
    State now{part.positions(state.at.amplitudes), state.at.multipliers};
    Evaluation evaluation = part.system().evaluate(now, controls);
    if (!evaluation.possible()) return false;
    for (int k = 0; k < most_iterations; ++k, ++iterations) {
        tangent_.assemble(now, evaluation, controls);
        const std::optional<Projected> wanted = tangent_.step(part.modes().transpose() * evaluation.out_of_balance);
        if (!wanted) return false;
        const double size = wanted->amplitudes.norm();
        const double other = largest(wanted->multipliers - evaluation.multiplier);
        double share = size > far * model_->reach_m() ? far * model_->reach_m() / size : 1;
        const Projected before{state.at.amplitudes, evaluation.multiplier};
        for (int halving = 0;; ++halving, share /= 2) {
            if (halving == most_halvings) return false;
            state.at.amplitudes = before.amplitudes + share * wanted->amplitudes;
            now = {part.positions(state.at.amplitudes),
                   before.multipliers + share * (wanted->multipliers - before.multipliers)};
            evaluation = part.system().evaluate(now, controls);
            if (evaluation.possible()) break;
        }
        state.at.multipliers = evaluation.multiplier;
        if (share == 1 && size <= last_change * model_->reach_m() &&
            (k > 0 || other <= last_change * largest(wanted->multipliers)))
            return true;
    }
    return false;
}

}  // namespace pliant::sim::reduced
