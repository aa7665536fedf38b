// Meshes bodies into one tetrahedral mesh, with Gmsh and Open CASCADE.
#pragma once

#include <span>
#include <string>
#include <variant>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {

/// One body: a solid expression or a closed surface. All lengths are in one unit of the caller's choice.
struct BodyGeometry {
    std::string name;
    std::variant<Solid, TriMesh> shape;
    bool air = false;  ///< empty space: it has no walls of its own
    double size = 0;   ///< target edge length in this body; 0: that of the whole mesh
};

[[nodiscard]] Box3 bounds(const BodyGeometry& body);
/// The box around all bodies that have points.
[[nodiscard]] Box3 bounds(std::span<const BodyGeometry> bodies);
/// Of that box.
[[nodiscard]] double longest_side(std::span<const BodyGeometry> bodies);

struct MeshSettings {
    double size = 0;              ///< target edge length, positive
    int order = 2;                ///< 1 or 2; mid-edge nodes lie on the curved faces of solids unless that folds a tet
    double angle_deg = 30;        ///< edges of a surface file sharper than this are preserved
    int through_wall = 0;         ///< minimum number of elements through every wall; 0: as the size gives
    bool judge_walls = false;     ///< add a note that names the thinnest wall with fewer than three elements through it
    double close_gaps = 0;        ///< gaps between solids up to this width are closed; 0: none
    double size_near_cables = 0;  ///< target within twice this length of a cable; 0: none
    std::vector<std::vector<Vec3>> cables = {};  ///< their points
};

/// One mesh of all bodies; region i is body i. Solid expressions that touch share the nodes of the common face; where
/// they overlap, the later one gets the shared volume, which a note states. Gaps of at most `close_gaps` between two
/// are closed; a note gives the width, also of a gap that cannot be closed. A surface may have several shells and
/// cavities; it is remeshed with its sharp edges preserved (if that fails, it keeps its triangles, and a note says so).
/// Near another body, a surface of few flat faces becomes a solid (polyhedron()); otherwise the whole group of touching
/// bodies (touching_groups()) is meshed at once from winding numbers, and a note gives the volumes. The same input
/// gives the same mesh. A mesh of more than 20 million tets is refused. Errors about one body have its name as the key
/// of their problem.
[[nodiscard]] Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> bodies, const MeshSettings& settings,
                                          Progress& progress);

/// The closed surface of a solid, normals outwards: curved faces within `tolerance` (above zero), but with chords no
/// finer than 1/2000 of a turn, and with longer ones where curved faces would get far too many triangles; flat
/// faces exact.
[[nodiscard]] Result<TriMesh> tessellate(const Solid& solid, double tolerance, Progress& progress);
[[nodiscard]] Result<TriMesh> tessellate(const Solid& solid, double tolerance);

/// Volume of a solid from its boundary representation.
[[nodiscard]] Result<double> solid_volume(const Solid& solid);

}  // namespace pliant::mesh
