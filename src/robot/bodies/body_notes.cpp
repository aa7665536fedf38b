#include "robot/bodies/body_notes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "base/core/boxes.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/repair/narrow_gaps.hpp"
#include "geometry/repair/surface_seams.hpp"
#include "geometry/shapes/overlap_note.hpp"
#include "robot/bodies/body_shape.hpp"

namespace pliant::robot {
namespace {

/// The common volume of two drawn bodies; 0 where it cannot be measured: what cannot be built is an error of the bodies
/// themselves.
double overlap_of(const mesh::Solid& one, const mesh::Solid& other) {
    const mesh::CombinedSolid both{mesh::CombinedSolid::Operation::intersect, {one, other}};
    return mesh::solid_volume(std::make_shared<const mesh::SolidNode>(mesh::SolidNode{both})).value_or(0);
}

/// Less of it is a rounding error of bodies that touch.
double least_overlap(const mesh::Solid& one, const mesh::Solid& other) {
    const auto volume = [](const Box3& box) { return box.size().x * box.size().y * box.size().z; };
    return 1e-9 * std::min(volume(mesh::bounds(one)), volume(mesh::bounds(other)));
}

/// What is cut from a shape, but lies beside it.
bool cuts_nothing(const mesh::Solid& solid) {
    const auto* combined = std::get_if<mesh::CombinedSolid>(&solid->shape);
    if (combined == nullptr) return false;
    if (std::ranges::any_of(combined->parts, cuts_nothing)) return true;
    if (combined->operation != mesh::CombinedSolid::Operation::subtract) return false;
    const Box3 whole = mesh::bounds(combined->parts.front());
    return std::any_of(combined->parts.begin() + 1, combined->parts.end(),
                       [&](const mesh::Solid& part) { return !boxes_meet(whole, mesh::bounds(part)); });
}

/// A surface file that the model reads, and who names it.
struct NamedFile {
    std::string_view kind;
    const std::string& name;
    const std::filesystem::path& path;
    bool obstacle = false;
};

std::vector<NamedFile> files_of_model(const Robot& robot) {
    std::vector<NamedFile> files;
    const auto add_selector = [&](std::string_view kind, const std::string& name, const Selector& selector) {
        if (const auto* on = std::get_if<SurfaceSelector>(&selector)) files.push_back({kind, name, on->path});
    };
    for (const FixedSpec& fixed : robot.fixed) add_selector("fixed", fixed.name, fixed.selector);
    for (const PlateSpec& plate : robot.plates) add_selector("plate", plate.name, plate.selector);
    for (const LoadSpec& load : robot.loads) {
        if (const auto* faces = std::get_if<Selector>(&load.place)) add_selector("load", load.name, *faces);
        if (const auto* nodes = std::get_if<LoadOnNodes>(&load.place)) add_selector("load", load.name, nodes->selector);
    }
    for (const SensorSpec& sensor : robot.sensors) {
        if (const auto* patch = std::get_if<ContactSensorSpec>(&sensor.what))
            add_selector("sensor", sensor.name, patch->selector);
    }
    for (const ObstacleSpec& obstacle : robot.obstacles) {
        if (const auto* file = std::get_if<SurfaceFile>(&obstacle.shape))
            files.push_back({"obstacle", obstacle.name, file->path, true});
    }
    for (const ObjectSpec& object : robot.objects) {
        if (const auto* file = std::get_if<SurfaceFile>(&object.shape))
            files.push_back({"object", object.name, file->path});
    }
    for (const ChamberSpec& chamber : robot.chambers) {
        if (const auto* file = std::get_if<SurfaceFile>(&chamber.air))
            files.push_back({"chamber", chamber.name, file->path});
    }
    return files;
}

}  // namespace

std::vector<std::string> notes_on_surfaces(const Robot& robot) {
    std::vector<std::string> notes;
    for (const NamedFile& file : files_of_model(robot)) {
        const Result<mesh::SurfaceFile> surface = mesh::read_surface(file.path);
        if (!surface) continue;
        for (const std::string& note : surface->warnings)
            notes.push_back(fmt::format("{} \"{}\": {}", file.kind, file.name, note));
        const std::size_t open = file.obstacle ? mesh::border_edges(surface->mesh).size() : 0;
        if (open > 0)
            notes.push_back(
                fmt::format("obstacle \"{}\": its surface is not closed: {} edges have no neighbour; it is "
                            "no solid but a thin sheet, which is touched from both sides",
                            file.name, open));
    }
    return notes;
}

std::vector<std::string> notes_on_shapes(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies) {
    constexpr double too_coarse = 2;  // sizes of the robot
    std::vector<std::string> notes;
    for (const BodySpec& body : robot.bodies) {
        const auto* solid = std::get_if<mesh::Solid>(&body.geometry);
        if (solid != nullptr && cuts_nothing(*solid))
            notes.push_back(fmt::format(
                "body \"{}\": a shape of a difference lies outside of what it is cut from: it cuts nothing away",
                body.name));
    }
    const double longest = mesh::longest_side(bodies);
    if (robot.mesh.size > too_coarse * longest)
        notes.push_back(
            fmt::format("mesh.size, {:.3g}, is {:.3g} times as long as the robot, {:.3g}: it has no effect but that "
                        "its shape is meshed as coarsely as it can be",
                        robot.mesh.size, robot.mesh.size / longest, longest));
    return notes;
}

std::vector<std::string> notes_on_gaps(const Robot& robot, const mesh::TetMesh& mesh, double closed) {
    constexpr double hardly_seen_m = 20e-6;  // half a usual pixel
    const double tolerance = hardly_seen_m / robot.unit_m;
    if (robot.mesh.close_gaps || closed >= tolerance) return {};
    std::vector<std::string> notes;
    for (const mesh::NarrowGap& gap : mesh::narrow_gaps(mesh, tolerance)) {
        const auto first = static_cast<std::size_t>(gap.first), second = static_cast<std::size_t>(gap.second);
        if (second >= robot.bodies.size() || gap.width <= closed) continue;
        notes.push_back(
            fmt::format("body \"{}\" and \"{}\" are {:.3g} apart at ({:.4g}, {:.4g}, {:.4g}), less than a printer "
                        "shows: they are not joined in the simulation; a larger mesh.close_gaps joins them",
                        robot.bodies[first].name, robot.bodies[second].name, gap.width, gap.at.x, gap.at.y, gap.at.z));
    }
    return notes;
}

std::vector<std::string> overlap_notes(const Robot& robot, const Progress& progress) {
    std::vector<std::string> notes;
    const std::vector<mesh::Solid> air = drawn_air(robot);
    for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
        const auto* own = std::get_if<mesh::Solid>(&robot.bodies[a].geometry);
        for (std::size_t b = a + 1; own != nullptr && b < robot.bodies.size() && !progress.cancelled(); ++b) {
            const auto* later = std::get_if<mesh::Solid>(&robot.bodies[b].geometry);
            if (later == nullptr || !boxes_overlap(mesh::bounds(*own), mesh::bounds(*later))) continue;
            const double volume = overlap_of(without_air(*own, air), without_air(*later, air));
            if (volume <= least_overlap(*own, *later)) continue;
            notes.push_back(mesh::overlap_note(robot.bodies[a].name, robot.bodies[b].name, volume));
        }
    }
    return notes;
}

}  // namespace pliant::robot
