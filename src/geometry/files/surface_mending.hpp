// What any surface from a file needs before it is used: points that are one, and normals that look outwards.
#pragma once

#include "geometry/files/surface_file.hpp"

namespace pliant::mesh {

/// Joins points of open edges that differ by no more than the file's own precision allows (16 steps of 32-bit numbers
/// as large as its coordinates, or 4 steps of the digits it prints if those are coarser; at most a tenth of the open
/// edges' mean length), and turns closed shells as orient_by_nesting() does. Warnings that begin with `name` say what
/// was done, in the file's unit.
void mend_surface(SurfaceFile& file, const std::string& name);

}  // namespace pliant::mesh
