// Surfaces of solids as triangles, and STEP files.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "geometry/mesher/message_pipe.hpp"
#include "geometry/meshing/build_solid.hpp"
#include "geometry/meshing/gmsh_kernel.hpp"
#include "geometry/meshing/gmsh_session.hpp"
#include "geometry/repair/surface_orientation.hpp"

namespace pliant::mesh::kernel {
namespace {

namespace occ = gmsh::model::occ;
using gmsh::Entities;

/// Appends the triangles of one face of the model to `surface`; `index` maps Gmsh's nodes to points.
void append_face(int face, TriMesh& surface, std::map<std::size_t, int>& index) {
    const auto [elements, nodes] = gmsh::model::mesh::get_elements_by_type(2, face);
    for (std::size_t t = 0; t < elements.size(); ++t) {
        std::array<int, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [entry, fresh] = index.try_emplace(nodes[3 * t + k], static_cast<int>(surface.points.size()));
            triangle[k] = entry->second;
            if (!fresh) continue;
            const std::vector<double> at = gmsh::model::mesh::get_node(nodes[3 * t + k]);
            surface.points.push_back({at[0], at[1], at[2]});
        }
        surface.triangles.push_back(triangle);
    }
}

/// The triangles on the faces of `volumes`, normals outwards.
TriMesh collect_surface(const Entities& volumes) {
    TriMesh surface;
    for (const auto& volume : volumes) {
        TriMesh one;
        std::map<std::size_t, int> index;
        for (const auto& [dimension, tag] : gmsh::model::get_boundary({volume}, true))
            append_face(std::abs(tag), one, index);
        orient_solid(one);  // Open CASCADE's faces may have either orientation
        append(surface, one);
    }
    return surface;
}

struct RoundFace {
    double area, least_radius, largest_radius;
};

struct RoundFaces {
    std::vector<RoundFace> faces;
    bool only_balls_and_cylinders = true;  ///< of radii up to `reach`: known at every point, not at the samples alone
};

/// The faces of the volumes that are not flat, with their radii at a grid of points, at most `reach`.
RoundFaces round_faces(const Entities& volumes, double reach) {
    constexpr int grid = 4;
    RoundFaces round;
    for (const auto& [dimension, tag] : gmsh::model::get_boundary(volumes, false)) {
        const auto [low, high] = gmsh::model::get_parametrization_bounds(dimension, tag);
        std::vector<double> places;
        for (int i = 0; i < grid * grid; ++i) {
            const double u = (i % grid + 0.5) / grid, v = (i / grid + 0.5) / grid;
            places.push_back(low[0] + u * (high[0] - low[0]));
            places.push_back(low[1] + v * (high[1] - low[1]));
        }
        RoundFace face{occ::get_mass(dimension, tag), reach, 0};
        for (const double curvature : gmsh::model::get_curvature(tag, places)) {
            if (!(std::fabs(curvature) * reach > 1)) continue;
            face.least_radius = std::min(face.least_radius, 1 / std::fabs(curvature));
            face.largest_radius = std::max(face.largest_radius, 1 / std::fabs(curvature));
        }
        if (face.largest_radius > 0) round.faces.push_back(face);
        const std::string type = gmsh::model::get_type(dimension, tag);
        const bool is_known = (type == "Sphere" || type == "Cylinder") && face.largest_radius > 0;
        round.only_balls_and_cylinders = round.only_balls_and_cylinders && (is_known || type == "Plane");
    }
    return round;
}

/// How many triangles, about, the round faces get with so many chords per turn.
double triangles_of(const std::vector<RoundFace>& faces, double segments) {
    constexpr double equilateral = 0.433;  // area over the square of an edge
    double sum = 0;
    for (const RoundFace& face : faces) {
        const double edge = 2 * std::numbers::pi * face.least_radius / segments;
        sum += face.area / (equilateral * edge * edge);
    }
    return sum;
}

struct Chords {
    double per_turn, deviation;
};

/// So many chords per turn that those of an arc of radius r deviate by tolerance / 2; the other half is for triangles,
/// which deviate more from a ball than their edges do. Gmsh divides arcs of all radii into equally many: what the
/// largest one needs would make a long thin rod a matter of hours, so where that is too much, only what the radii at
/// hand need, or even less. So it is too where these are known at every point.
Chords chords_for(const Entities& volumes, double reach, double tolerance) {
    constexpr double least = 24, most = 2000, too_many_triangles = 5e5, many_triangles = 2e5;
    constexpr double finer = 1.5, few_triangles = 5e4;  // 2.25 times nearer than asked, where it costs little
    const auto needed = [&](double radius) {
        return std::clamp(2 * std::numbers::pi / std::sqrt(4 * tolerance / radius), least, most);
    };
    const auto [faces, only_balls_and_cylinders] = round_faces(volumes, reach);
    double radius = tolerance;
    for (const RoundFace& face : faces) radius = std::max(radius, face.largest_radius);
    if (only_balls_and_cylinders) {
        for (const auto& [factor, limit] : {std::pair(finer, few_triangles), std::pair(1.0, too_many_triangles)}) {
            const double chords = std::min(factor * needed(radius), needed(reach));
            if (triangles_of(faces, chords) <= limit) return {chords, tolerance};
        }
    } else if (triangles_of(faces, needed(reach)) <= too_many_triangles) {
        return {needed(reach), tolerance};
    }
    const double fewer = std::sqrt(std::min(1.0, many_triangles / triangles_of(faces, needed(radius))));
    const double chords = std::max(least, fewer * needed(radius));
    return {chords, std::max(tolerance, std::pow(std::numbers::pi / chords, 2) * radius)};
}

Result<TriMesh> try_tessellate(const Solid& solid, double tolerance, int way) {
    return in_session("tessellating", [&]() -> Result<TriMesh> {
        const Result<Entities> built = build(solid, way);
        if (!built) return tl::unexpected(built.error());
        const Entities& volumes = *built;
        if (volumes.empty()) return input_error("is empty: nothing is left of it");
        occ::synchronize();
        const double reach = std::max(bounds(solid).diagonal() / 2, tolerance);
        const auto [segments, deviation] = chords_for(volumes, reach, tolerance);
        set_size(4 * reach);  // flat faces need no inner points
        gmsh::option::set_number("Mesh.MeshSizeFromCurvature", segments);
        gmsh::model::mesh::generate(2);
        TriMesh surface = collect_surface(volumes);
        const double exact = volume_of(volumes);
        const double found = signed_volume(surface);
        if (std::fabs(found - exact) > 4 * deviation * boundary_area(volumes) + 1e-6 * exact)
            return failure("the surface encloses {:.6g} where the solid has {:.6g}", found, exact);
        return surface;
    });
}

}  // namespace

Result<TriMesh> tessellate(const Solid& solid, double tolerance, int way) {
    Result<TriMesh> surface = try_tessellate(solid, tolerance, way);
    // Gmsh may fail on the seam of a round face.
    while (!surface && surface.error().cause == Cause::failed && way + 1 < seam_ways)
        surface = try_tessellate(solid, tolerance, ++way);
    return surface;
}

namespace {

/// The solids of a STEP file in millimetres, with meshed surfaces. They are not scaled: that makes new shapes, without
/// the names of the old ones.
Entities import_surfaces(const std::string& file) {
    Entities solids = import_solids(file, 1);
    occ::synchronize();
    gmsh::option::set_number("Mesh.MeshSizeFromCurvature", 32);
    if (!solids.empty()) gmsh::model::mesh::generate(2);
    return solids;
}

}  // namespace

Result<StepContent> read_step(const std::string& file, double scale) {
    return in_session("reading", [&]() -> Result<StepContent> {
        const Entities solids = import_surfaces(file);
        if (solids.empty()) return input_error("holds no solid");
        StepContent content;
        for (const auto& solid : solids) {
            const std::string path = gmsh::model::get_entity_name(3, solid.second);
            content.names.push_back(path.substr(path.rfind('/') + 1));
            content.surfaces.push_back(scaled(collect_surface({solid}), scale));
        }
        return content;
    });
}

Result<double> solid_volume(const Solid& solid, int way) {
    return in_session("measuring", [&]() -> Result<double> {
        const Result<Entities> built = build(solid, way);
        if (!built) return tl::unexpected(built.error());
        return volume_of(*built);
    });
}

}  // namespace pliant::mesh::kernel
