// pliant simulate: runs the actuation program of a robot file and writes the result folder.
#include "simulation/run/simulate.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "base/core/stopwatch.hpp"
#include "command.hpp"
#include "compare_solvers.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "presentation/report/results.hpp"
#include "presentation/report/summary.hpp"
#include "robot/bodies/build.hpp"
#include "simulation/run/checkpoint.hpp"
#include "simulation/run/fields.hpp"
#include "simulation/scene/build_model.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::string robot;
    std::string folder;
    int steps = 0;
    std::string pictures = "few";
    std::string picture_size;
    std::string view;     ///< "x,y,z" from the robot to the eye; empty: chosen
    std::string solvers;  ///< one, or several with commas
    bool compare = false;
    std::string measured;      ///< CSV of markers; empty: none
    int checkpoint_every = 0;  ///< steps; 0: no checkpoints, or when resumed as before
    bool resume = false;
    std::vector<std::string> assignments;
    Output output;
};

double peak_memory_MB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

/// "neo-hookean, E 12 MPa, Poisson ratio 0.45": what the file says, for people.
std::string law_text(const robot::MaterialSpec& material) {
    return fmt::format("{}, E {:.6g} MPa, Poisson ratio {:.4g}", material::name(material.law),
                       material.youngs_modulus_Pa / 1e6, material.poisson_ratio);
}

report::Simulation describe(const robot::Robot& robot, const sim::Model& model, const sim::Trajectory& trajectory) {
    report::Simulation simulation{.robot = robot.name, .mesh = model.mesh(), .result = trajectory};
    for (const robot::MaterialSpec& m : robot.materials) {
        report::Material material{m.name, law_text(m), m.resin, m.density_kg_m3, {}};
        if (m.colour) material.colour = report::Colour{(*m.colour)[0], (*m.colour)[1], (*m.colour)[2]};
        simulation.materials.push_back(std::move(material));
    }
    for (const robot::BodySpec& body : robot.bodies) simulation.region_material.push_back(body.material);
    simulation.region_material.resize(model.mesh().region_names.size(), -1);  // actuated space carries no material
    simulation.fields = [&model](std::span<const Vec3> positions) { return sim::compute_fields(model, positions); };
    for (const sim::Step& step : trajectory.steps)
        simulation.cable_points.push_back(sim::cable_points(model, step.positions));
    simulation.region_actuates = report::regions_that_actuate(model);
    simulation.obstacles = report::obstacles_of(model, trajectory);
    if (report::has_contact(trajectory)) {
        simulation.contact_pressure_Pa = [&model](const sim::Step& step) { return sim::contact_pressure(model, step); };
    }
    simulation.tolerance = robot.program.tolerance;
    simulation.peak_memory_MB = peak_memory_MB();
    return simulation;
}

void print_summary(const sim::Model& model, const report::Simulation& simulation) {
    const sim::Trajectory& trajectory = simulation.result;
    const sim::Step& last = trajectory.steps.back();
    fmt::print("{}, {}, solver {}\n", counted(model.node_count(), "node"),
               counted(model.mesh().tet_count(), model.mesh().order == 2 ? "quadratic tet" : "linear tet"),
               trajectory.solver);
    fmt::print("{} in {:.2f} s, residual {:.1e}, smallest det F {:.3f}\n", counted(trajectory.steps.size() - 1, "step"),
               trajectory.solve_s, last.residual, last.min_J);
    for (const auto& c : last.cables)
        fmt::print("cable {}: length ratio {:.4f}, {:.2f} mm, tension {:.3f} N\n", c.name, c.length_ratio,
                   1e3 * c.length_m, c.tension_N);
    for (const auto& c : last.chambers)
        fmt::print("chamber {}: volume ratio {:.4f}, {:.1f} mm^3, pressure {:.3f} kPa\n", c.name, c.volume_ratio,
                   1e9 * c.volume_m3, 1e-3 * c.pressure_Pa);
    for (const auto& s : last.springs)
        fmt::print("spring {}: {:.2f} mm, force {:.4f} N\n", s.name, 1e3 * s.length_m, s.force_N);
    for (const auto& c : last.contacts) {
        fmt::print("obstacle {}: presses on the robot with ({:.4f}, {:.4f}, {:.4f}) N\n", c.name, c.force_N.x,
                   c.force_N.y, c.force_N.z);
    }
    if (last.self_contact_N > 0) {
        fmt::print("self-contact: {:.4f} N total, nearest {:.4f} mm\n", last.self_contact_N,
                   1e3 * last.smallest_distance_m);
    }
    for (const auto& s : last.supports) {
        fmt::print("support {}: force ({:.4f}, {:.4f}, {:.4f}) N\n", s.name, s.force_N.x, s.force_N.y, s.force_N.z);
    }
    for (const auto& m : last.markers) {
        fmt::print("marker {}: ({:.3f}, {:.3f}, {:.3f}) mm\n", m.name, 1e3 * m.position_m.x, 1e3 * m.position_m.y,
                   1e3 * m.position_m.z);
    }
    for (const report::Deviation& d : report::deviations(simulation.measured, trajectory))
        fmt::print("{}\n", report::deviation_line(d));
}

/// "800x500".
Result<report::PictureSize> read_picture_size(const std::string& text) {
    report::PictureSize size;
    int used = 0;
    const bool read = std::sscanf(text.c_str(), "%5dx%5d%n", &size.width_px, &size.height_px, &used) == 2 &&
                      used == static_cast<int>(text.size());
    if (!read || std::min(size.width_px, size.height_px) < 100 || std::max(size.width_px, size.height_px) > 10000)
        return input_error(
            "--picture-size: \"{}\" is not possible; write width and height, 100 to 10000 pixels, as in 800x500", text);
    return size;
}

/// "1,-1,0.5".
Result<Vec3> read_view(const std::string& text) {
    Vec3 v;
    int used = 0;
    const bool read = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v.x, &v.y, &v.z, &used) == 3 &&
                      used == static_cast<int>(text.size());
    if (!read || !is_finite(v) || !(norm(v) > 1e-6 && norm(v) < 1e6))
        return input_error("--view: \"{}\" is not possible; write the direction to the eye, as in 1,-1,0.5", text);
    return v;
}

/// None: the robot file's. More than one: a comparison.
Result<std::vector<sim::Solver>> asked_solvers(const Options& options) {
    if (options.compare) return std::vector(sim::all_solvers.begin(), sim::all_solvers.end());
    if (options.solvers.empty()) return std::vector<sim::Solver>{};
    return read_solvers(options.solvers);
}

Result<report::PictureChoice> read_pictures(const Options& options) {
    constexpr std::array<std::pair<std::string_view, report::PictureSet>, 3> sets = {{
        {"none", report::PictureSet::none},
        {"few", report::PictureSet::few},
        {"all", report::PictureSet::all},
    }};
    const auto* const named = std::ranges::find(sets, options.pictures, [](const auto& set) { return set.first; });
    if (named == sets.end()) return input_error("--pictures: \"{}\" is none of none, few, all", options.pictures);
    report::PictureChoice choice{named->second, report::usual_size(named->second)};
    if (!options.picture_size.empty()) {
        const auto size = read_picture_size(options.picture_size);
        if (!size) return tl::unexpected(size.error());
        choice.size = *size;
    }
    if (!options.view.empty()) {
        const auto view = read_view(options.view);
        if (!view) return tl::unexpected(view.error());
        choice.towards_eye = *view;
    }
    return choice;
}

/// Before anything is solved: a slip in the table is told at once.
Result<std::vector<report::MeasuredPath>> read_measured(const std::string& file, const sim::Model& model) {
    if (file.empty()) return std::vector<report::MeasuredPath>{};
    const Result<std::string> text = read_file(file);
    if (!text) return tl::unexpected(text.error());
    std::vector<double> rest;
    for (const Vec3& p : model.mesh().points) rest.insert(rest.end(), {p.x, p.y, p.z});
    sim::Step step;
    for (const sim::Marker& marker : model.description().markers)
        step.markers.push_back({marker.name, sim::position(marker.point, rest)});
    return report::parse_measured(*text, file, step);
}

/// While files are written the first signal leaves the pictures out; only the second cancels.
class Writing final : public Progress {
public:
    explicit Writing(Progress& shown) : shown_(shown) { on_signal(OnSignal::ask_twice); }
    void advance(std::string_view stage, double fraction) override { shown_.advance(stage, fraction); }
    [[nodiscard]] bool cancelled() const override { return interrupted_again(); }

private:
    Progress& shown_;
};

/// `simulation` is told how long it took. True: without the pictures, because they were cancelled.
Result<bool> write_results(const std::string& folder, report::Simulation& simulation,
                           const report::PictureChoice& pictures, Progress& progress) {
    Writing writing(progress);
    bool stopped = false;
    const Status status = write_folder(folder, "summary.json", [&](const std::filesystem::path& path) -> Status {
        const auto written = report::write_results(path, simulation, pictures, writing, progress);
        if (!written) return tl::unexpected(written.error());
        simulation.timing = written->timing;
        stopped = written->drawing_stopped;
        return {};
    });
    if (!status) return tl::unexpected(status.error());
    return stopped;
}

/// Prints what was found, and gives the exit status.
int tell(const Options& options, const sim::Model& model, const report::Simulation& simulation, bool drawing_stopped) {
    const sim::Trajectory& trajectory = simulation.result;
    if (options.output.json)
        fmt::print("{}\n", report::summary_json(simulation));
    else if (!options.output.quiet)
        print_summary(model, simulation);
    if (!options.folder.empty() && !options.output.quiet && !options.output.json)
        fmt::print("results: {}, open report.html there\n", options.folder);
    for (const std::string& warning : trajectory.warnings)
        fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
    if (trajectory.converged && !drawing_stopped) return exit_done;
    fmt::print(stderr, "{}: {}\n", options.robot,
               trajectory.converged ? "cancelled before all pictures were drawn; the other results are there"
                                    : trajectory.message);
    return exit_failed;
}

/// What the command line changes in the robot file.
std::vector<std::string> all_assignments(const Options& options, const std::vector<sim::Solver>& solvers) {
    std::vector<std::string> assignments = options.assignments;
    if (solvers.size() == 1) assignments.push_back(fmt::format("program.solver={}", sim::name(solvers.front())));
    if (options.steps > 0) assignments.push_back(fmt::format("program.steps={}", options.steps));
    return assignments;
}

/// The robot file and everything that changes it: of what a checkpoint is.
Result<std::string> origin_of(const Options& options, const std::vector<std::string>& assignments) {
    const Result<std::string> text = read_file(options.robot);
    if (!text) return tl::unexpected(text.error());
    return fmt::format("{}\n{}", fmt::join(assignments, "\n"), *text);
}

/// Where a run is kept as it goes, and the run that it begins with, if it is one that goes on.
struct Kept {
    sim::Checkpoint checkpoint;
    std::optional<sim::RunState> begin;
};

Result<std::optional<Kept>> open_checkpoint(const Options& options, const std::vector<std::string>& assignments,
                                            const sim::Model& model, const sim::Program& program) {
    if (options.checkpoint_every == 0 && !options.resume) return std::nullopt;
    const Result<std::string> origin = origin_of(options, assignments);
    if (!origin) return tl::unexpected(origin.error());
    const std::string folder = options.folder + ".checkpoint";
    if (!options.resume) {
        auto made = sim::Checkpoint::create(folder, *origin, options.checkpoint_every);
        if (!made) return tl::unexpected(made.error());
        return Kept{std::move(*made), std::nullopt};
    }
    auto resumed = sim::Checkpoint::open(folder, *origin, model, program);
    if (!resumed) return tl::unexpected(resumed.error());
    if (options.checkpoint_every > 0) resumed->checkpoint.set_every(options.checkpoint_every);
    if (!options.output.quiet && !options.output.json)
        fmt::print("going on after step {} of {}\n", resumed->run.step, program.steps);
    return Kept{std::move(resumed->checkpoint), std::move(resumed->run)};
}

sim::Trajectory run(const sim::Model& model, const sim::Program& program, std::optional<Kept>& kept,
                    Progress& progress) {
    sim::RunOptions run;
    if (kept) {
        run.begin = std::move(kept->begin);
        run.checkpoint_every = kept->checkpoint.every();
        run.on_checkpoint = [&](const sim::RunState& state) { return kept->checkpoint.keep(model, state); };
    }
    return sim::run(model, program, progress, std::move(run));
}

/// Of no use after the results are written, unless the run was cancelled.
Status put_away(const std::optional<Kept>& kept, const Options& options, bool cancelled) {
    if (!kept) return {};
    if (!cancelled) return kept->checkpoint.remove();
    if (!options.output.quiet && !options.output.json)
        fmt::print("checkpoint: {}.checkpoint; the same command with --resume goes on from there\n", options.folder);
    return {};
}

Result<int> simulate(const Options& options) {
    if (options.folder.empty() && (options.checkpoint_every > 0 || options.resume))
        return input_error("--{} needs --output: the checkpoint stands beside that folder",
                           options.resume ? "resume" : "checkpoint-every");
    const Result<report::PictureChoice> pictures = read_pictures(options);
    if (!pictures) return tl::unexpected(pictures.error());
    const Result<std::vector<sim::Solver>> solvers = asked_solvers(options);
    if (!solvers) return tl::unexpected(solvers.error());
    auto progress = terminal_progress(options.output);
    on_signal(OnSignal::leave);  // nothing is written before there is a step
    Stopwatch watch;
    report::Timing timing;
    const std::vector<std::string> assignments = all_assignments(options, *solvers);
    Result<robot::Robot> robot = read_robot(options.robot, assignments);
    if (!robot) return tl::unexpected(robot.error());
    Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, *progress);
    if (!mesh) return tl::unexpected(mesh.error());
    timing.mesh_s = watch.read_s();
    Result<sim::Model> model = robot::build_model(*robot, std::move(*mesh));
    if (!model) return tl::unexpected(model.error());
    timing.model_s = watch.read_s();
    const auto measured = read_measured(options.measured, *model);
    if (!measured) return tl::unexpected(measured.error());
    on_signal(OnSignal::ask);
    if (solvers->size() > 1 && (options.checkpoint_every > 0 || options.resume))
        return input_error("a comparison of solvers keeps no checkpoint; leave --checkpoint-every and --resume out");
    if (solvers->size() > 1) return compare_solvers(*model, robot->program, *solvers, options.folder, options.output);
    Result<std::optional<Kept>> kept = open_checkpoint(options, assignments, *model, robot->program);
    if (!kept) return tl::unexpected(kept.error());
    const sim::Trajectory trajectory = run(*model, robot->program, *kept, *progress);
    report::Simulation simulation = describe(*robot, *model, trajectory);
    simulation.timing = timing;
    simulation.measured = *measured;
    bool drawing_stopped = false;
    if (!options.folder.empty()) {
        const Result<bool> written = write_results(options.folder, simulation, *pictures, *progress);
        if (!written) return tl::unexpected(written.error());
        drawing_stopped = *written;
    }
    progress.reset();
    if (Status status = put_away(*kept, options, interrupted()); !status) return tl::unexpected(status.error());
    return tell(options, *model, simulation, drawing_stopped);
}

}  // namespace

void add_simulate(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("simulate", "run the actuation program of a robot file");
    command->add_option("robot", options->robot, "robot file (TOML)")->required();
    command->add_option("-o,--output", options->folder, "folder for the results; without it only a summary is printed");
    command->add_option("--steps", options->steps, "number of steps, in place of the file's")
        ->check(CLI::Range(1, 100000));
    auto* solver = command->add_option("--solver", options->solvers,
                                       "auto, newton, quasi-newton, anderson or local-global, in place of the file's; "
                                       "several, separated by commas, are compared");
    command->add_flag("--compare-solvers", options->compare, "run the program with every solver and compare them")
        ->excludes(solver);
    command->add_option(
        "--pictures", options->pictures,
        "none; few: the final state over the rest shape; all: also rest, intermediate states and stress (few)");
    command->add_option("--picture-size", options->picture_size,
                        "WIDTHxHEIGHT of the pictures in pixels (800x500 of few, 1600x1000 of all)");
    command->add_option("--view", options->view,
                        "X,Y,Z: viewing direction of the pictures (default: where the motion is seen best)");
    command->add_option("--measured", options->measured,
                        "CSV of measured markers, columns as in markers.csv, compared with the simulated ones");
    command
        ->add_option("--checkpoint-every", options->checkpoint_every,
                     "keep the run every so many steps, in FOLDER.checkpoint, to go on with it after a stop")
        ->check(CLI::Range(1, 100000));
    command->add_flag("--resume", options->resume,
                      "go on from FOLDER.checkpoint; the results are the same as without a stop");
    command
        ->add_option("--set", options->assignments,
                     "KEY=VALUE: change any key, as in cable.flexor.target.length_ratio=0.8")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant simulate examples/cable_gripper/gripper.toml -o out --set mesh.order=1");
    on_call(*command, status, [options] { return simulate(*options); });
}

}  // namespace pliant::app
