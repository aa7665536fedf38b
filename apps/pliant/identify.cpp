// pliant identify: finds numbers of a robot from measurements on it.
#include "simulation/identify/identify.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/config.hpp"
#include "base/core/config_text.hpp"
#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "presentation/report/identified.hpp"
#include "robot/bodies/build.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;
using identify::Identification;

struct Options {
    std::string robot;
    std::string measured;
    std::vector<std::string> unknowns;
    std::string judge_on;
    std::vector<std::string> assignments;
    std::string folder;  ///< empty: nothing is written
    Output output;
};

/// Of the keys of a robot file, those that name files, wherever they stand.
void move_paths(config::Value& value, const fs::path& from, const fs::path& to) {
    if (auto* list = std::get_if<config::Array>(&value.data)) {
        for (config::Value& entry : *list) move_paths(entry, from, to);
        return;
    }
    auto* table = std::get_if<config::Table>(&value.data);
    if (table == nullptr) return;
    for (auto& [key, entry] : *table) {
        auto* text = std::get_if<std::string>(&entry.data);
        const bool path = text != nullptr && (key == "geometry" || key == "surface" || key == "file");
        std::error_code ignored;
        if (path && fs::path(*text).is_relative() && fs::exists(from / *text, ignored))
            *text = fs::relative(from / *text, to).generic_string();
        else
            move_paths(entry, from, to);
    }
}

/// The robot file with what the command line and the search have set; paths lead from `folder`.
Result<std::string> changed_robot(const Options& options, const Identification& result) {
    Result<config::Document> document = config::load(options.robot);
    if (!document) return tl::unexpected(document.error());
    std::vector<std::string> all = options.assignments;
    for (const std::string& found : identify::assignments(result)) all.push_back(found);
    for (const std::string& assignment : all) {
        if (Status status = config::set(*document, assignment); !status) return tl::unexpected(status.error());
    }
    move_paths(document->root, fs::absolute(options.robot).parent_path(), fs::absolute(options.folder));
    return fmt::format("# {} with what pliant identify found from {}\n{}", fs::path(options.robot).filename().string(),
                       fs::path(options.measured).filename().string(), config::toml_text(document->root));
}

Status write_results(const Options& options, const Identification& result) {
    if (options.folder.empty()) return {};
    const Result<std::string> robot = changed_robot(options, result);
    if (!robot) return tl::unexpected(robot.error());
    return write_folder(options.folder, "identified.toml", [&](const fs::path& folder) -> Status {
        if (Status status = write_file(folder / "identified.toml", *robot); !status) return status;
        if (Status status = write_file(folder / "summary.json", identify::identification_json(result) + "\n"); !status)
            return status;
        if (Status status = write_file(folder / "comparison.csv", identify::comparison_csv(result)); !status)
            return status;
        for (const report::NamedPlot& named : report::identified_plots(result)) {
            const Result<std::string> png = report::plot_png(named.plot);
            if (!png) return tl::unexpected(png.error());
            if (Status status = write_file(folder / named.file, *png); !status) return status;
        }
        return {};
    });
}

Result<identify::JudgeOn> read_judge(const std::string& text) {
    constexpr std::array<std::pair<std::string_view, identify::JudgeOn>, 3> ways = {{
        {"", identify::JudgeOn::nothing},
        {"every-second", identify::JudgeOn::every_second},
        {"second-half", identify::JudgeOn::second_half},
    }};
    const auto* const found = std::ranges::find(ways, text, [](const auto& way) { return way.first; });
    if (found != ways.end()) return found->second;
    return input_error("--judge-on: \"{}\" is neither every-second nor second-half", text);
}

Result<Identification> find(const Options& options, Progress& progress) {
    const auto judge = read_judge(options.judge_on);
    if (!judge) return tl::unexpected(judge.error());
    const Result<robot::Robot> robot = read_robot(options.robot, options.assignments);
    if (!robot) return tl::unexpected(robot.error());
    std::vector<identify::Unknown> unknowns;
    for (const std::string& text : options.unknowns) {
        auto unknown = identify::find_unknown(*robot, text);
        if (!unknown) return tl::unexpected(unknown.error());
        unknowns.push_back(std::move(*unknown));
    }
    const Result<std::string> table = read_file(options.measured);
    if (!table) return tl::unexpected(table.error());
    Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, progress);
    if (!mesh) return tl::unexpected(mesh.error());
    const auto read = [&options](const std::vector<std::string>& more) {
        std::vector<std::string> all = options.assignments;
        all.insert(all.end(), more.begin(), more.end());
        return read_robot(options.robot, all);
    };
    const identify::Source source(read, std::move(*mesh));
    const auto start = source.with({}, {});
    if (!start) return tl::unexpected(start.error());
    const auto measurements =
        identify::parse_measurements(*table, options.measured, (*start)->model.description(), robot->program, *judge);
    if (!measurements) return tl::unexpected(measurements.error());
    Result<Identification> result = identify::identify(source, unknowns, *measurements, progress);
    if (!result && result.error().cause == Cause::failed)
        return failure("{}: {}", options.robot, result.error().message);
    return result;
}

Result<int> run(const Options& options) {
    const auto progress = terminal_progress(options.output);
    const Result<Identification> result = find(options, *progress);
    if (!result) return tl::unexpected(result.error());
    if (Status status = write_results(options, *result); !status) return tl::unexpected(status.error());
    if (options.output.json)
        fmt::print("{}\n", identify::identification_json(*result));
    else if (!options.output.quiet)
        fmt::print("{}", identify::identification_text(*result));
    for (const std::string& warning : result->warnings) fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
    return result->converged ? exit_done : exit_failed;
}

}  // namespace

void add_identify(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("identify", "finds numbers of a robot from measurements on it");
    command->add_option("robot", options->robot, "robot file")->required();
    command->add_option("--measured", options->measured, "CSV of what was measured, at which time of the program")
        ->required();
    command->add_option("--unknown", options->unknowns, "key of a number to find, or KEY=LOW..HIGH; may be repeated")
        ->type_name("KEY")
        ->allow_extra_args(false)
        ->required();
    command->add_option("--judge-on", options->judge_on,
                        "rows to keep out of the fit and judge it on: every-second or second-half");
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key of the robot file")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command->add_option("-o,--output", options->folder,
                        "folder for identified.toml, summary.json, comparison.csv and plots");
    add_output_options(*command, options->output, true);
    command->footer(
        "Example: pliant identify finger.toml --measured video.csv --unknown material.soft.youngs_modulus -o found");
    on_call(*command, status, [options] { return run(*options); });
}

}  // namespace pliant::app
