#include "robot/bodies/build.hpp"

#include <algorithm>

#include "base/core/boxes.hpp"
#include "geometry/mesher/mesher.hpp"
#include "robot/bodies/body_errors.hpp"
#include "robot/bodies/body_notes.hpp"
#include "robot/bodies/body_shape.hpp"
#include "robot/bodies/crossed_notches.hpp"
#include "robot/bodies/given_mesh.hpp"
#include "robot/bodies/sized_mesh.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

/// Where drawn bodies overlap, the later one is printed, just as it is the later one that is meshed.
std::vector<mesh::Solid> cut_from(const Robot& robot, std::size_t body, std::vector<mesh::Solid> air) {
    const auto& own = std::get<mesh::Solid>(robot.bodies[body].geometry);
    for (std::size_t b = body + 1; b < robot.bodies.size(); ++b) {
        const auto* later = std::get_if<mesh::Solid>(&robot.bodies[b].geometry);
        if (later != nullptr && boxes_overlap(mesh::bounds(own), mesh::bounds(*later))) air.push_back(*later);
    }
    return air;
}

/// What later bodies take from a drawn one is cut out exactly: all of them are drawn, too, or there is none.
bool loses_to_drawn_only(const Robot& robot, std::size_t body) {
    return std::all_of(robot.bodies.begin() + static_cast<std::ptrdiff_t>(body), robot.bodies.end(),
                       [](const BodySpec& b) { return std::holds_alternative<mesh::Solid>(b.geometry); });
}

/// The surfaces of air whose boxes overlap that of a body.
Result<std::vector<mesh::TriMesh>> air_near(const Box3& body, const std::vector<mesh::Solid>& air, double tolerance,
                                            Progress& progress) {
    std::vector<mesh::TriMesh> surfaces;
    for (const mesh::Solid& solid : air) {
        if (!boxes_overlap(body, mesh::bounds(solid))) continue;
        Result<mesh::TriMesh> surface = mesh::tessellate(solid, tolerance, progress);
        if (!surface) return tl::unexpected(surface.error());
        surfaces.push_back(std::move(*surface));
    }
    return surfaces;
}

Result<mesh::Solid> notches_of(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies,
                               const std::vector<mesh::Solid>& air) {
    std::vector<mesh::Solid> walls;
    for (const mesh::BodyGeometry& body : bodies) {
        if (body.air) continue;
        if (const auto* solid = std::get_if<mesh::Solid>(&body.shape)) {
            walls.push_back(*solid);
            continue;
        }
        return input_error(
            "{}: fill_notches needs shapes, STEP files or closed surfaces of few flat faces, which \"{}\" is not",
            robot.file.string(), body.name);
    }
    return crossed_notches(robot, walls, air);
}

/// The mesher's error names the body, chamber or gap concerned, if any.
Diagnostic place_of(const Robot& robot, const Error& error) {
    for (const Region& region : regions_of(robot)) {
        if (!error.problems.empty() && error.problems.back().key == region.name)
            return place(robot, region.line, "", "");
    }
    return place(robot, 0, "", "");
}

Result<mesh::TetMesh> mesh_drawn_bodies(const Robot& robot, Progress& progress) {
    const std::vector<mesh::Solid> air = drawn_air(robot);
    std::vector<mesh::BodyGeometry> bodies;
    std::vector<std::string> notes;
    for (const BodySpec& body : robot.bodies) {
        Result<Shape> shape = body_shape(robot, body, air, notes);
        if (!shape) return tl::unexpected(shape.error());
        bodies.push_back({body.name, std::move(*shape), false, body.size});
    }
    for (const Region& region : regions_of(robot)) {
        if (region.use == Region::Use::body) continue;
        const auto* drawn = std::get_if<mesh::Solid>(region.geometry);
        Result<mesh::Solid> space = drawn != nullptr ? *drawn : notches_of(robot, bodies, air);
        if (!space) return tl::unexpected(space.error());
        bodies.push_back({std::string(region.name), std::move(*space), true});
    }
    Result<mesh::TetMesh> mesh = sized_mesh(robot, bodies, progress);
    if (!mesh) return tl::unexpected(at(place_of(robot, mesh.error()), mesh.error()));
    const std::vector<std::string> odd = notes_on_shapes(robot, bodies);
    notes.insert(notes.end(), odd.begin(), odd.end());
    mesh->notes.insert(mesh->notes.begin(), notes.begin(), notes.end());
    const std::vector<std::string> apart = notes_on_gaps(robot, *mesh, closed_gaps(robot, bodies));
    mesh->notes.insert(mesh->notes.end(), apart.begin(), apart.end());
    return mesh;
}

}  // namespace

Result<mesh::TetMesh> build_mesh(const Robot& robot, Progress& progress) {
    Result<mesh::TetMesh> mesh = robot.mesh.file ? read_mesh_file(robot) : mesh_drawn_bodies(robot, progress);
    if (!mesh) return mesh;
    const std::vector<std::string> notes = notes_on_surfaces(robot);
    mesh->notes.insert(mesh->notes.end(), notes.begin(), notes.end());
    return mesh::scaled(std::move(*mesh), robot.unit_m);
}

Result<mesh::TetMesh> take_mesh(const Robot& robot, mesh::TetMesh mesh_m) {
    if (!robot.mesh.file)
        return tl::unexpected(
            at(place(robot, robot.mesh.line, "mesh", ""),
               {Cause::input,
                "the bodies are drawn; for a mesh that is given, name regions of it: mesh.file and region"}));
    Result<mesh::TetMesh> mesh =
        give_regions(robot, mesh::placed(mesh::scaled(std::move(mesh_m), 1 / robot.unit_m), robot.mesh.placement));
    return mesh ? mesh::scaled(std::move(*mesh), robot.unit_m) : mesh;
}

Result<std::vector<BodySurface>> body_surfaces(const Robot& robot, Progress& progress) {
    const double tolerance = 10e-6 / robot.unit_m;  // chords may deviate from a curve by a fraction of a pixel
    const std::vector<mesh::Solid> air = drawn_air(robot);
    std::vector<BodySurface> surfaces;
    Result<mesh::TetMesh> regions;
    if (robot.mesh.file) {
        regions = read_mesh_file(robot);
        if (!regions) return tl::unexpected(regions.error());
    }
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
        if (progress.cancelled()) return cancelled();
        progress.advance("surfaces", static_cast<double>(b) / static_cast<double>(robot.bodies.size()));
        const BodySpec& body = robot.bodies[b];
        Result<mesh::TriMesh> surface;
        std::vector<std::string> notes;
        Result<std::vector<mesh::TriMesh>> beside;
        if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) {
            surface = mesh::tessellate(without_air(*solid, cut_from(robot, b, air)), tolerance, progress);
        } else if (std::holds_alternative<SurfaceFile>(body.geometry)) {
            const Result<Shape> shape = body_shape(robot, body, air, notes);
            if (!shape) return tl::unexpected(shape.error());
            if (const auto* cut = std::get_if<mesh::Solid>(&*shape)) {
                surface = mesh::tessellate(*cut, tolerance, progress);
            } else {
                surface = std::get<mesh::TriMesh>(*shape);
                beside = air_near(mesh::bounds(*surface), air, tolerance, progress);
            }
        } else {
            surface = mesh::region_surface(*regions, static_cast<int>(b));
        }
        if (!(surface && beside) && progress.cancelled()) return cancelled();
        if (!beside) return tl::unexpected(at(place(robot, body.line, "body", body.name), beside.error()));
        if (!surface) return tl::unexpected(at(place(robot, body.line, "body", body.name), surface.error()));
        surfaces.push_back({body.name, body.material, mesh::scaled(std::move(*surface), robot.unit_m), std::move(notes),
                            loses_to_drawn_only(robot, b) ? tolerance * robot.unit_m : 0});
        for (mesh::TriMesh& space : *beside)
            surfaces.back().air_m.push_back(mesh::scaled(std::move(space), robot.unit_m));
    }
    return surfaces;
}

}  // namespace pliant::robot
