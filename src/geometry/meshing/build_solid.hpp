// Drawn solids as volumes of Open CASCADE, in the session of Gmsh that is open.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "geometry/meshing/gmsh_calls.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh::kernel {

/// Open CASCADE overlooks or misjudges some intersections of round faces, mostly of those whose seams lie in special
/// places. So there are several ways to build one solid: the plain one, then some with turned seams (`seam_ways` in
/// all, message_pipe.hpp), then some with one operation after the other or with a tolerance.
inline constexpr int all_ways = 8;

/// The volumes of a solid; none if nothing is left of it. Each union, difference and intersection is compared with the
/// volume of its expression (sampled_volume.hpp), and built in other ways, from `way` on, where it is wrong. Errors:
/// wrong in every way; they name the shapes, but not the body.
[[nodiscard]] Result<gmsh::Entities> build(const Solid& solid, int way = 0);

/// How far the volume may be off that Open CASCADE gives a solid.
[[nodiscard]] double volume_slack(double volume);

/// The solids of a STEP file, in file order. Open CASCADE converts the file's unit to millimetres; where
/// `scale` is not 1, the solids lose their names.
[[nodiscard]] gmsh::Entities import_solids(const std::string& file, double scale);

[[nodiscard]] double volume_of(const gmsh::Entities& volumes);
/// Volume that two solids share.
[[nodiscard]] double common_volume(const gmsh::Entities& one, const gmsh::Entities& other);
/// Area of the surface of all of them together; the model must be synchronised.
[[nodiscard]] double boundary_area(const gmsh::Entities& volumes);

}  // namespace pliant::mesh::kernel
