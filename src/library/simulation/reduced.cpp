#include "pliant/reduced.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "base/core/files.hpp"
#include "base/linalg/vectors.hpp"
#include "library/base/calls.hpp"
#include "library/base/in_use.hpp"
#include "library/simulation/data.hpp"
#include "library/simulation/steering.hpp"
#include "simulation/reduced/error_estimate.hpp"
#include "simulation/reduced/reduction_check.hpp"
#include "simulation/reduced/reduction_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant {
namespace {

sim::StepperOptions options_of_program(const Model::Data& model) {
    sim::StepperOptions options = sim::stepper_options(model.scene.robot.program);
    options.most_past = 1;
    return options;
}

sim::InverseTask task_for(const Model::Data& model) {
    return library::value_of(robot::build_goals(model.scene.robot, model.scene.model, false));
}

/// Tells robots apart: by their text, and by their mesh, which may come from a file.
std::string origin_of(const Model::Data& model) {
    return model.robot->origin() + "\n" + sim::mesh_digest(model.scene.model.mesh());
}

void check_reduction_options(const ReductionOptions& options) {
    constexpr int most_samples = 100000, most_modes = 1000;
    const auto is_share = [](double error) { return error > 0 && error < 1; };
    if (options.samples < 0 || options.samples > most_samples)
        throw Failure(Failure::Kind::input,
                      fmt::format("{} samples are not possible; 0 to {} are", options.samples, most_samples));
    if (options.most_modes < 1 || options.most_modes > most_modes)
        throw Failure(Failure::Kind::input,
                      fmt::format("{} modes are not possible; 1 to {} are", options.most_modes, most_modes));
    if (!is_share(options.basis_error) || !is_share(options.force_error))
        throw Failure(Failure::Kind::input, "the errors of modes and forces are between 0 and 1");
}

/// Samples that move the robot: so many modes they can have at most.
Eigen::Index moving_samples(const sim::reduced::Reduction& reduction) {
    double largest = 0;
    for (const auto& sample : reduction.samples) largest = std::max(largest, sample.amplitudes.norm());
    constexpr double rounding = 1e-9;
    return std::ranges::count_if(reduction.samples,
                                 [&](const auto& sample) { return sample.amplitudes.norm() > rounding * largest; });
}

std::vector<std::string> notes_of(const sim::reduced::Reduction& reduction, const ReductionOptions& options) {
    std::vector<std::string> notes;
    constexpr const char* or_before = "there, or with less actuation already";
    if (reduction.not_found > 0)
        notes.push_back(
            fmt::format("{} samples were left out: no equilibrium was found {}", reduction.not_found, or_before));
    if (reduction.touching > 0)
        notes.push_back(
            fmt::format("{} samples were left out: the robot touches itself {}, and a reduced model has no contact",
                        reduction.touching, or_before));
    // What modes leave out is seen in motions that the samples have beside them.
    const Eigen::Index possible = moving_samples(reduction), beside = possible - reduction.used;
    if (beside < 2 || 2 * beside < reduction.used)
        notes.push_back(
            fmt::format("the model uses {} of the {} modes that its samples can have, which leaves few to estimate its "
                        "error from: the estimate may be far too small; take more samples (--samples)",
                        reduction.used, possible));
    if (reduction.used == options.most_modes)
        notes.push_back(fmt::format("the modes end at {}, the largest number allowed", options.most_modes));
    if (reduction.force_error > options.force_error)
        notes.push_back(fmt::format("no weights of the tets miss less than {:.2g} of the forces; {:.2g} was wanted",
                                    reduction.force_error, options.force_error));
    return notes;
}

}  // namespace

struct ReducedModel::Data {
    Data(Model of, sim::reduced::ReducedModel made) : whole(std::move(of)), model(std::move(made)) {}
    Model whole;
    sim::reduced::ReducedModel model;
    std::vector<SteeredInput> inputs;
    std::vector<std::string> notes;
};

struct ReducedState::Data {
    std::shared_ptr<const ReducedModel::Data> model;
    sim::reduced::ReducedState state;

    [[nodiscard]] const sim::Model& whole() const { return model->model.whole(); }
};

namespace {

ReducedModel ready(const Model& model, sim::reduced::Reduction reduction, std::vector<std::string> notes) {
    auto made = library::value_of(sim::reduced::ReducedModel::create(model.data()->scene.model, std::move(reduction)));
    auto data = std::make_shared<ReducedModel::Data>(model, std::move(made));
    data->inputs = library::steered_inputs(model.data()->scene.model, task_for(*model.data()));
    data->notes = std::move(notes);
    return ReducedModel(std::move(data));
}

}  // namespace

ReducedModel reduce(const Model& model, const ReductionOptions& options, const Watch& watch) {
    check_reduction_options(options);
    const Model::Data& data = *model.data();
    const sim::InverseTask task = task_for(data);
    library::WatchedProgress progress(watch, "reduce: samples");
    auto reduction =
        sim::reduced::reduce(data.scene.model, options_of_program(data), task,
                             {options.samples, options.basis_error, options.force_error, options.most_modes}, progress);
    progress.rethrow();
    sim::reduced::Reduction made = library::value_of(std::move(reduction));
    std::vector<std::string> notes = notes_of(made, options);
    return ready(model, std::move(made), std::move(notes));
}

ReducedModel::ReducedModel(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

ReducedModel ReducedModel::load(const Model& model, const std::filesystem::path& file) {
    const std::string bytes = library::value_of(read_file(file));
    auto reduction = sim::reduced::reduction_from_bytes(model.data()->scene.model, bytes, origin_of(*model.data()));
    if (!reduction)
        throw Failure(Failure::Kind::input, fmt::format("{}: {}", file.string(), reduction.error().message),
                      file.string());
    return ready(model, std::move(*reduction), {});
}

void ReducedModel::save(const std::filesystem::path& file) const {
    library::check(
        write_file(file, sim::reduced::reduction_bytes(data_->model.reduction(), origin_of(*data_->whole.data()))));
}

const Model& ReducedModel::whole() const {
    return data_->whole;
}
const std::vector<SteeredInput>& ReducedModel::inputs() const {
    return data_->inputs;
}
std::size_t ReducedModel::mode_count() const {
    return static_cast<std::size_t>(data_->model.mode_count());
}
std::size_t ReducedModel::tet_count() const {
    return data_->model.reduction().tets.size();
}
std::size_t ReducedModel::sample_count() const {
    return data_->model.reduction().samples.size();
}
double ReducedModel::force_error() const {
    return data_->model.reduction().force_error;
}
const std::vector<std::string>& ReducedModel::notes() const {
    return data_->notes;
}

ReducedState::ReducedState(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

Inputs ReducedState::inputs() const {
    return library::inputs_of(data_->whole(), data_->state.inputs);
}

std::vector<double> ReducedState::amplitudes() const {
    return library::list_of(data_->state.at.amplitudes);
}

std::vector<Point> ReducedState::markers() const {
    const sim::reduced::ReducedModel& model = data_->model->model;
    const Eigen::VectorXd x = model.part().positions(data_->state.at.amplitudes);
    std::vector<Vec3> markers;
    for (const sim::Marker& marker : model.part().system().model().description().markers)
        markers.push_back(sim::position(marker.point, linalg::view(x)));
    return library::points_of(markers);
}

std::vector<double> ReducedState::tensions_N() const {
    return library::list_of(
        data_->state.at.multipliers.head(static_cast<Eigen::Index>(data_->whole().description().cables.size())));
}

std::vector<double> ReducedState::pressures_Pa() const {
    const sim::Description& d = data_->whole().description();
    return library::list_of(-data_->state.at.multipliers.segment(static_cast<Eigen::Index>(d.cables.size()),
                                                                 static_cast<Eigen::Index>(d.chambers.size())));
}

std::vector<Point> ReducedState::positions() const {
    return library::points_of(linalg::points_of(data_->model->model.positions(data_->state.at.amplitudes)));
}

struct ReducedStepper::Work {
    explicit Work(std::shared_ptr<const ReducedModel::Data> data) : model(std::move(data)), solver(model->model) {}

    [[nodiscard]] const sim::reduced::ReducedState& state_of(const ReducedState& state) const {
        if (state.data().model == model) return state.data().state;
        throw Failure(Failure::Kind::input, "the state is one of another reduced model");
    }
    [[nodiscard]] ReducedState state_of(sim::reduced::ReducedState state) const {
        return ReducedState(std::make_shared<const ReducedState::Data>(ReducedState::Data{model, std::move(state)}));
    }
    /// Made when it is first asked for: a control loop that does without never pays for it.
    struct Whole {
        explicit Whole(const ReducedModel::Data& data)
            : stepper(data.model.whole(), options_of_program(*data.whole.data())), estimator(data.model, stepper) {}
        sim::Stepper stepper;
        sim::reduced::ErrorEstimator estimator;
    };
    [[nodiscard]] Whole& whole() {
        if (!whole_) whole_ = std::make_unique<Whole>(*model);
        return *whole_;
    }

    std::shared_ptr<const ReducedModel::Data> model;
    sim::reduced::ReducedSolver solver;
    library::InUse in_use{"stepper of the reduced model"};

private:
    std::unique_ptr<Whole> whole_;
};

ReducedStepper::ReducedStepper(const ReducedModel& model) : work_(std::make_unique<Work>(model.data())) {}
ReducedStepper::ReducedStepper(ReducedStepper&&) noexcept = default;
ReducedStepper& ReducedStepper::operator=(ReducedStepper&&) noexcept = default;
ReducedStepper::~ReducedStepper() = default;

ReducedState ReducedStepper::start() const {
    const sim::reduced::Sample& first = work_->model->model.reduction().samples.front();
    return work_->state_of(sim::reduced::ReducedState{first.inputs, {first.amplitudes, first.state.multiplier}});
}

ReducedStep ReducedStepper::step(ReducedState& state, const Inputs& inputs) {
    const library::Use use(work_->in_use);
    sim::reduced::ReducedState next = work_->state_of(state);
    const auto report = work_->solver.solve(next, library::inputs_for(work_->model->model.whole(), inputs));
    if (report.found) state = work_->state_of(std::move(next));
    return {report.found, report.iterations};
}

ReducedError ReducedStepper::estimate(const ReducedState& state) {
    const library::Use use(work_->in_use);
    const sim::reduced::ReducedState& at = work_->state_of(state);
    const sim::reduced::Estimate found = work_->whole().estimator.estimate(at);
    ReducedError error;
    error.error_m = found.error_m;
    error.markers_m = found.marker_errors_m;
    if (found.multiplier_errors.size() == 0) return error;
    const sim::Description& d = work_->model->model.whole().description();
    const auto cables = static_cast<Eigen::Index>(d.cables.size()),
               chambers = static_cast<Eigen::Index>(d.chambers.size());
    error.tensions_N = library::list_of(found.multiplier_errors.head(cables).cwiseAbs());
    error.pressures_Pa = library::list_of(found.multiplier_errors.segment(cables, chambers).cwiseAbs());
    return error;
}

State ReducedStepper::exact(const ReducedState& state, const Watch& watch) {
    const library::Use use(work_->in_use);
    const sim::reduced::ReducedState& at = work_->state_of(state);
    library::WatchedProgress progress(watch, "exact state");
    sim::reduced::ErrorEstimator& estimator = work_->whole().estimator;
    auto robot = estimator.exact(at, estimator.estimate(at), progress);
    const bool stopped = progress.cancelled();  // which asks once more
    progress.rethrow();
    if (stopped) library::check(cancelled());
    if (!robot) throw Failure(Failure::Kind::failed, "no equilibrium of the whole robot was found at these inputs");
    return State(std::make_shared<const State::Data>(State::Data{work_->model->whole.data(), std::move(*robot)}));
}

std::vector<ReductionCheck> check_reduction(const ReducedModel& model, int count, const Watch& watch) {
    constexpr int most = 100000;
    if (count < 0 || count > most)
        throw Failure(Failure::Kind::input, fmt::format("{} checks are not possible; 0 to {} are", count, most));
    const Model::Data& data = *model.data()->whole.data();
    library::WatchedProgress progress(watch, "reduce: checks");
    auto rows =
        sim::reduced::check_reduction(model.data()->model, options_of_program(data), task_for(data), count, progress);
    progress.rethrow();
    std::vector<ReductionCheck> checks;
    for (sim::reduced::CheckedInputs& row : library::value_of(std::move(rows)))
        checks.push_back({std::move(row.values), row.found, row.touching, row.motion_m, row.error_m, row.estimated_m,
                          row.multiplier_error, row.reduced_s, row.estimate_s, row.whole_s});
    return checks;
}

}  // namespace pliant
