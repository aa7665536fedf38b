// pliant mesh: builds the tet mesh of a robot file, converts one mesh file to another, or reports on mesh files.
#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "command.hpp"
#include "core/files.hpp"
#include "core/units.hpp"
#include "mesh/mesh_report.hpp"
#include "mesh/tet_file.hpp"
#include "mesh/tet_writer.hpp"
#include "report/mesh_picture.hpp"
#include "robot/build.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::vector<std::string> files;
    std::string output_file;
    std::string picture_file;
    std::string from_unit;
    std::string to_unit;
    std::vector<std::string> assignments;
    bool text = false;
    Output output;
};

bool is_robot_file(const std::string& file) {
    return std::filesystem::path(file).extension() == ".toml";
}

Result<mesh::TetMesh> build(const Options& options) {
    if (!options.from_unit.empty() || !options.to_unit.empty())
        return input_error("--from and --to are for mesh files; a robot's mesh is written in its length_unit");
    const auto progress = terminal_progress(options.output);
    Result<robot::Robot> robot = robot::load_robot(options.files.front(), options.assignments);
    if (!robot) return tl::unexpected(robot.error());
    Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, *progress);
    if (!mesh) return tl::unexpected(mesh.error());
    // Files carry the robot's own unit, as the drawing did.
    return mesh::scaled(std::move(*mesh), 1 / robot->unit_m);
}

/// No mesh file carries a unit: to change it, both must be said.
Result<double> scale(const Options& options) {
    if (options.from_unit.empty() && options.to_unit.empty()) return 1.0;
    if (options.from_unit.empty() || options.to_unit.empty())
        return input_error("mesh files carry no unit; give both --from and --to, as in --from m --to mm");
    const Result<double> from = unit_factor(options.from_unit, Dimension::length);
    if (!from) return tl::unexpected(from.error());
    const Result<double> to = unit_factor(options.to_unit, Dimension::length);
    if (!to) return tl::unexpected(to.error());
    return *from / *to;
}

Result<mesh::TetMesh> read(const Options& options) {
    const Result<double> factor = scale(options);
    if (!factor) return tl::unexpected(factor.error());
    Result<mesh::TetMesh> mesh = mesh::read_tet_mesh(options.files.front());
    if (!mesh) return mesh;
    return *factor == 1 ? std::move(*mesh) : mesh::scaled(std::move(*mesh), *factor);
}

void print(const Options& options, const std::string& file, const mesh::MeshReport& report) {
    if (options.output.json)
        fmt::print("{}\n", mesh::report_json(report));
    else if (!options.output.quiet)
        fmt::print("{}: {}\n", file, mesh::report_text(report));
}

Status draw(const Options& options, const std::string& title, const mesh::MeshReport& report) {
    if (options.picture_file.empty()) return {};
    const Result<std::string> png = report::mesh_picture_png(title, report);
    if (!png) return tl::unexpected(png.error());
    return write_file(options.picture_file, *png);
}

/// One file in, one file out.
Status convert(const Options& options) {
    const std::string& file = options.files.front();
    const Result<mesh::TetMesh> mesh = is_robot_file(file) ? build(options) : read(options);
    if (!mesh) return tl::unexpected(mesh.error());
    const auto encoding = options.text ? mesh::Encoding::text : mesh::Encoding::binary;
    if (Status status = mesh::write_tet_mesh(options.output_file, *mesh, encoding); !status) return status;
    const mesh::MeshReport report = mesh::report_on(*mesh);
    print(options, options.output_file, report);
    return draw(options, options.output_file, report);
}

Status describe(const Options& options, const std::string& file) {
    if (options.output.json || !options.picture_file.empty()) {
        const Result<mesh::MeshReport> report = mesh::report_on_file(file);
        if (!report) return tl::unexpected(report.error());
        print(options, file, *report);
        return draw(options, file, *report);
    }
    const Result<std::string> text = mesh::describe_mesh_file(file);
    if (!text) return tl::unexpected(text.error());
    if (!options.output.quiet) fmt::print("{}: {}\n", file, *text);
    return {};
}

Status run(const Options& options) {
    if (options.files.size() > 1 &&
        (!options.output_file.empty() || !options.picture_file.empty() || options.output.json))
        return input_error("-o, --picture and --json need exactly one robot or mesh file");
    if (!options.output_file.empty()) return convert(options);
    for (const std::string& file : options.files) {
        if (is_robot_file(file))
            return input_error("{}: name the mesh to write with -o: FILE{}", file, mesh::tet_writer_list);
        if (Status status = describe(options, file); !status) return status;
    }
    return {};
}

void add_options(CLI::App& command, Options& options) {
    command.add_option("files", options.files, "a robot file with -o, or mesh files (.vtk, .msh, .stl, ...)")
        ->required();
    command.add_option("-o,--output", options.output_file,
                       fmt::format("mesh file to write: {}", mesh::tet_writer_list));
    command.add_option("--picture", options.picture_file, "draw the shapes of the tets: FILE.png");
    command.add_option("--from", options.from_unit, "unit of the mesh file that is read, with --to")->type_name("UNIT");
    command.add_option("--to", options.to_unit, "unit of the mesh file that is written")->type_name("UNIT");
    command.add_flag("--text", options.text, "write .vtk and .msh as text instead of binary");
    command.add_option("--set", options.assignments, "KEY=VALUE: change any key of the robot file")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(command, options.output, true);
}

}  // namespace

void add_mesh(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("mesh", "build the tet mesh of a robot file, convert a mesh file, or report on mesh files");
    add_options(*command, *options);
    command->footer(
        "Example: pliant mesh examples/cable_gripper/gripper.toml -o gripper.vtk\n"
        "         pliant mesh gripper.vtk -o gripper.msh --from mm --to m");
    command->callback([options, &status] {
        const Status result = run(*options);
        status = result ? exit_done : report(result.error());
    });
}

}  // namespace pliant::app
