#include "robot/body_surface.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "core/files.hpp"
#include "core/text.hpp"
#include "mesh/surface_file.hpp"
#include "mesh/surface_shells.hpp"
#include "threemf/read_3mf.hpp"

namespace pliant::robot {
namespace {

void add_once(std::vector<std::string>& names, const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// What a part may be called: materials, then objects.
std::vector<std::string> part_names(const threemf::ThreeMf& file) {
    std::vector<std::string> names;
    for (const threemf::Body& body : file.bodies) add_once(names, body.material);
    for (const threemf::Body& body : file.bodies) add_once(names, body.name);
    return names;
}

Result<BodyTriangles> triangles_of_3mf(const SurfaceFile& file, double unit_m) {
    const Result<threemf::ThreeMf> read = threemf::read_3mf(file.path);
    if (!read) return tl::unexpected(read.error());
    std::vector<std::string> materials;
    for (const threemf::Body& body : read->bodies) add_once(materials, body.material);
    if (file.part.empty() && materials.size() > 1)
        return input_error("{}: has several materials; one [[body]] each, with part = one of {}", file.path.string(),
                           join_names(part_names(*read)));
    mesh::TriMesh surface;
    for (const threemf::Body& body : read->bodies) {
        if (!file.part.empty() && body.material != file.part && body.name != file.part) continue;
        if (!body.slices.empty())
            return input_error("{}: \"{}\" is given in slices, which bound no solid", file.path.string(), body.name);
        mesh::append(surface, body.mesh_mm);
    }
    if (surface.triangles.empty())
        return input_error("{}: has no part \"{}\"; it has {}", file.path.string(), file.part,
                           join_names(part_names(*read)));
    return BodyTriangles{mesh::scaled(std::move(surface), 1e-3 / unit_m), read->warnings};
}

}  // namespace

Result<BodyTriangles> read_triangles(const SurfaceFile& file, double unit_m) {
    const Result<std::string> bytes = read_file(file.path);
    if (!bytes) return tl::unexpected(bytes.error());
    if (threemf::looks_like_zip(*bytes)) {
        Result<BodyTriangles> triangles = triangles_of_3mf(file, unit_m);
        if (triangles) triangles->mesh = mesh::placed(std::move(triangles->mesh), file.placement);
        return triangles;
    }
    Result<mesh::SurfaceFile> surface = mesh::parse_surface(*bytes, file.path.string());
    if (!surface) return tl::unexpected(surface.error());
    return BodyTriangles{mesh::placed(std::move(surface->mesh), file.placement), std::move(surface->warnings)};
}

}  // namespace pliant::robot
