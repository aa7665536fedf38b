#include "presentation/report/workspace_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/core/files.hpp"
#include "geometry/files/surface_file.hpp"
#include "presentation/report/pictures.hpp"
#include "presentation/report/units.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::report {
namespace {

namespace fs = std::filesystem;

/// The rows and columns of all sheets, as lines.
std::vector<MeasuredPath> lines_of(const WorkspaceReport& report, std::size_t marker) {
    std::vector<MeasuredPath> lines;
    for (const sim::inverse::WorkspacePiece& piece : report.workspace.pieces) {
        const auto add = [&](int count, const auto& index) {
            bool goes_on = false;  // no line leads over what has no equilibrium
            for (int k = 0; k < count; ++k) {
                const auto& sample = piece.samples[static_cast<std::size_t>(index(k))];
                if (sample.found && !goes_on) lines.push_back({report.model.description().markers[marker].name, {}});
                if (sample.found) lines.back().points.push_back(sample.markers[marker]);
                goes_on = sample.found;
            }
        };
        for (int row = 0; row < piece.rows; ++row) add(piece.columns, [&](int k) { return row * piece.columns + k; });
        for (int column = 0; piece.rows > 1 && column < piece.columns; ++column)
            add(piece.rows, [&](int k) { return k * piece.columns + column; });
    }
    return lines;
}

/// The robot at rest, with the workspace of its first marker.
Result<std::string> picture(const robot::Robot& robot, const WorkspaceReport& report, Progress& progress) {
    const sim::Stepper stepper(report.model, sim::stepper_options(robot.program));
    const sim::RobotState rest = stepper.rest();
    sim::Trajectory trajectory;
    sim::Step step;
    sim::describe(report.model, stepper.system(), rest.now.state, rest.controls, rest.evaluation, step);
    trajectory.steps = {step};
    Simulation simulation = simulation_of(robot, report.model, trajectory);
    simulation.measured = lines_of(report, 0);
    simulation.measured_as = "within reach";
    const Surface outer = outer_surface(simulation.mesh, simulation.region_material);
    const auto pictures = draw_pictures(simulation, outer, {}, progress);
    if (!pictures) return tl::unexpected(pictures.error());
    return pictures->front().png;
}

/// (markers) file names without their ending: the names of the markers where these can be, else with underscores, and
/// a number where another marker has that name.
std::vector<std::string> names_of_files(const std::vector<sim::Marker>& markers) {
    std::vector<std::string> names;
    for (const sim::Marker& marker : markers) {
        names.push_back(marker.name);
        for (char& c : names.back()) {
            if (c == '/' || c == '\\' || c == '\0') c = '_';
        }
    }
    for (std::size_t m = 0; m < names.size(); ++m) {
        if (names[m] == markers[m].name) continue;
        const std::string plain = names[m];
        const auto taken = [&] { return std::ranges::count(names, names[m]) > 1; };
        for (int number = 2; taken(); ++number) names[m] = fmt::format("{}_{}", plain, number);
    }
    return names;
}

Status write_marker(const WorkspaceReport& report, std::size_t marker, const std::string& name,
                    const fs::path& folder) {
    const mesh::TriMesh surface = workspace_surface(report.workspace, marker);
    if (!surface.triangles.empty()) {
        Status written = mesh::write_stl(folder / (name + ".stl"), mesh::scaled(surface, mm_per_m));
        if (!written) return written;
    }
    if (surface.points.empty()) return {};
    return write_file(folder / (name + ".vtk"), workspace_vtk(report, marker));
}

}  // namespace

Status write_workspace(const fs::path& folder, const robot::Robot& robot, const WorkspaceReport& report,
                       Progress& progress) {
    return write_folder(folder, "workspace.json", [&](const fs::path& aside) -> Status {
        Status status = write_file(aside / "workspace.csv", workspace_csv(report));
        const std::vector<std::string> names = names_of_files(report.model.description().markers);
        for (std::size_t m = 0; status && m < names.size(); ++m) status = write_marker(report, m, names[m], aside);
        if (!status) return status;
        if (!report.model.description().markers.empty() && !lines_of(report, 0).empty()) {
            const Result<std::string> png = picture(robot, report, progress);
            if (!png) return tl::unexpected(png.error());
            if (status = write_file(aside / "workspace.png", *png); !status) return status;
        }
        return write_file(aside / "workspace.json", workspace_json(report));
    });
}

}  // namespace pliant::report
