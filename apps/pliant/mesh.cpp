// pliant mesh: builds the tet mesh of a robot file, or reports on mesh files.
#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command.hpp"
#include "mesh/mesh_report.hpp"
#include "mesh/tet_file.hpp"
#include "robot/build.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::vector<std::string> files;
    std::string output_file;
    std::vector<std::string> assignments;
    Output output;
};

bool is_robot_file(const std::string& file) {
    return std::filesystem::path(file).extension() == ".toml";
}

Status build(const Options& options) {
    const auto progress = terminal_progress(options.output);
    Result<robot::Robot> robot = robot::load_robot(options.files.front(), options.assignments);
    if (!robot) return tl::unexpected(robot.error());
    Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, *progress);
    if (!mesh) return tl::unexpected(mesh.error());
    // Files carry the robot's own unit, as the drawing did.
    *mesh = mesh::scaled(std::move(*mesh), 1 / robot->unit_m);
    if (Status status = mesh::write_tet_mesh(options.output_file, *mesh); !status) return status;
    if (!options.output.quiet) fmt::print("{}: {}\n", options.output_file, mesh::report_text(mesh::report_on(*mesh)));
    return {};
}

Status describe(const std::string& file) {
    const Result<std::string> text = mesh::describe_mesh_file(file);
    if (!text) return tl::unexpected(text.error());
    fmt::print("{}: {}\n", file, *text);
    return {};
}

Status run(const Options& options) {
    if (!options.output_file.empty()) {
        if (options.files.size() != 1 || !is_robot_file(options.files.front())) {
            return input_error("-o needs exactly one robot file (.toml) to mesh");
        }
        return build(options);
    }
    for (const std::string& file : options.files) {
        if (is_robot_file(file)) return input_error("{}: name the mesh to write with -o FILE.vtk or -o FILE.vtu", file);
        if (Status status = describe(file); !status) return status;
    }
    return {};
}

}  // namespace

void add_mesh(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("mesh", "build the tet mesh of a robot file, or report on mesh files");
    command->add_option("files", options->files, "a robot file with -o, or mesh files (.vtk, .stl, ...)")->required();
    command->add_option("-o,--output", options->output_file, "mesh file to write: .vtk or .vtu, in the robot's unit");
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key of the robot file")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, false);
    command->footer("Example: pliant mesh examples/cable_gripper/gripper.toml -o gripper.vtk");
    command->callback([options, &status] {
        const Status result = run(*options);
        status = result ? exit_done : report(result.error());
    });
}

}  // namespace pliant::app
