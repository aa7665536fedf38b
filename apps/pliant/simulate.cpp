// pliant simulate: runs the actuation program of a robot file and writes the result folder.
#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "../usage.hpp"
#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "base/core/vec3.hpp"
#include "command.hpp"
#include "compare_solvers.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "library/simulation/data.hpp"
#include "library/simulation/unfinished_run.hpp"
#include "output_option.hpp"
#include "pliant/program.hpp"
#include "presentation/report/readable.hpp"
#include "presentation/report/results.hpp"
#include "watched.hpp"

namespace pliant::app {
namespace {

using report::readable;

struct SimulateOptions {
    std::string robot;
    std::string folder;
    int steps = 0;
    std::string pictures;  ///< empty: few
    std::string picture_size;
    bool film = false;
    std::string view;     ///< "x,y,z" from the robot to the camera; empty: automatic
    std::string solvers;  ///< one, or several with commas
    bool compare = false;
    std::string measured;      ///< CSV of measured markers; empty: none
    int checkpoint_every = 0;  ///< in steps; 0: no checkpoints, or as before when resumed
    bool resume = false;
    std::vector<std::string> assignments;
    Output output;
};

/// Others may be rounding errors of it.
double largest_force_N(const Observation& last) {
    double largest = 0;
    const auto add = [&](double force_N) { largest = std::max(largest, std::fabs(force_N)); };
    for (const auto& cable : last.cables) add(cable.tension_N);
    for (const auto& [name, force_N] : last.contacts) std::ranges::for_each(force_N, add);
    for (const auto& [name, force_N] : last.supports) std::ranges::for_each(force_N, add);
    return largest;
}

void print_summary(const Model& model, const ProgramResult& result) {
    const ProgramStep step = result.step(result.step_count() - 1);
    const Observation& last = step.observed;
    const double rounding_N = std::max(1e-12, 1e-6 * largest_force_N(last));
    fmt::print("{}, {}, solver {}\n", counted(model.node_count(), "node"),
               counted(model.tet_count(), model.order() == 2 ? "quadratic tet" : "linear tet"), result.solver());
    fmt::print("{} in {:.2f} s, residual {:.1e}, smallest det F {:.3f}\n", counted(result.step_count() - 1, "step"),
               result.solve_s(), step.result.residual, last.min_J);
    for (const auto& c : last.cables)
        fmt::print("cable {}: length ratio {:.4f}, {} mm, tension {} N\n", c.name, c.length_ratio,
                   readable(1e3 * c.length_m, 2), readable(c.tension_N, 3));
    for (const auto& c : last.chambers)
        fmt::print("chamber {}: volume ratio {:.4f}, {} mm^3, pressure {} kPa\n", c.name, c.volume_ratio,
                   readable(1e9 * c.volume_m3, 1), readable(1e-3 * c.pressure_Pa, 3));
    for (const auto& s : last.springs)
        fmt::print("spring {}: {} mm, force {} N\n", s.name, readable(1e3 * s.length_m, 2), readable(s.force_N, 4));
    for (const auto& [name, force_N] : last.contacts) {
        const bool none = std::ranges::all_of(force_N, [&](double f) { return std::fabs(f) < rounding_N; });
        if (none && !last.objects.empty()) continue;  // objects may stand on it, whose forces are not among these
        fmt::print("obstacle {}: presses on the robot with ({}) N\n", name, readable(force_N, 4, rounding_N));
    }
    if (last.self_contact_N > 0) {
        fmt::print("self-contact: {} N total, nearest {} mm\n", readable(last.self_contact_N, 4),
                   readable(1e3 * last.smallest_distance_m, 4));
    }
    for (const auto& [name, force_N] : last.supports)
        fmt::print("support {}: force ({}) N\n", name, readable(force_N, 4, rounding_N));
    for (const auto& [name, p] : last.markers)
        fmt::print("marker {}: ({}) mm\n", name, readable(std::array{1e3 * p[0], 1e3 * p[1], 1e3 * p[2]}, 3));
    for (const std::string& line : result.deviations()) fmt::print("{}\n", line);
}

/// "800x500".
Result<std::array<int, 2>> read_picture_size(const std::string& text) {
    int width = 0, height = 0, used = 0;
    const bool read =
        std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) == 2 && used == static_cast<int>(text.size());
    if (!read || std::min(width, height) < 100 || std::max(width, height) > 10000)
        return input_error(
            "--picture-size: \"{}\" is not possible; write width and height, 100 to 10000 pixels, as in 800x500", text);
    return std::array{width, height};
}

/// "1,-1,0.5".
Result<Point> read_view(const std::string& text) {
    Vec3 v;
    int used = 0;
    const bool read = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v.x, &v.y, &v.z, &used) == 3 &&
                      used == static_cast<int>(text.size());
    if (!read || !is_finite(v) || !(norm(v) > 1e-6 && norm(v) < 1e6))
        return input_error("--view: \"{}\" is not possible; write the direction towards the viewer, as in 1,-1,0.5",
                           text);
    return Point{v.x, v.y, v.z};
}

/// Empty: that of the robot file. More than one: a comparison.
Result<std::vector<sim::Solver>> asked_solvers(const SimulateOptions& options) {
    if (options.compare) return std::vector(sim::all_solvers.begin(), sim::all_solvers.end());
    if (options.solvers.empty()) return std::vector<sim::Solver>{};
    return read_solvers(options.solvers);
}

Result<ResultsOptions> read_pictures(const SimulateOptions& options) {
    constexpr std::array<std::pair<std::string_view, Pictures>, 3> sets = {{
        {"none", Pictures::none},
        {"few", Pictures::few},
        {"all", Pictures::all},
    }};
    const std::string asked = options.pictures.empty() ? "few" : options.pictures;
    const auto* const named = std::ranges::find(sets, asked, [](const auto& set) { return set.first; });
    if (named == sets.end()) return input_error("--pictures: \"{}\" must be none, few or all", options.pictures);
    ResultsOptions choice{
        .pictures = named->second, .film = options.film, .enough_pictures = [] { return interrupted(); }};
    if (!options.picture_size.empty()) {
        const auto size = read_picture_size(options.picture_size);
        if (!size) return tl::unexpected(size.error());
        choice.picture_size_px = *size;
    }
    if (!options.view.empty()) {
        const auto view = read_view(options.view);
        if (!view) return tl::unexpected(view.error());
        choice.towards_eye = *view;
    }
    return choice;
}

/// While files are written, the first signal skips the pictures; only the second cancels. False: without pictures.
bool write_results(const SimulateOptions& options, const ResultsOptions& pictures, ProgramResult& result,
                   Progress& progress) {
    on_signal(OnSignal::ask_twice);
    return result.write(options.folder, pictures, [&](std::string_view stage, double share) {
        progress.advance(stage, share);
        return !interrupted_again();
    });
}

/// Prints the results, and returns the exit status.
int tell_result(const SimulateOptions& options, const Model& model, const ProgramResult& result, bool all_drawn) {
    if (options.output.json)
        fmt::print("{}\n", result.summary_json());
    else if (!options.output.quiet)
        print_summary(model, result);
    if (!options.folder.empty() && !options.output.quiet && !options.output.json)
        fmt::print("results: {}, open report.html there\n", options.folder);
    for (const std::string& warning : result.warnings())
        fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
    if (result.converged() && all_drawn) return exit_done;
    fmt::print(stderr, "{}: {}\n", options.robot,
               result.converged() ? "cancelled before all pictures were drawn; the other results are written"
                                  : result.message());
    return exit_failed;
}

/// All overrides of the robot file from the command line.
std::vector<std::string> all_assignments(const SimulateOptions& options, const std::vector<sim::Solver>& solvers) {
    std::vector<std::string> assignments = options.assignments;
    if (solvers.size() == 1) assignments.push_back(fmt::format("program.solver={}", sim::name(solvers.front())));
    if (options.steps > 0) assignments.push_back(fmt::format("program.steps={}", options.steps));
    return assignments;
}

RunOptions run_options(const SimulateOptions& options, const Robot& robot) {
    RunOptions run{
        .measured = options.measured, .checkpoint_every = options.checkpoint_every, .resume = options.resume};
    if (options.checkpoint_every == 0 && !options.resume) return run;
    run.checkpoint = beside_folder(options.folder, ".checkpoint");
    if (!options.output.quiet && !options.output.json)
        run.on_resume = [steps = robot.steps()](int step) {
            fmt::print("resuming after step {} of {}\n", step, steps);
        };
    return run;
}

/// A run that keeps no checkpoint leaves the one that is there: of this run unfinished, it may have been forgotten.
void note_left_checkpoint(const SimulateOptions& options, const Model& model) {
    if (options.folder.empty() || options.checkpoint_every > 0 || options.resume) return;
    const std::filesystem::path folder = beside_folder(options.folder, ".checkpoint");
    if (const std::optional<int> step = library::unfinished_step(*model.data(), folder))
        fmt::print(stderr,
                   "{}: note: {} holds this run up to step {} of {} and is left as it is; --resume continues "
                   "from there\n",
                   options.robot, folder.string(), *step, model.data()->scene.robot.program.steps);
}

/// Removes the checkpoint: it is useless after the results are written, unless the run was cancelled.
void put_away(const SimulateOptions& options, const ProgramResult& result) {
    if (!interrupted()) return result.remove_checkpoint();
    if (options.checkpoint_every == 0 && !options.resume) return;
    if (!options.output.quiet && !options.output.json)
        fmt::print("checkpoint: {}; the same command with --resume continues from there\n",
                   beside_folder(options.folder, ".checkpoint").string());
}

/// An option that has a meaning only for the files of one run; null: none was given.
const char* option_of_files(const SimulateOptions& options) {
    if (options.film) return "film";
    if (!options.pictures.empty() && options.pictures != "none") return "pictures";
    if (!options.picture_size.empty()) return "picture-size";
    return options.view.empty() ? nullptr : "view";
}

Status check_options(const SimulateOptions& options, const std::vector<sim::Solver>& solvers) {
    const char* const of_files = option_of_files(options);
    const bool kept = options.checkpoint_every > 0 || options.resume;
    if (kept && options.folder.empty())
        return input_error("--{} needs --output: the checkpoint is kept next to that folder",
                           options.resume ? "resume" : "checkpoint-every");
    if (options.film && options.folder.empty())
        return input_error("--film needs --output: film.gif goes into that folder");
    if (kept && solvers.size() > 1)
        return input_error("a comparison of solvers has no checkpoints; leave out --checkpoint-every and --resume");
    if (of_files != nullptr && solvers.size() > 1)
        return input_error("a comparison of solvers has no pictures or film of the robot; leave out --{}", of_files);
    if (!options.measured.empty() && solvers.size() > 1)
        return input_error("a comparison of solvers compares no measured markers; leave out --measured");
    if (of_files != nullptr && options.folder.empty())
        return input_error("--{} needs --output: the pictures go into that folder", of_files);
    if (Status robot = expect(FileKind::robot, options.robot); !robot) return robot;
    const FolderMark mark = solvers.size() > 1 ? FolderMark("comparison.json") : report::simulation_mark();
    return check_results_place(options.folder, mark, options.robot, options.assignments, options.measured);
}

Result<int> simulate(const SimulateOptions& options) {
    const Result<ResultsOptions> pictures = read_pictures(options);
    if (!pictures) return tl::unexpected(pictures.error());
    const Result<std::vector<sim::Solver>> solvers = asked_solvers(options);
    if (!solvers) return tl::unexpected(solvers.error());
    if (Status status = check_options(options, *solvers); !status) return tl::unexpected(status.error());
    auto progress = terminal_progress(options.output);
    const Watch watch = watch_of(*progress);
    on_signal(OnSignal::leave);  // nothing is written before the first step
    const Robot robot = Robot::load(options.robot, all_assignments(options, *solvers));
    const Model model(robot, watch);
    on_signal(OnSignal::ask);
    if (solvers->size() > 1)
        return compare_solvers(model.data()->scene.model, robot.data().robot.program, *solvers, options.folder,
                               options.output);
    note_left_checkpoint(options, model);
    ProgramResult result = run(model, run_options(options, robot), watch);
    const bool all_drawn = options.folder.empty() || write_results(options, *pictures, result, *progress);
    progress.reset();
    put_away(options, result);
    return tell_result(options, model, result, all_drawn);
}

}  // namespace

void add_simulate(CLI::App& app, int& status) {
    auto options = std::make_shared<SimulateOptions>();
    CLI::App* command = app.add_subcommand("simulate", "run the actuation program of a robot file");
    command->add_option("robot", options->robot, "robot file (TOML)")->required();
    add_output_path(*command, options->folder, "folder for the results; without it only a summary is printed");
    command->add_option("--steps", options->steps, "number of steps, in place of the file's")
        ->check(between(1, 100000));
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
    command->add_flag("--film", options->film, "also write film.gif, the motion as an animated GIF");
    command->add_option("--view", options->view,
                        "X,Y,Z: direction towards the viewer (default: from where the motion is seen best)");
    command->add_option("--measured", options->measured,
                        "CSV of measured markers, columns as in markers.csv, compared with the simulated ones");
    command
        ->add_option("--checkpoint-every", options->checkpoint_every,
                     "write a checkpoint every so many steps to FOLDER.checkpoint, to resume from after a stop")
        ->check(between(1, 100000));
    command->add_flag("--resume", options->resume,
                      "resume from FOLDER.checkpoint; the results are the same as without a stop");
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
