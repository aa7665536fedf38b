// Repairs needed by any surface from a file: merging duplicate points, and outward normals.
#pragma once

#include "geometry/files/surface_file.hpp"

namespace pliant::mesh {

/// Merges points of open edges whose distance is within the precision of the file (16 steps of 32-bit floats at the
/// size of its coordinates, or 4 steps of its last printed digit if that is coarser; at most a tenth of the mean length
/// of the open edges), and orients closed shells as orient_by_nesting() does. Warnings that begin with `name` report
/// the changes, in the file's unit.
void mend_surface(SurfaceFile& file, const std::string& name);

}  // namespace pliant::mesh
