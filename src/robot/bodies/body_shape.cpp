#include "robot/bodies/body_shape.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/core/boxes.hpp"
#include "geometry/shapes/flat_faces.hpp"
#include "robot/bodies/body_errors.hpp"
#include "robot/bodies/body_surface.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

/// Adds defects and repairs to `notes`.
Result<mesh::TriMesh> read_body_surface(const Robot& robot, const BodySpec& body, const SurfaceFile& file,
                                        std::vector<std::string>& notes) {
    Result<BodyTriangles> surface = read_triangles(file, robot.unit_m);
    if (!surface) return tl::unexpected(at(place(robot, body.line, "body", body.name), surface.error()));
    for (const std::string& note : surface->notes) notes.push_back(fmt::format("body \"{}\": {}", body.name, note));
    return std::move(surface->mesh);
}

}  // namespace

std::vector<mesh::Solid> drawn_air(const Robot& robot) {
    std::vector<mesh::Solid> solids;
    for (const Region& region : regions_of(robot)) {
        if (region.use == Region::Use::body) continue;
        const auto* solid = std::get_if<mesh::Solid>(region.geometry);
        if (solid != nullptr && !std::holds_alternative<mesh::EnclosedSolid>((*solid)->shape)) solids.push_back(*solid);
    }
    return solids;
}

mesh::Solid without_air(const mesh::Solid& body, const std::vector<mesh::Solid>& air) {
    if (air.empty()) return body;
    mesh::CombinedSolid cut{mesh::CombinedSolid::Operation::subtract, {body}};
    cut.parts.insert(cut.parts.end(), air.begin(), air.end());
    return std::make_shared<const mesh::SolidNode>(mesh::SolidNode{std::move(cut)});
}

Result<Shape> body_shape(const Robot& robot, const BodySpec& body, const std::vector<mesh::Solid>& air,
                         std::vector<std::string>& notes) {
    if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) return without_air(*solid, air);
    Result<mesh::TriMesh> surface = read_body_surface(robot, body, std::get<SurfaceFile>(body.geometry), notes);
    if (!surface) return tl::unexpected(surface.error());
    const Box3 box = mesh::bounds(*surface);
    const auto cuts = [&](const mesh::Solid& one) { return boxes_overlap(box, mesh::bounds(one)); };
    const auto fills = [](const CableSpec& cable) { return cable.fill_notches; };
    if (std::any_of(air.begin(), air.end(), cuts) || std::any_of(robot.cables.begin(), robot.cables.end(), fills)) {
        if (Result<mesh::Solid> solid = mesh::polyhedron(*surface)) return without_air(*solid, air);
    }
    return std::move(*surface);
}

}  // namespace pliant::robot
