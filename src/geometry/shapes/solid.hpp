// Solids as short expressions: geometry without a CAD program.
//
//     { box = [[0,0,0],[100,20,15]] }
//     { sphere = { center = [0,0,0], radius = 5 } }
//     { cylinder = { from = [0,0,0], to = [0,0,10], radius = 2 } }
//     { prism = [[0,0],[4,0],[0,3]], plane = "xy", from = 0, to = 10 }      extruded polygon
//     { union = [A, B] }   { intersection = [A, B] }   { difference = [A, B, C] }     A without B and C
//     { translate = [x,y,z], of = A }   { rotate = 90, axis = [0,0,1], center = [0,0,0], of = A }
//     { repeat = 6, step = [14,0,0], of = A }       six copies, united
//     { use = "name" }                              a shape named elsewhere
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/core/config.hpp"
#include "base/core/vec3.hpp"

namespace pliant::mesh {

struct SolidNode;
struct FacetedSurface;
class TriangleTree;

/// An immutable solid; copies are cheap. Lengths are in the caller's unit.
using Solid = std::shared_ptr<const SolidNode>;

struct BoxSolid {
    Vec3 low, high;
};
struct SphereSolid {
    Vec3 center;
    double radius;
};
struct CylinderSolid {
    Vec3 from, to;
    double radius;
};
/// Polygon corners (u, v) on two axes, extruded along the third: plane "xy": u = x, v = y; "xz": u = x, v = z;
/// "yz": u = y, v = z.
struct PrismSolid {
    std::vector<std::array<double, 2>> polygon;
    std::array<int, 3> axes;  ///< of u, v and the extrusion
    double from, to;
};
struct CombinedSolid {
    enum class Operation { unite, intersect, subtract };
    Operation operation;
    std::vector<Solid> parts;  ///< subtract: the first minus all others
};
struct TranslatedSolid {
    Solid of;
    Vec3 offset;
};
struct RotatedSolid {
    Solid of;
    Vec3 center, axis;
    double angle_rad;
};
struct RepeatedSolid {
    Solid of;
    int count;
    Vec3 step;
};

/// The connected piece of the empty space between walls that contains a point. No user syntax: the air of a chamber.
struct EnclosedSolid {
    Vec3 point;
    std::vector<Solid> walls;  ///< at least one
};

/// The part of the empty space between walls that is inside convex hulls, in the pieces around points. No user syntax:
/// the notches that a cable crosses.
struct NotchesSolid {
    std::vector<Solid> hulls;  ///< at least one
    std::vector<Vec3> points;  ///< one in each piece
    std::vector<Solid> walls;
};

/// The inside of a closed surface of flat faces (flat_faces.hpp).
struct PolyhedronSolid {
    std::shared_ptr<const FacetedSurface> faces;
    std::shared_ptr<const TriangleTree> surface;
};

/// Solids of a STEP file (step_file.hpp).
struct StepSolid {
    std::string file;
    std::vector<int> numbers;                     ///< of the solids, from 0, in the order of the file
    double scale;                                 ///< the caller's length units per millimetre
    std::shared_ptr<const TriangleTree> surface;  ///< of all solids, accurate enough to tell inside from outside
};

struct SolidNode {
    std::variant<BoxSolid, SphereSolid, CylinderSolid, PrismSolid, CombinedSolid, TranslatedSolid, RotatedSolid,
                 RepeatedSolid, EnclosedSolid, NotchesSolid, PolyhedronSolid, StepSolid>
        shape;
};

/// Exact point test; points on the surface may count either way, and so do points near the curved faces of a STEP file.
/// Between walls: true in any piece.
[[nodiscard]] bool contains(const Solid& solid, const Vec3& point);

/// A box that contains the solid: the smallest one for simple shapes, however turned, for their unions and repetitions;
/// what is cut away makes it no smaller.
[[nodiscard]] Box3 bounds(const Solid& solid);

/// Shapes that `use` may name.
using NamedShapes = std::vector<std::pair<std::string, const config::Value*>>;

/// Parses an expression. Problems carry line and key; if there are any, the result must not be used.
[[nodiscard]] Solid read_solid(const config::Value& value, const std::string& path, const NamedShapes& shapes,
                               config::Problems& problems);

}  // namespace pliant::mesh
