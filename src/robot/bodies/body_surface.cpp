#include "robot/bodies/body_surface.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "base/core/text.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/open/open_geometry.hpp"

namespace pliant::robot {
namespace {

void add_once(std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// Possible names of a part: materials, then objects.
std::vector<std::string> part_names(const threemf::ThreeMf& file) {
    std::vector<std::string> names;
    for (const threemf::Body& body : file.bodies) add_once(names, body.material);
    for (const threemf::Body& body : file.bodies) add_once(names, body.name);
    return names;
}

Result<BodyTriangles> triangles_of_3mf(const threemf::ThreeMf& plate, const SurfaceFile& file, double unit_m) {
    std::vector<std::string> materials;
    for (const threemf::Body& body : plate.bodies) add_once(materials, body.material);
    if (file.part.empty() && materials.size() > 1)
        return input_error("{}: has several materials; one [[body]] each, with part = one of {}", file.path.string(),
                           join_names(part_names(plate)));
    mesh::TriMesh surface;
    for (const threemf::Body& body : plate.bodies) {
        if (!file.part.empty() && body.material != file.part && body.name != file.part) continue;
        if (!body.slices.empty())
            return input_error("{}: \"{}\" is given in slices, which bound no solid", file.path.string(), body.name);
        mesh::append(surface, body.mesh_mm);
    }
    if (surface.triangles.empty())
        return input_error("{}: has no part \"{}\"; it has {}", file.path.string(), file.part,
                           join_names(part_names(plate)));
    return BodyTriangles{mesh::scaled(std::move(surface), 1e-3 / unit_m), plate.warnings};
}

}  // namespace

Result<BodyTriangles> read_triangles(const SurfaceFile& file, double unit_m) {
    Result<mesh::Geometry> geometry = mesh::open_geometry(file.path);
    if (!geometry) return tl::unexpected(geometry.error());
    if (const auto* plate = std::get_if<threemf::ThreeMf>(&*geometry)) {
        Result<BodyTriangles> triangles = triangles_of_3mf(*plate, file, unit_m);
        if (triangles) triangles->mesh = mesh::placed(std::move(triangles->mesh), file.placement);
        return triangles;
    }
    auto* surface = std::get_if<mesh::SurfaceFile>(&*geometry);
    if (surface == nullptr)
        return input_error("{}: is {}; a surface is needed here: STL, OBJ, PLY, OFF or 3MF", file.path.string(),
                           std::holds_alternative<mesh::TetMesh>(*geometry) ? "a tet mesh, which [mesh] takes as file"
                                                                            : "a STEP file");
    return BodyTriangles{mesh::placed(std::move(surface->mesh), file.placement), std::move(surface->warnings)};
}

}  // namespace pliant::robot
