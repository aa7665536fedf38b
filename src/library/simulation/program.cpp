#include "pliant/program.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <utility>

#include "base/core/files.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "library/simulation/drawing.hpp"
#include "library/simulation/unfinished_run.hpp"
#include "presentation/report/measured.hpp"
#include "presentation/report/results.hpp"
#include "presentation/report/summary.hpp"
#include "simulation/run/checkpoint.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant {

/// A report refers to the trajectory: it is created once, and must not be moved.
struct ProgramResult::Data {
    std::shared_ptr<const Model::Data> model;
    sim::Trajectory trajectory;
    std::optional<sim::Checkpoint> checkpoint;
    std::optional<report::Simulation> report{};
};

namespace {

using Measured = std::vector<report::MeasuredPath>;

double peak_memory_MB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// Read before solving: errors in the table are reported at once.
Measured read_measured(const std::filesystem::path& file, const sim::Model& model) {
    if (file.empty()) return {};
    const std::string text = library::value_of(read_file(file));
    std::vector<double> rest;
    for (const Vec3& p : model.mesh().points) rest.insert(rest.end(), {p.x, p.y, p.z});
    sim::Step step;
    for (const sim::Marker& marker : model.description().markers)
        step.markers.push_back({marker.name, sim::position(marker.point, rest)});
    return library::value_of(report::parse_measured(text, file.string(), step));
}

/// The checkpoint of a run, and the run it continues, if it was resumed.
struct Kept {
    std::optional<sim::Checkpoint> checkpoint;
    std::optional<sim::RunState> begin;
};

/// A run that was interrupted may have taken hours: one forgotten option does not throw it away. What cannot be resumed
/// is left to Checkpoint::create().
void refuse_to_replace_unfinished(const Model::Data& model, const std::filesystem::path& folder) {
    const std::optional<int> step = library::unfinished_step(model, folder);
    if (!step) return;
    throw Failure(Failure::Kind::input,
                  fmt::format("{}: holds this run up to step {} of {}, which a new run would delete; resume it, or "
                              "remove the folder",
                              folder.string(), *step, model.scene.robot.program.steps),
                  folder.string());
}

Kept open_checkpoint(const Model::Data& model, const RunOptions& options) {
    if (options.checkpoint_every < 0) throw Failure(Failure::Kind::input, "checkpoint_every is negative");
    if (options.checkpoint.empty()) {
        if (options.checkpoint_every > 0 || options.resume)
            throw Failure(Failure::Kind::input, "a checkpoint is asked for, but no folder is named for it");
        return {};
    }
    if (!options.resume) {
        refuse_to_replace_unfinished(model, options.checkpoint);
        const int every = std::max(options.checkpoint_every, 1);
        return {library::value_of(sim::Checkpoint::create(options.checkpoint, model.robot->origin(), every)),
                std::nullopt};
    }
    auto resumed = library::value_of(
        sim::Checkpoint::open(options.checkpoint, model.robot->origin(), model.scene.model, model.scene.robot.program));
    if (options.checkpoint_every > 0) resumed.checkpoint.set_every(options.checkpoint_every);
    if (options.on_resume) options.on_resume(resumed.run.step);
    return {std::move(resumed.checkpoint), std::move(resumed.run)};
}

ProgramStep program_step(const sim::Step& step) {
    return {step.index, step.time, library::result_of(step), library::observation_of(step),
            library::points_of(step.positions)};
}

report::PictureChoice picture_choice(const ResultsOptions& options) {
    const auto set = static_cast<report::PictureSet>(options.pictures);
    report::PictureChoice choice{set, report::usual_size(set)};
    choice.film = options.film;
    if (options.picture_size_px != std::array<int, 2>{0, 0}) {
        const auto [width, height] = options.picture_size_px;
        if (std::min(width, height) < 100 || std::max(width, height) > 10000)
            throw Failure(
                Failure::Kind::input,
                fmt::format("pictures of {} x {} pixels are not possible; write 100 to 10000 for each", width, height));
        choice.size = {width, height};
    }
    if (options.towards_eye) {
        const Point& p = *options.towards_eye;
        const Vec3 eye{p[0], p[1], p[2]};
        if (!is_finite(eye) || !(norm(eye) > 1e-6 && norm(eye) < 1e6))
            throw Failure(Failure::Kind::input, fmt::format("a view from ({:g}, {:g}, {:g}) is not possible; write the "
                                                            "direction from the robot to the eye",
                                                            p[0], p[1], p[2]));
        choice.towards_eye = eye;
    }
    return choice;
}

}  // namespace

ProgramResult run(const Model& model, const RunOptions& options, const Watch& watch) {
    const Model::Data& data = *model.data();
    Measured measured = read_measured(options.measured, data.scene.model);
    Kept kept = open_checkpoint(data, options);
    library::WatchedProgress progress(watch, "simulate");
    sim::RunOptions run;
    run.begin = std::move(kept.begin);
    if (options.on_step) run.on_step = [&](const sim::Step& step) { options.on_step(program_step(step)); };
    if (kept.checkpoint) {
        run.checkpoint_every = kept.checkpoint->every();
        run.on_checkpoint = [&](const sim::RunState& state) { return kept.checkpoint->keep(data.scene.model, state); };
    }
    sim::Trajectory trajectory = sim::run(data.scene.model, data.scene.robot.program, progress, std::move(run));
    progress.rethrow();
    // Whoever holds the result may begin or resume another run there.
    if (kept.checkpoint) kept.checkpoint->release();
    auto result = std::make_shared<ProgramResult::Data>(
        ProgramResult::Data{model.data(), std::move(trajectory), std::move(kept.checkpoint)});
    report::Simulation& report =
        result->report.emplace(report::simulation_of(data.scene.robot, data.scene.model, result->trajectory));
    report.timing.mesh_s = data.scene.mesh_s;
    report.timing.model_s = data.scene.model_s;
    report.measured = std::move(measured);
    report.peak_memory_MB = peak_memory_MB();
    return ProgramResult(std::move(result));
}

ProgramResult::ProgramResult(std::shared_ptr<Data> data) : data_(std::move(data)) {}

bool ProgramResult::converged() const {
    return data_->trajectory.converged;
}
const std::string& ProgramResult::message() const {
    return data_->trajectory.message;
}
const std::vector<std::string>& ProgramResult::warnings() const {
    return data_->trajectory.warnings;
}
const std::string& ProgramResult::solver() const {
    return data_->trajectory.solver;
}
double ProgramResult::solve_s() const {
    return data_->trajectory.solve_s;
}
std::size_t ProgramResult::step_count() const {
    return data_->trajectory.steps.size();
}

ProgramStep ProgramResult::step(std::size_t index) const {
    if (index >= step_count())
        throw Failure(Failure::Kind::input,
                      fmt::format("there is no step {}; the last is {}", index, step_count() - 1));
    return program_step(data_->trajectory.steps[index]);
}

std::vector<std::string> ProgramResult::deviations() const {
    std::vector<std::string> lines;
    for (const report::Deviation& deviation : report::deviations(data_->report->measured, data_->trajectory))
        lines.push_back(report::deviation_line(deviation));
    return lines;
}

std::string ProgramResult::summary_json() const {
    return report::summary_json(*data_->report);
}

bool ProgramResult::write(const std::filesystem::path& folder, const ResultsOptions& options, const Watch& watch) {
    if (folder.empty()) throw Failure(Failure::Kind::input, "the name of the folder for the results is empty");
    data_->model->robot->check_outside(folder);
    const report::PictureChoice choice = picture_choice(options);
    library::WatchedProgress writing(watch, "results");
    library::Drawing drawing(writing, options.enough_pictures);
    bool stopped = false;
    const Status status =
        write_folder(folder, report::simulation_mark(), [&](const std::filesystem::path& path) -> Status {
            const auto written = report::write_results(path, *data_->report, choice, writing, drawing);
            if (!written) return tl::unexpected(written.error());
            if (drawing.failed()) return cancelled();
            data_->report->timing = written->timing;
            stopped = written->drawing_stopped;
            if (!written->warning.empty()) data_->trajectory.warnings.push_back(written->warning);
            return {};
        });
    writing.rethrow();
    drawing.rethrow();
    library::check(status);
    return !stopped;
}

void ProgramResult::remove_checkpoint() const {
    if (data_->checkpoint) library::check(data_->checkpoint->remove());
}

}  // namespace pliant
