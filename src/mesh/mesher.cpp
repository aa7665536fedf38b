#include "mesh/mesher.hpp"

#include <algorithm>
#include <vector>

#include "mesh/gmsh_kernel.hpp"
#include "mesh/surface_check.hpp"
#include "mesh/surface_shells.hpp"
#include "mesh/surface_slivers.hpp"
#include "mesh/tet_locator.hpp"
#include "mesh/winding_mesher.hpp"

namespace pliant::mesh {
namespace {

/// What is meshed in one go: all solids together, or one piece of a surface.
struct Part {
    TetMesh mesh;            ///< regions are bodies
    bool from_file = false;  ///< not joined to what it touches
};

/// True if a node of `one` lies in `other` or within `margin` of it; then `body` is the region there.
bool reaches_into(const TetMesh& one, const TetMesh& other, double margin, int& body) {
    const TetLocator locator(other);
    Box3 box;
    for (const Vec3& p : other.points) box.add(p);
    for (const Vec3& p : one.points) {
        if (!box.contains(p, margin)) continue;
        const auto found = locator.locate(p);
        if (found.distance > margin) continue;
        body = other.region[static_cast<std::size_t>(found.tet)];
        return true;
    }
    return false;
}

/// Surface files are not joined to their neighbours: a mesh where they touch would fall apart unnoticed.
Status check_apart(const Part& fresh, const Part& before, std::span<const BodyGeometry> bodies, double margin) {
    const int own = fresh.mesh.region.front();
    int other = own;
    if (!reaches_into(fresh.mesh, before.mesh, margin, other)) {
        if (!reaches_into(before.mesh, fresh.mesh, margin, other)) return {};
        other = before.mesh.region.front();
    }
    const std::string& name = bodies[static_cast<std::size_t>(own)].name;
    if (other == own) return input_error("body \"{}\": two shells of its surface touch or overlap", name);
    return input_error(
        "body \"{}\" touches or overlaps body \"{}\"; bodies from surface files must stand apart (shapes written in "
        "the robot file may touch)",
        name, bodies[static_cast<std::size_t>(other)].name);
}

Result<Part> mesh_drawn_solids(std::span<const BodyGeometry> bodies, const MeshSettings& settings) {
    std::vector<kernel::NamedSolid> solids;
    std::vector<int> body_of_solid;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto* solid = std::get_if<Solid>(&bodies[b].shape);
        if (solid == nullptr) continue;
        solids.push_back({bodies[b].name, *solid});
        body_of_solid.push_back(static_cast<int>(b));
    }
    if (solids.empty()) return Part{};
    Result<TetMesh> mesh = kernel::mesh_solids(solids, settings.size, settings.order);
    if (!mesh) return tl::unexpected(mesh.error());
    for (int& region : mesh->region) region = body_of_solid[static_cast<std::size_t>(region)];
    return Part{std::move(*mesh), false};
}

double surface_area(const TriMesh& surface) {
    double sum = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const Vec3& p = surface.points[static_cast<std::size_t>(a)];
        sum += norm(cross(surface.points[static_cast<std::size_t>(b)] - p,
                          surface.points[static_cast<std::size_t>(c)] - p)) /
               2;
    }
    return sum;
}

/// A body whose surface is closed and simple: one mesh per solid piece.
Result<std::vector<TetMesh>> mesh_pieces(const TriMesh& surface, const MeshSettings& settings) {
    if (Status status = check_closed(surface); !status) return tl::unexpected(status.error());
    const Result<std::vector<TriMesh>> pieces = solid_pieces(surface);
    if (!pieces) return tl::unexpected(pieces.error());
    std::vector<TetMesh> meshes;
    for (const TriMesh& piece : *pieces) {
        Result<TetMesh> mesh = kernel::mesh_surface(piece, settings.size, settings.angle_deg);
        if (!mesh) return tl::unexpected(mesh.error());
        int region = 0;
        for (const TetMesh& before : meshes) {
            if (reaches_into(*mesh, before, 0.01 * settings.size, region) ||
                reaches_into(before, *mesh, 0.01 * settings.size, region))
                return input_error("two shells of its surface touch or overlap");
        }
        meshes.push_back(std::move(*mesh));
    }
    return meshes;
}

/// The meshes of the surface of body `b`. One that is damaged is meshed from its winding number, as it was read.
Result<std::vector<Part>> mesh_surface_body(std::span<const BodyGeometry> bodies, std::size_t b,
                                            const MeshSettings& settings) {
    const auto& drawn = std::get<TriMesh>(bodies[b].shape);
    TriMesh surface = drawn;
    const SliverCount slivers = remove_slivers(surface);
    const auto blame = [&](const Error& error) {
        return tl::unexpected(Error{error.cause, fmt::format("body \"{}\": {}", bodies[b].name, error.message)});
    };
    Status few = kernel::check_tet_count(std::fabs(signed_volume(surface)), surface_area(surface), settings.size);
    if (!few) return blame(few.error());
    Result<std::vector<TetMesh>> meshes = mesh_pieces(surface, settings);
    if (!meshes) {
        Result<TetMesh> mesh = mesh_by_winding(drawn, settings.size, settings.angle_deg);
        if (!mesh) return blame({mesh.error().cause, mesh.error().message + "; " + meshes.error().message});
        meshes = std::vector<TetMesh>{std::move(*mesh)};
    } else if (slivers.removed > 0) {
        meshes->front().notes.insert(meshes->front().notes.begin(),
                                     fmt::format("{} flat triangle(s) of the surface were removed", slivers.removed));
    }
    std::vector<Part> parts;
    for (TetMesh& mesh : *meshes) {
        mesh.region.assign(mesh.region.size(), static_cast<int>(b));
        for (std::string& note : mesh.notes) note = fmt::format("body \"{}\": {}", bodies[b].name, note);
        parts.push_back({settings.order == 2 ? to_quadratic(mesh) : std::move(mesh), true});
    }
    return parts;
}

TetMesh joined(const std::vector<Part>& parts, int order) {
    TetMesh mesh;
    mesh.order = order;
    for (const Part& part : parts) {
        const int offset = static_cast<int>(mesh.points.size());
        mesh.points.insert(mesh.points.end(), part.mesh.points.begin(), part.mesh.points.end());
        for (const int node : part.mesh.nodes) mesh.nodes.push_back(node + offset);
        mesh.region.insert(mesh.region.end(), part.mesh.region.begin(), part.mesh.region.end());
        mesh.notes.insert(mesh.notes.end(), part.mesh.notes.begin(), part.mesh.notes.end());
    }
    return mesh;
}

Status check_settings(std::span<const BodyGeometry> bodies, const MeshSettings& settings) {
    if (bodies.empty()) return input_error("there is no body to mesh");
    if (!(settings.size > 0 && std::isfinite(settings.size))) return input_error("the mesh size must be above zero");
    if (settings.order != 1 && settings.order != 2) return input_error("the order of a mesh is 1 or 2");
    return {};
}

}  // namespace

Box3 bounds(const BodyGeometry& body) {
    const auto* solid = std::get_if<Solid>(&body.shape);
    return solid != nullptr ? bounds(*solid) : bounds(std::get<TriMesh>(body.shape));
}

Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> bodies, const MeshSettings& settings, Progress& progress) {
    if (Status status = check_settings(bodies, settings); !status) return tl::unexpected(status.error());
    progress.advance("mesh", 0);
    Result<Part> solids = mesh_drawn_solids(bodies, settings);
    if (!solids) return tl::unexpected(solids.error());
    std::vector<Part> parts;
    if (solids->mesh.tet_count() > 0) parts.push_back(std::move(*solids));
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!std::holds_alternative<TriMesh>(bodies[b].shape)) continue;
        if (progress.cancelled()) return cancelled();
        progress.advance("mesh", static_cast<double>(b) / static_cast<double>(bodies.size()));
        Result<std::vector<Part>> fresh = mesh_surface_body(bodies, b, settings);
        if (!fresh) return tl::unexpected(fresh.error());
        for (Part& part : *fresh) {
            for (const Part& before : parts) {
                if (Status apart = check_apart(part, before, bodies, 0.01 * settings.size); !apart)
                    return tl::unexpected(apart.error());
            }
            parts.push_back(std::move(part));
        }
    }
    TetMesh mesh = joined(parts, settings.order);
    for (const BodyGeometry& body : bodies) mesh.region_names.push_back(body.name);
    progress.advance("mesh", 1);
    return mesh;
}

Result<TriMesh> tessellate(const Solid& solid, double tolerance) {
    if (!(tolerance > 0)) return input_error("the tolerance of a surface must be above zero");
    return kernel::tessellate(solid, tolerance);
}

Result<double> solid_volume(const Solid& solid) {
    return kernel::solid_volume(solid);
}

}  // namespace pliant::mesh
