// pliant workspace: where markers can get.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "command.hpp"
#include "geometry/files/surface_file.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "presentation/report/pictures.hpp"
#include "presentation/report/workspace_files.hpp"
#include "simulation/inverse/workspace_record.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"
#include "simulation/scene/scene.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    std::string robot;
    std::string folder;
    sim::inverse::WorkspaceOptions search;
    bool resume = false;
    std::vector<std::string> assignments;
    Output output;
};

/// The pieces that are done, in a folder beside the results, with what they belong to.
class KeptPieces {
public:
    /// Without results there is nothing to keep them beside.
    static Result<std::optional<KeptPieces>> open(const Options& options) {
        if (options.folder.empty() && options.resume)
            return input_error("--resume needs --output: what was done stands beside that folder");
        if (options.folder.empty()) return std::optional<KeptPieces>();
        KeptPieces kept(options.folder + ".checkpoint");
        const Result<std::string> text = read_file(options.robot);
        if (!text) return tl::unexpected(text.error());
        const std::string origin = fmt::format("{} {}\n{}\n{}", options.search.side, options.search.between,
                                               fmt::join(options.assignments, "\n"), *text);
        if (options.resume) {
            const Result<std::string> known = read_file(kept.folder_ / "origin");
            if (!known) return input_error("{}: holds no search to go on with", kept.folder_.string());
            if (*known != origin)
                return input_error("{}: is of another robot file, or of other options", kept.folder_.string());
            return std::optional(kept);
        }
        std::error_code code;
        fs::remove_all(kept.folder_, code);
        fs::create_directories(kept.folder_, code);
        if (code) return failure("{}: cannot be made: {}", kept.folder_.string(), code.message());
        if (Status status = write_file(kept.folder_ / "origin", origin); !status) return tl::unexpected(status.error());
        return std::optional(kept);
    }

    [[nodiscard]] std::optional<sim::inverse::WorkspacePiece> read(std::size_t k) const {
        const Result<std::string> bytes = read_file(file_of(k));
        if (!bytes) return std::nullopt;
        auto piece = sim::inverse::piece_from_bytes(*bytes);
        return piece ? std::optional(std::move(*piece)) : std::nullopt;
    }
    [[nodiscard]] Status write(std::size_t k, const sim::inverse::WorkspacePiece& piece) const {
        return write_file(file_of(k), sim::inverse::piece_bytes(piece));
    }
    void remove() const {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    [[nodiscard]] const fs::path& folder() const { return folder_; }

private:
    explicit KeptPieces(fs::path folder) : folder_(std::move(folder)) {}
    [[nodiscard]] fs::path file_of(std::size_t k) const { return folder_ / fmt::format("piece_{:04}", k); }
    fs::path folder_;
};

Result<sim::inverse::Workspace> search(const Options& options, const sim::Model& model, const sim::Program& program,
                                       const sim::InverseTask& task, const std::optional<KeptPieces>& kept,
                                       Progress& progress) {
    return sim::inverse::find_workspace(
        model, sim::stepper_options(program), task, options.search,
        [&](std::size_t k) { return kept ? kept->read(k) : std::nullopt; },
        [&](std::size_t k, const auto& piece) { return kept ? kept->write(k, piece) : Status(); }, progress);
}

/// The rows and columns of all sheets, as lines.
std::vector<report::MeasuredPath> lines_of(const report::WorkspaceReport& report, std::size_t marker) {
    std::vector<report::MeasuredPath> lines;
    for (const sim::inverse::WorkspacePiece& piece : report.workspace.pieces) {
        const auto add = [&](int count, const auto& index) {
            report::MeasuredPath line{report.model.description().markers[marker].name, {}};
            for (int k = 0; k < count; ++k) {
                const auto& sample = piece.samples[static_cast<std::size_t>(index(k))];
                if (sample.found) line.points.push_back(sample.markers[marker]);
            }
            if (!line.points.empty()) lines.push_back(std::move(line));
        };
        for (int row = 0; row < piece.rows; ++row) add(piece.columns, [&](int k) { return row * piece.columns + k; });
        for (int column = 0; piece.rows > 1 && column < piece.columns; ++column)
            add(piece.rows, [&](int k) { return k * piece.columns + column; });
    }
    return lines;
}

/// The robot at rest, with where its first marker can get.
Result<std::string> picture(const robot::Robot& robot, const report::WorkspaceReport& report, Progress& progress) {
    const sim::Stepper stepper(report.model, sim::stepper_options(robot.program));
    const sim::RobotState rest = stepper.rest();
    sim::Trajectory trajectory;
    sim::Step step;
    sim::describe(report.model, stepper.system(), rest.now.state, rest.controls, rest.evaluation, step);
    trajectory.steps = {step};
    report::Simulation simulation = report::simulation_of(robot, report.model, trajectory);
    simulation.measured = lines_of(report, 0);
    simulation.measured_as = "within reach";
    const report::Surface outer = report::outer_surface(simulation.mesh, simulation.region_material);
    const auto pictures = report::draw_pictures(simulation, outer, {}, progress);
    if (!pictures) return tl::unexpected(pictures.error());
    return pictures->front().png;
}

Status write_marker(const report::WorkspaceReport& report, std::size_t marker, const fs::path& folder) {
    std::string name = report.model.description().markers[marker].name;
    for (char& c : name) {
        if (c == '/' || c == '\\' || c == '\0') c = '_';
    }
    const mesh::TriMesh surface = report::workspace_surface(report.workspace, marker);
    if (!surface.triangles.empty()) {
        constexpr double mm_per_m = 1e3;
        Status written = mesh::write_stl(folder / (name + ".stl"), mesh::scaled(surface, mm_per_m));
        if (!written) return written;
    }
    if (surface.points.empty()) return {};
    return write_file(folder / (name + ".vtk"), report::workspace_vtk(report, marker));
}

Status write_results(const Options& options, const robot::Robot& robot, const report::WorkspaceReport& report,
                     Progress& progress) {
    return write_folder(options.folder, "workspace.json", [&](const fs::path& folder) -> Status {
        Status status = write_file(folder / "workspace.csv", report::workspace_csv(report));
        for (std::size_t m = 0; status && m < report.model.description().markers.size(); ++m)
            status = write_marker(report, m, folder);
        if (!status) return status;
        if (!report.model.description().markers.empty() && !lines_of(report, 0).empty()) {
            const Result<std::string> png = picture(robot, report, progress);
            if (!png) return tl::unexpected(png.error());
            if (status = write_file(folder / "workspace.png", *png); !status) return status;
        }
        return write_file(folder / "workspace.json", report::workspace_json(report));
    });
}

Result<int> workspace(const Options& options) {
    auto progress = terminal_progress(options.output);
    on_signal(OnSignal::leave);
    Result<robot::Robot> robot = read_robot(options.robot, options.assignments);
    if (!robot) return tl::unexpected(robot.error());
    const Result<robot::Scene> scene = robot::build_scene(std::move(*robot), *progress);
    if (!scene) return tl::unexpected(scene.error());
    const Result<sim::InverseTask> task = robot::build_goals(scene->robot, scene->model, false);
    if (!task) return tl::unexpected(task.error());
    const Result<std::optional<KeptPieces>> kept = KeptPieces::open(options);
    if (!kept) return tl::unexpected(kept.error());
    on_signal(OnSignal::ask);
    const auto found = search(options, scene->model, scene->robot.program, *task, *kept, *progress);
    if (!found) return tl::unexpected(found.error());
    if (found->cancelled) {
        progress.reset();
        fmt::print(
            stderr, "{}: cancelled{}\n", options.robot,
            *kept ? fmt::format("; the same command with --resume goes on from {}", (*kept)->folder().string()) : "");
        return exit_failed;
    }
    const report::WorkspaceReport report{scene->robot.name, scene->model, *task, *found};
    if (!options.folder.empty()) {
        if (Status status = write_results(options, scene->robot, report, *progress); !status)
            return tl::unexpected(status.error());
        (*kept)->remove();
    }
    progress.reset();
    if (!options.output.quiet || options.output.json) fmt::print("{}", report::workspace_json(report));
    return exit_done;
}

}  // namespace

void add_workspace(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("workspace", "where markers can get within the ranges of the actuators");
    command->add_option("robot", options->robot, "robot file (TOML) with ranges of actuators")->required();
    command->add_option("-o,--output", options->folder, "folder for table, surfaces and picture");
    command->add_option("--side", options->search.side, "places along each input of a sheet")
        ->check(CLI::Range(2, 1000))
        ->capture_default_str();
    command
        ->add_option("--between", options->search.between, "inputs that are spread over the ranges beside the sheets")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    command->add_flag("--resume", options->resume,
                      "go on from FOLDER.checkpoint; the results are the same as without a stop");
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key, as in cable.flexor.range=[0.8, 1]")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant workspace examples/inverse/trunk_helix/robot.toml -o out");
    on_call(*command, status, [options] { return workspace(*options); });
}

}  // namespace pliant::app
