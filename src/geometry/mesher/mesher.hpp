// Bodies to one tetrahedral mesh, through Gmsh and Open CASCADE.
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

/// One body: a solid expression, or a closed surface. Lengths in one unit of the caller's choice.
struct BodyGeometry {
    std::string name;
    std::variant<Solid, TriMesh> shape;
    bool air = false;  ///< empty space: it has no walls of its own
    double size = 0;   ///< wanted edge length in this body; 0: that of the whole mesh
};

[[nodiscard]] Box3 bounds(const BodyGeometry& body);

struct MeshSettings {
    double size = 0;              ///< wanted edge length, above zero
    int order = 2;                ///< 1 or 2; mid-edge nodes lie on the curved faces of solids where that folds no tet
    double angle_deg = 30;        ///< edges of a surface file sharper than this are kept
    int through_wall = 0;         ///< elements through every wall, at least; 0: as the size gives
    bool judge_walls = false;     ///< a note names the thinnest wall that has fewer than three elements through it
    double close_gaps = 0;        ///< gaps between solids up to this width are closed; 0: none
    double size_near_cables = 0;  ///< within twice this length of a cable; 0: no wish
    std::vector<std::vector<Vec3>> cables = {};  ///< their points
};

/// One mesh of all bodies; region i is body i. Solid expressions that touch share the nodes of the common face; of
/// those that overlap the later one has what they share, and a note tells the volume. A gap of at most `close_gaps`
/// between two is closed, and a note tells its width; one that cannot be closed is told likewise. A surface may have
/// several shells and cavities; it is meshed anew, its sharp edges kept (or, where that fails, it keeps its triangles,
/// and a note says so). Where it comes near another body it becomes a solid if it has few flat faces (polyhedron()); if
/// not, all that hangs together there (touching_groups()) is meshed in one go from its winding numbers, and a note
/// gives the volumes. The same input gives the same mesh. A mesh of more than 20 million tets
/// is refused. Errors that are about one body have its name as the key of their problem.
[[nodiscard]] Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> bodies, const MeshSettings& settings,
                                          Progress& progress);

/// The closed surface of a solid; curved faces within `tolerance` (above zero) down to chords of
/// 1/2000 of a turn, flat faces exact. Triangles look outwards.
[[nodiscard]] Result<TriMesh> tessellate(const Solid& solid, double tolerance);

/// Volume of a solid by its boundary representation.
[[nodiscard]] Result<double> solid_volume(const Solid& solid);

}  // namespace pliant::mesh
