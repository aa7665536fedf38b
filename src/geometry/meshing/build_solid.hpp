// Drawn solids as volumes of Open CASCADE, in the session of Gmsh that is open.
#pragma once

#include <string>

#include "geometry/meshing/gmsh_calls.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh::kernel {

/// The volumes of a solid; none if nothing is left of it.
[[nodiscard]] gmsh::Entities build(const Solid& solid);

/// The solids of a STEP file, in file order. Open CASCADE converts the file's unit to millimetres.
[[nodiscard]] gmsh::Entities import_solids(const std::string& file, double scale);

[[nodiscard]] double volume_of(const gmsh::Entities& volumes);
/// Volume that two solids share.
[[nodiscard]] double common_volume(const gmsh::Entities& one, const gmsh::Entities& other);
/// Area of the surface of all of them together; the model must be synchronised.
[[nodiscard]] double boundary_area(const gmsh::Entities& volumes);

}  // namespace pliant::mesh::kernel
