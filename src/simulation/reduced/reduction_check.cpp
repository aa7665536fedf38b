#include "simulation/reduced/reduction_check.hpp"

#include <algorithm>

#include "base/core/stopwatch.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/inverse/input_space.hpp"
#include "simulation/reduced/error_estimate.hpp"
#include "simulation/reduced/self_contact.hpp"

namespace pliant::sim::reduced {
namespace {

constexpr int first_point = 5003;  ///< of the sequence: far behind those that samples are taken from

template <class Work>
double seconds_of(const Work& work) {
    Stopwatch watch;
    work();
    return watch.read_s();
}

/// Largest multiplier of each actuator in the samples: those of cables and chambers have different units.
Eigen::VectorXd sizes_of_multipliers(const Reduction& reduction) {
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(reduction.samples.front().state.multiplier.size());
    for (const Sample& sample : reduction.samples) sizes = sizes.cwiseMax(sample.state.multiplier.cwiseAbs());
    return sizes;
}

}  // namespace

Result<std::vector<CheckedInputs>> check_reduction(const ReducedModel& model, const StepperOptions& stepping,
                                                   const InverseTask& task, int count, Progress& progress) {
    Stepper stepper(model.whole(), stepping);
    const inverse::InputSpace space(stepper, task);
    ReducedSolver solver(model);
    ErrorEstimator estimator(model, stepper);
    const Eigen::VectorXd sizes = sizes_of_multipliers(model.reduction()), rest = stepper.system().rest().x;
    RobotState whole = stepper.rest();
    ReducedState state = solver.start(space.inputs(space.rest(), task.times.back()));
    std::vector<CheckedInputs> rows;
    for (int k = 0; k < count; ++k) {
        progress.advance("reduce: checks", static_cast<double>(k) / count);
        if (progress.cancelled()) return cancelled();
        const Eigen::VectorXd shares = inverse::spread_point(first_point + k, space.size());
        const Inputs inputs = space.inputs(shares, task.times.back());
        CheckedInputs row;
        for (Eigen::Index i = 0; i < shares.size(); ++i) row.values.push_back(space.value(i, shares[i]));
        row.reduced_s = seconds_of([&] { row.found = solver.solve(state, inputs).found; });
        row.whole_s = seconds_of([&] { row.found = stepper.drive(whole, inputs, progress).arrived && row.found; });
        if (progress.cancelled()) return cancelled();
        if (!row.found) {
            whole = stepper.rest();
            rows.push_back(std::move(row));
            continue;
        }
        row.touching = touches_itself(stepper, whole);
        row.estimate_s = seconds_of([&] { row.estimated_m = estimator.estimate(state).error_m; });
        row.motion_m = longest(whole.x() - rest);
        row.error_m = longest(model.positions(state.at.amplitudes) - whole.x());
        const Eigen::VectorXd off = (state.at.multipliers - whole.now.state.multiplier).cwiseAbs();
        for (Eigen::Index a = 0; a < off.size(); ++a) {
            if (sizes[a] > 0) row.multiplier_error = std::max(row.multiplier_error, off[a] / sizes[a]);
        }
        if (row.touching) whole = stepper.rest();  // or it would count as touching from now on
        rows.push_back(std::move(row));
    }
    progress.advance("reduce: checks", 1);
    return rows;
}

}  // namespace pliant::sim::reduced
