#include "studio/simulate/reduced_hand.hpp"

#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <utility>

#include "base/core/stopwatch.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::studio {
namespace {

constexpr double largest_error = 0.005;  ///< of the robot's size: above it the linear preview is shown instead
constexpr int background = 4;            ///< nice value of the thread: what the user does comes first
constexpr int most_samples = 72;
constexpr int most_nodes = 60000;  ///< of larger robots the samples would take the better part of an hour

sim::StepperOptions options_of(const robot::Robot& robot) {
    sim::StepperOptions options = sim::stepper_options(robot.program);
    options.dynamics.reset();
    options.most_past = 1;
    return options;
}

}  // namespace

class ReducedHand::Cancel final : public Progress {
public:
    explicit Cancel(const std::atomic<bool>& stopping) : stopping_(stopping) {}
    [[nodiscard]] bool cancelled() const override { return stopping_; }

private:
    const std::atomic<bool>& stopping_;
};

struct ReducedHand::Ready {
    Ready(sim::reduced::ReducedModel model_, const sim::StepperOptions& options)
        : model(std::move(model_)), stepper(model.whole(), options), solver(model), estimator(model, stepper) {}
    sim::reduced::ReducedModel model;
    sim::Stepper stepper;
    sim::reduced::ReducedSolver solver;
    sim::reduced::ErrorEstimator estimator;
    std::optional<sim::reduced::ReducedState> state{};
};

ReducedHand::ReducedHand(const robot::Robot& robot, const sim::Model& model, std::vector<sim::Steered> inputs,
                         double size_m)
    : robot_(&robot), model_(&model), inputs_(std::move(inputs)), size_m_(size_m), thread_([this] {
          (void)setpriority(PRIO_PROCESS, 0, background);  // of this thread
          tbb::task_arena alone(1);
          alone.execute([this] { make(); });
      }) {}

ReducedHand::~ReducedHand() {
    stopping_ = true;
    thread_.join();
}

void ReducedHand::make() {
    if (robot_->program.dynamics || inputs_.empty() || model_->node_count() > most_nodes) return;
    sim::InverseTask task;
    task.inputs = inputs_;
    task.times = {robot_->program.duration};
    Cancel progress(stopping_);
    const int samples = std::min(most_samples, 24 * static_cast<int>(task.inputs.size()));
    auto reduction = sim::reduced::reduce(*model_, options_of(*robot_), task, {.samples = samples}, progress);
    if (!reduction) return;
    auto model = sim::reduced::ReducedModel::create(*model_, std::move(*reduction));
    if (!model) return;
    auto ready = std::make_unique<Ready>(std::move(*model), options_of(*robot_));
    const std::lock_guard lock(mutex_);
    made_ = std::move(ready);
}

std::optional<ReducedHand::Shown> ReducedHand::at(const sim::LiveTarget& target) {
    if (!ready_) {
        const std::lock_guard lock(mutex_);
        ready_ = std::move(made_);
    }
    if (!ready_ || target.pull) return std::nullopt;
    Stopwatch watch;
    const sim::Inputs inputs{target.time, target.drives};
    if (!ready_->state) ready_->state = ready_->solver.start(inputs);
    if (!ready_->solver.solve(*ready_->state, inputs).found) return std::nullopt;
    const sim::reduced::Estimate estimate = ready_->estimator.estimate(*ready_->state);
    if (!(estimate.error_m <= largest_error * size_m_)) return std::nullopt;
    const sim::Equilibrium& system = ready_->stepper.system();
    const sim::Controls controls = sim::reduced::controls_at(system, inputs);
    const sim::Evaluation evaluation = system.evaluate(estimate.corrected, controls);
    // It has no contact: what would touch is left to the preview.
    if (!evaluation.possible() || system.crossing(estimate.corrected, controls)) return std::nullopt;
    Shown shown;
    shown.error_m = estimate.error_m;
    shown.step.time = target.time;
    sim::describe(*model_, system, estimate.corrected, controls, evaluation, shown.step);
    shown.step.wall_s = watch.read_s();
    return shown;
}

}  // namespace pliant::studio
