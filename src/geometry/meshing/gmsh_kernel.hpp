// The interface to Gmsh and Open CASCADE inside this folder; others use mesher.hpp. Gmsh has global state, so calls
// must not run concurrently: pliant-mesh serves one request after the other. Each call begins with an empty model.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/mesher/step_content.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh::kernel {

struct NamedSolid {
    std::string name;
    Solid solid;
};

/// An error about one body: its only problem has the body's name as key.
[[nodiscard]] inline tl::unexpected<Error> about(const std::string& body, Error error) {
    error.problems = {{"", 0, body, error.message}};
    return tl::unexpected(std::move(error));
}

/// A tet with a smaller dihedral angle is a sliver, which makes a simulation stiff and slow.
inline constexpr double sliver_deg = 5;

/// Target edge length in solid i at a point; empty: the mesh size everywhere.
using SizeAt = std::function<double(std::size_t, const Vec3&)>;

/// One conforming mesh; region i is solid i, without region names. Where solids overlap, the later one gets the shared
/// volume, which a note states; solids at most `join_within` apart are joined. `way`: as build_solid.hpp says. Errors:
/// an empty solid; one that Open CASCADE gets wrong; a size that gives too many tets.
[[nodiscard]] Result<TetMesh> mesh_solids(std::span<const NamedSolid> solids, double size, int order,
                                          const SizeAt& size_at = {}, double join_within = 0, int way = 0);

/// Remeshes the inside of a closed surface (one outer shell and its cavities), linear, in one region. Edges sharper
/// than `angle_deg` are preserved. If a dihedral angle is under 5 degrees, edges get up to a fifth shorter. A surface
/// that cannot be parametrised keeps its triangles, and a note says so; error if the mesh then has another volume.
[[nodiscard]] Result<TetMesh> mesh_surface(const TriMesh& surface, double size, double angle_deg,
                                           const SizeAt& size_at = {});

/// See mesher.hpp; the tolerance is above zero.
[[nodiscard]] Result<TriMesh> tessellate(const Solid& solid, double tolerance, int way = 0);
[[nodiscard]] Result<double> solid_volume(const Solid& solid, int way = 0);

/// All solids of a STEP file, millimetres times `scale`. Errors do not name the file.
[[nodiscard]] Result<StepContent> read_step(const std::string& file, double scale);

/// Error if the mesh would have more than 20 million tets, estimated from a body's volume and surface area.
[[nodiscard]] Status check_tet_count(double volume, double area, double size);

}  // namespace pliant::mesh::kernel
