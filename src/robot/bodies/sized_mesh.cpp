#include "robot/bodies/sized_mesh.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "geometry/mesh/triangle_corners.hpp"
#include "robot/bodies/mesh_budget.hpp"

namespace pliant::robot {
namespace {

/// The file says how long edges are everywhere.
bool has_size(const Robot& robot) {
    return robot.mesh.size > 0 || std::ranges::all_of(robot.bodies, [](const BodySpec& body) { return body.size > 0; });
}

/// The size of what has none of its own.
double general_size(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies) {
    if (robot.mesh.size > 0) return robot.mesh.size;
    if (!has_size(robot)) return mesh::longest_side(bodies) / 24;
    return std::ranges::max(robot.bodies, {}, &BodySpec::size).size;
}

/// The mesher takes the size of its settings as the largest: where a body has a larger size than `general`, the others
/// get that as their own.
Result<mesh::TetMesh> mesh_with_sizes(std::vector<mesh::BodyGeometry> bodies, double general,
                                      mesh::MeshSettings settings, Progress& progress) {
    settings.size = general;
    for (const mesh::BodyGeometry& body : bodies) settings.size = std::max(settings.size, body.size);
    if (settings.size > general) {
        for (mesh::BodyGeometry& body : bodies) body.size = body.size > 0 ? body.size : general;
    }
    return mesh::mesh_bodies(bodies, settings, progress);
}

/// A size in the file is used as given; without one, walls get three elements.
mesh::MeshSettings mesh_settings(const Robot& robot, double size) {
    mesh::MeshSettings settings;
    settings.size = size;
    settings.order = robot.mesh.order;
    settings.through_wall = robot.mesh.elements_through_wall.value_or(has_size(robot) ? 0 : 3);
    settings.judge_walls = !robot.mesh.elements_through_wall;
    settings.close_gaps = robot.mesh.close_gaps.value_or(1e-3 * settings.size);
    settings.size_near_cables = robot.mesh.size_near_cables;
    for (const CableSpec& cable : robot.cables) settings.cables.push_back(cable.points);
    return settings;
}

/// With more nodes a step takes longer than seconds.
constexpr std::size_t most_automatic_nodes = 20000;

/// What the bodies measure; less of them where one cannot be measured, which is told when it is meshed.
std::vector<Bulk> measured(const std::vector<mesh::BodyGeometry>& bodies, double size, Progress& progress) {
    constexpr double chords = 0.05;  // of the size: exact enough to count elements
    std::vector<Bulk> found;
    for (const mesh::BodyGeometry& body : bodies) {
        if (const auto* surface = std::get_if<mesh::TriMesh>(&body.shape)) {
            found.push_back({std::fabs(mesh::signed_volume(*surface)), mesh::surface_area(*surface)});
        } else if (!body.air) {
            const auto drawn = mesh::tessellate(std::get<mesh::Solid>(body.shape), chords * size, progress);
            if (drawn) found.push_back({std::fabs(mesh::signed_volume(*drawn)), mesh::surface_area(*drawn)});
        }
    }
    return found;
}

/// A rough number, without digits that nobody knows.
std::string about(double count) {
    const double step = std::pow(10, std::floor(std::log10(std::max(count, 1.0))) - 1);
    return fmt::format("about {:.0f}", std::round(count / step) * step);
}

std::string coarser_note(std::size_t nodes, const std::string& usual, double size, int through_wall) {
    const bool few = nodes <= most_automatic_nodes;
    return fmt::format(
        "no mesh.size is given: {} nodes in place of {} with 3 elements through every wall, {}; for a {} mesh set "
        "mesh.size (here {:.3g}) or mesh.elements_through_wall (here {})",
        nodes, usual,
        few ? "so that a step takes seconds"
            : fmt::format("still more than the {} with which a step takes seconds", most_automatic_nodes),
        few ? "finer" : "coarser", size, through_wall);
}

mesh::MeshSettings settings_of(const Robot& robot, const Fineness& fineness) {
    mesh::MeshSettings settings = mesh_settings(robot, fineness.size);
    settings.through_wall = fineness.through_wall;
    return settings;
}

/// The next try after a mesh with too many nodes: the walls' elements first, then edges.
Fineness coarser(Fineness fineness, std::size_t nodes) {
    constexpr double most_coarser = 1.6;  // per attempt: notches and walls should still be meshed well
    const double excess = static_cast<double>(nodes) / static_cast<double>(most_automatic_nodes);
    if (fineness.through_wall > 1)
        --fineness.through_wall;
    else
        fineness.size *= std::clamp(std::cbrt(excess), 1.1, most_coarser);
    return fineness;
}

/// The same where the number was foreseen: by as much as it was wrong.
Fineness corrected(std::span<const Bulk> bulk, const Fineness& fineness, std::size_t nodes) {
    constexpr double margin = 0.9;
    const double wrong = static_cast<double>(nodes) / expected_nodes(bulk, fineness);
    return coarsened(bulk, fineness, margin * static_cast<double>(most_automatic_nodes) / wrong);
}

}  // namespace

double closed_gaps(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies) {
    return mesh_settings(robot, general_size(robot, bodies)).close_gaps;
}

Result<mesh::TetMesh> sized_mesh(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies,
                                 Progress& progress) {
    const double size = general_size(robot, bodies);
    const mesh::MeshSettings settings = mesh_settings(robot, size);
    const bool asked = has_size(robot) || robot.mesh.elements_through_wall || robot.mesh.size_near_cables > 0;
    if (asked) return mesh_with_sizes(bodies, size, settings, progress);
    const std::vector<Bulk> bulk = measured(bodies, size, progress);
    const Fineness usual{size, settings.through_wall, settings.order};
    Fineness taken = within_budget(bulk, usual, most_automatic_nodes);
    const bool foreseen = taken.size > usual.size || taken.through_wall < usual.through_wall;
    Result<mesh::TetMesh> mesh = mesh_with_sizes(bodies, taken.size, settings_of(robot, taken), progress);
    if (!mesh || (!foreseen && mesh->points.size() <= most_automatic_nodes)) return mesh;
    const std::string instead = foreseen ? about(expected_nodes(bulk, usual)) : std::to_string(mesh->points.size());
    const int tries = foreseen ? 1 : 3;
    for (int i = 0; i < tries && mesh && mesh->points.size() > most_automatic_nodes; ++i) {
        const std::size_t nodes = mesh->points.size();
        taken = foreseen ? corrected(bulk, taken, nodes) : coarser(taken, nodes);
        mesh = mesh_with_sizes(bodies, taken.size, settings_of(robot, taken), progress);
    }
    if (mesh) mesh->notes.push_back(coarser_note(mesh->points.size(), instead, taken.size, taken.through_wall));
    return mesh;
}

}  // namespace pliant::robot
