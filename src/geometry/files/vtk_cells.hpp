// Types of cells in .vtk and .vtu files. Format: VTK User's Guide, "Simple legacy formats".
#pragma once

#include <cstdint>

namespace pliant::mesh {

/// VTK's numbers of tets with 4 and with 10 nodes.
inline constexpr std::uint8_t vtk_tetra = 10;
inline constexpr std::uint8_t vtk_quadratic_tetra = 24;

}  // namespace pliant::mesh
