// pliant check: validates robot, printer, job and mesh files.
#include "printing/plan/check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "../usage.hpp"
#include "base/core/config.hpp"
#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "command.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/open/describe_file.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "printed.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/board_report.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "printing/machine/printer.hpp"
#include "printing/operate/board.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/proved_job.hpp"
#include "printing/plan/safe_stop.hpp"
#include "robot/description/unused.hpp"
#include "simulation/scene/scene.hpp"

namespace pliant::app {
namespace {

struct CheckOptions {
    std::vector<std::string> files;
    std::string printer;
    std::string port;
    bool firmware = false;
    int cancel_after = -1;
    std::vector<std::string> assignments;
    Output output;
};

/// A robot is meshed for the check: overlaps, cables outside, empty selectors only show then.
Result<std::string> check_robot(const std::string& file, const std::vector<std::string>& assignments,
                                Progress& progress) {
    Result<robot::Robot> read = read_robot(file, assignments);
    if (!read) return tl::unexpected(read.error());
    const Result<robot::Scene> scene = robot::build_scene(std::move(*read), progress);
    if (!scene) return tl::unexpected(scene.error());
    const robot::Robot& robot = scene->robot;
    std::string text =
        fmt::format("robot \"{}\": {}, {}, {}, {}", robot.name, counted(robot.bodies.size(), "body", "bodies"),
                    counted(robot.materials.size(), "material"), counted(robot.cables.size(), "cable"),
                    counted(scene->model.mesh().tet_count(), "tet"));
    for (const std::string& note : robot.notes) text += "\n  note: " + note;
    for (const std::string& note : robot::unused_materials(robot)) text += "\n  note: " + note;
    for (const std::string& note : scene->mesh_notes) text += "\n  note: " + note;
    for (const std::string& note : scene->model.description().notes) text += "\n  note: " + note;
    return text;
}

Result<std::string> check_printer(const std::string& file) {
    const Result<machine::Printer> printer = read_printer(file);
    if (!printer) return tl::unexpected(printer.error());
    if (auto mask = operate::load_mask(printer->projector, file); !mask) return tl::unexpected(mask.error());
    return fmt::format("printer \"{}\": {}, {}, {} x {} px", printer->name,
                       counted(static_cast<std::size_t>(printer->slot_count()), "slot"),
                       counted(printer->vats.size(), "vat"), printer->projector.width_px, printer->projector.height_px);
}

/// Robot and printer files are distinguished by keys that only one of them has.
Result<std::string> check_toml(const std::string& file, const CheckOptions& options, Progress& progress) {
    const Result<config::Document> document = config::load(file);
    if (!document) return tl::unexpected(document.error());
    for (const auto& [key, value] : std::get<config::Table>(document->root.data)) {
        if (key == "axis" || key == "projector" || key == "vat" || key == "tower") {
            if (!options.assignments.empty()) return no_assignments(file);
            return check_printer(file);
        }
    }
    return check_robot(file, options.assignments, progress);
}

Result<std::string> check_job(const std::string& file, const CheckOptions& options) {
    std::optional<machine::Printer> other;
    if (!options.printer.empty()) {
        Result<machine::Printer> printer = read_printer(options.printer);
        if (!printer) return tl::unexpected(printer.error());
        other = std::move(*printer);
    }
    const Result<operate::ProvedJob> job = prove_job(file, operate::Pixels::areas, other ? &*other : nullptr);
    if (!job) return tl::unexpected(job.error());
    const job::Manifest& manifest = job->archive.manifest();
    std::size_t images = 0;
    for (const job::Layer& layer : manifest.layers) images += layer.images.size();
    std::string text =
        fmt::format("job \"{}\": {}, {}, {}; its G-code prints what the manifest says{}", manifest.name,
                    counted(manifest.layers.size(), "layer"), counted(images, "image"),
                    counted(manifest.materials.size(), "material"), other ? " on the " + other->name : "");
    for (const std::string& warning : job->warnings) text += "\n  warning: " + warning;
    return text;
}

/// Checks any G-code against the machine that is to run it.
Result<std::string> check_program(const std::string& file, const CheckOptions& options) {
    if (options.printer.empty()) return input_error("{}: give --printer, the machine that is to run it", file);
    const Result<machine::Printer> printer = read_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    const Result<std::string> text = read_file(file, std::uintmax_t{1} << 30);
    if (!text) return tl::unexpected(text.error());
    const auto count = std::count(text->begin(), text->end(), '\n') + (text->empty() || text->back() == '\n' ? 0 : 1);
    if (options.cancel_after > count)
        return input_error("--cancel-after {}: {} has {} lines", options.cancel_after, file, count);
    const int lines = options.cancel_after >= 0 ? options.cancel_after : std::numeric_limits<int>::max();
    const Result<machine::Interlock> end = plan::replay_gcode(*text, *printer, lines);
    if (!end) return input_error("{}: {}", file, end.error().message);
    if (options.cancel_after >= 0) {
        return fmt::format("to end safely after line {}:\n{}", lines, plan::cancel_program(*end, *printer));
    }
    return fmt::format("G-code of {} lines keeps the limits of {}", count, printer->name);
}

/// Compares a board's answers with the machine that it is to drive.
Result<std::string> check_firmware(const std::string& where, const Result<std::string>& answers,
                                   const machine::Printer& printer) {
    if (!answers) return tl::unexpected(answers.error());
    const machine::BoardReport board = machine::parse_board_report(*answers);
    std::vector<Diagnostic> problems;
    for (const std::string& problem : machine::check_board(board, printer)) problems.push_back({where, 0, "", problem});
    if (!problems.empty()) return tl::unexpected(error_of(Cause::failed, std::move(problems)));
    return fmt::format("firmware \"{}\" fits {}", board.name, printer.name);
}

Result<std::string> check_boards(const std::string& file, const CheckOptions& options) {
    if (options.printer.empty())
        return input_error("--firmware: give --printer, the machine that the board is to drive");
    const Result<machine::Printer> printer = read_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    if (file == options.port)
        return check_firmware(file, operate::ask_board(file, printer->controller.baud_rate), *printer);
    return check_firmware(file, read_file(file, 1 << 20), *printer);
}

/// Any bytes could begin a binary STL file, whose message would say nothing of a file of another kind.
Result<std::string> check_geometry(const std::string& file) {
    Result<std::string> text = mesh::describe_mesh_file(file);
    std::error_code ignored;
    if (text || kind_of(file) != FileKind::unknown || !std::filesystem::is_regular_file(file, ignored)) return text;
    return input_error(
        "{}: is not recognised; pliant check reads robot and printer files (.toml), jobs (.zip), G-code (.gcode), and "
        "by content STL, OBJ, PLY, OFF, STEP, 3MF and tet meshes",
        file);
}

Result<std::string> check(const std::string& file, const CheckOptions& options, Progress& progress) {
    const std::string extension = lower_extension(file);
    const bool is_program = extension == ".gcode" || extension == ".g" || extension == ".gco";
    if (options.cancel_after >= 0 && (options.firmware || !is_program))
        return input_error("{}: is no G-code file; --cancel-after ends a G-code program", file);
    if (options.firmware) return check_boards(file, options);
    if (machine::is_built_in_printer(file)) return check_printer(file);
    if (extension == ".toml") return check_toml(file, options, progress);
    if (!options.assignments.empty()) return no_assignments(file);
    if (extension == ".zip") return check_job(file, options);
    if (is_program) return check_program(file, options);
    return check_geometry(file);
}

nlohmann::json result_json(const std::string& file, const Result<std::string>& text) {
    return {
        {"file", file}, {"valid", text.has_value()}, {text ? "text" : "error", text ? *text : text.error().message}};
}

}  // namespace

void add_check(CLI::App& app, int& status) {
    auto options = std::make_shared<CheckOptions>();
    CLI::App* command = app.add_subcommand("check", "validate robot, printer, job, G-code and mesh files");
    command->add_option("files", options->files, "files to check");
    command->add_flag("--firmware", options->firmware,
                      "check how the board at --port was built; files: its answers to M115, M503, M211, M119, M113");
    command->add_option("--port", options->port, "serial port of the board, such as /dev/ttyACM0");
    command->add_option("--printer", options->printer,
                        "printer that G-code files are checked against, and jobs in place of their own");
    command
        ->add_option("--cancel-after", options->cancel_after,
                     "line of a G-code program to stop after: print the commands that do so safely")
        ->check(between(0, std::numeric_limits<int>::max()));
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key of the robot files")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant check examples/cable_gripper/gripper.toml examples/printers/tower.toml");
    command->callback([options, &status] {
        if (!options->port.empty() && options->firmware) options->files.push_back(options->port);
        if (options->files.empty()) {
            status = report({Cause::input, "give files to check, or --firmware with --port"});
        } else if (!options->port.empty() && !options->firmware) {
            status = report({Cause::input, "--port goes with --firmware"});
            options->files.clear();
        }
        nlohmann::json results = nlohmann::json::array();
        for (const std::string& file : options->files) {
            auto progress = terminal_progress(options->output);
            on_signal(OnSignal::leave);  // no output to clean up
            const Result<std::string> text = check(file, *options, *progress);
            progress.reset();
            if (!text) status = report(text.error());
            if (options->output.json)
                results.push_back(result_json(file, text));
            else if (text && !options->output.quiet)
                fmt::print("{}: {}\n", one_line(file), *text);
        }
        if (options->output.json) print_json(nlohmann::json{{"files", results}});
    });
}

}  // namespace pliant::app
