// pliant mesh: builds the tet mesh of a robot file, converts one mesh file to another, or reports on mesh files.
#include <fmt/core.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/units.hpp"
#include "command.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/open/describe_file.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "output_option.hpp"
#include "presentation/report/mesh_picture.hpp"
#include "printed.hpp"
#include "robot/bodies/build.hpp"
#include "simulation/peers/calculix_deck.hpp"
#include "simulation/scene/build_model.hpp"

namespace pliant::app {
namespace {

struct MeshOptions {
    std::vector<std::string> files;
    std::string output_file;
    std::string picture_file;
    std::string from_unit;
    std::string to_unit;
    std::vector<std::string> assignments;
    bool text = false;
    Output output;
};

mesh::Encoding encoding(const MeshOptions& options) {
    return options.text ? mesh::Encoding::text : mesh::Encoding::binary;
}

bool is_robot_file(const std::string& file) {
    return lower_extension(file) == ".toml";
}

Result<robot::Robot> load(const MeshOptions& options) {
    if (!options.from_unit.empty() || !options.to_unit.empty())
        return input_error("--from and --to are for mesh files; a robot's mesh is written in its length_unit");
    return read_robot(options.files.front(), options.assignments);
}

/// What was written, and its unit.
struct WrittenMesh {
    mesh::TetMesh mesh;
    double unit_mm = 1;
};

/// A robot is more than its mesh: as .inp it is written as a deck that CalculiX can run, in mm and without the air of
/// chambers.
Result<WrittenMesh> write_robot(const MeshOptions& options, const robot::Robot& robot, const mesh::TetMesh& mesh_m) {
    constexpr double mm_per_m = 1e3;
    if (lower_extension(options.output_file) != ".inp") {
        // Files use the robot's own length unit, as the drawing did.
        WrittenMesh written{mesh::scaled(mesh_m, 1 / robot.unit_m), mm_per_m * robot.unit_m};
        const Status status = mesh::write_tet_mesh(options.output_file, written.mesh, encoding(options));
        return status ? Result<WrittenMesh>(std::move(written)) : tl::unexpected(status.error());
    }
    const Result<sim::Model> model = robot::build_model(robot, mesh_m);
    if (!model) return tl::unexpected(model.error());
    const Result<std::string> deck = sim::calculix::deck(model->description(), robot.program.duration);
    if (!deck) return input_error("{}: {}", options.files.front(), deck.error().message);
    if (Status status = write_file(options.output_file, *deck); !status) return tl::unexpected(status.error());
    WrittenMesh written{mesh::scaled(model->mesh(), mm_per_m)};
    written.mesh.notes = mesh_m.notes;
    return written;
}

/// Mesh files have no unit: to convert, both units must be given.
Result<double> scale(const MeshOptions& options) {
    if (options.from_unit.empty() && options.to_unit.empty()) return 1.0;
    if (options.from_unit.empty() || options.to_unit.empty())
        return input_error("mesh files carry no unit; give both --from and --to, as in --from m --to mm");
    const Result<double> from = unit_factor(options.from_unit, Dimension::length);
    if (!from) return tl::unexpected(from.error());
    const Result<double> to = unit_factor(options.to_unit, Dimension::length);
    if (!to) return tl::unexpected(to.error());
    return *from / *to;
}

Result<mesh::TetMesh> read(const MeshOptions& options) {
    const Result<double> factor = scale(options);
    if (!factor) return tl::unexpected(factor.error());
    Result<mesh::TetMesh> mesh = mesh::read_tet_mesh(options.files.front());
    if (!mesh) return mesh;
    return *factor == 1 ? std::move(*mesh) : mesh::scaled(std::move(*mesh), *factor);
}

/// Of the mesh that is reported on; empty for a mesh file without --to.
std::optional<double> written_unit_mm(const MeshOptions& options) {
    const Result<double> to = unit_factor(options.to_unit, Dimension::length);
    return to ? std::optional(1e3 * *to) : std::nullopt;
}

void print_report(const MeshOptions& options, const std::string& file, const mesh::MeshReport& report,
                  std::optional<double> unit_mm) {
    if (options.output.json)
        fmt::print("{}\n", mesh::report_json(report, unit_mm));
    else if (!options.output.quiet)
        fmt::print("{}: {}\n", file, mesh::report_text(report));
}

Status draw(const MeshOptions& options, const std::string& title, const mesh::MeshReport& report) {
    if (options.picture_file.empty()) return {};
    const Result<std::string> png = report::mesh_picture_png(title, report);
    if (!png) return tl::unexpected(png.error());
    return write_file(options.picture_file, *png);
}

Status tell_mesh(const MeshOptions& options, const mesh::TetMesh& mesh, std::optional<double> unit_mm) {
    const mesh::MeshReport report = mesh::report_on(mesh);
    print_report(options, options.output_file, report, unit_mm);
    return draw(options, options.output_file, report);
}

Status build(const MeshOptions& options) {
    auto progress = terminal_progress(options.output);
    on_signal(OnSignal::leave);  // no output is written while meshing
    const Result<robot::Robot> robot = load(options);
    if (!robot) return tl::unexpected(robot.error());
    const Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, *progress);
    if (!mesh) return tl::unexpected(mesh.error());
    on_signal(OnSignal::ask_twice);
    Result<WrittenMesh> written = write_robot(options, *robot, *mesh);
    if (!written) return tl::unexpected(written.error());
    progress.reset();
    if (const auto model = robot::build_model(*robot, *mesh); !model)
        written->mesh.notes.push_back("no simulation accepts this robot: " + one_line(model.error().message));
    return tell_mesh(options, written->mesh, written->unit_mm);
}

Status convert(const MeshOptions& options) {
    const Result<mesh::TetMesh> mesh = read(options);
    if (!mesh) return tl::unexpected(mesh.error());
    if (Status status = mesh::write_tet_mesh(options.output_file, *mesh, encoding(options)); !status) return status;
    return tell_mesh(options, *mesh, written_unit_mm(options));
}

Status describe(const MeshOptions& options, const std::string& file) {
    const Result<double> factor = scale(options);
    if (!factor) return tl::unexpected(factor.error());
    if (options.output.json || !options.picture_file.empty()) {
        const Result<mesh::MeshReport> report = mesh::report_on_file(file, *factor);
        if (!report) return tl::unexpected(report.error());
        print_report(options, file, *report, written_unit_mm(options));
        return draw(options, file, *report);
    }
    const Result<std::string> text = mesh::describe_mesh_file(file, *factor);
    if (!text) return tl::unexpected(text.error());
    if (!options.output.quiet) fmt::print("{}: {}\n", file, *text);
    return {};
}

Status mesh_file(const MeshOptions& options) {
    if (options.files.size() > 1 &&
        (!options.output_file.empty() || !options.picture_file.empty() || options.output.json))
        return input_error("-o, --picture and --json need exactly one robot or mesh file");
    if (Status ending = check_ending("--picture", options.picture_file, "a picture", ".png"); !ending) return ending;
    std::error_code ignored;
    if (!options.picture_file.empty() &&
        std::filesystem::equivalent(options.picture_file, options.files.front(), ignored))
        return input_error("--picture {}: is the file that is read", options.picture_file);
    if (Status places = check_file_places({options.output_file, options.picture_file}); !places) return places;
    for (const std::string& file : options.files)
        if (!options.assignments.empty() && !is_robot_file(file)) return no_assignments(file);
    if (!options.output_file.empty()) {
        if (Status known = mesh::check_tet_ending(options.output_file, encoding(options)); !known) return known;
        return is_robot_file(options.files.front()) ? build(options) : convert(options);
    }
    if (options.text) return input_error("--text is the encoding of a mesh that is written; name it with -o");
    for (const std::string& file : options.files) {
        if (is_robot_file(file))
            return input_error("{}: name the mesh to write with -o: FILE{}", file, mesh::tet_writer_list);
        if (Status status = describe(options, file); !status) return status;
    }
    return {};
}

void add_options(CLI::App& command, MeshOptions& options) {
    command.add_option("files", options.files, "a robot file with -o, or mesh files (.vtk, .msh, .stl, .off, ...)")
        ->required();
    add_output_path(command, options.output_file, fmt::format("mesh file to write: {}", mesh::tet_writer_list));
    command.add_option("--picture", options.picture_file, "picture of the quality of the tets: FILE.png");
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
    auto options = std::make_shared<MeshOptions>();
    CLI::App* command =
        app.add_subcommand("mesh", "build the tet mesh of a robot file, convert a mesh file, or report on mesh files");
    add_options(*command, *options);
    command->footer(
        "Example: pliant mesh examples/cable_gripper/gripper.toml -o gripper.vtk\n"
        "         pliant mesh gripper.vtk -o gripper.msh --from mm --to m");
    on_call(*command, status, [options] { return mesh_file(*options); });
}

}  // namespace pliant::app
