// Reading of tetrahedral meshes; tet_writer.hpp writes them. The format is recognised by the content, not by the name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// A tet mesh in any format of tet_format.hpp: tets of 4 or 10 nodes; other cells and unused points are ignored.
/// Inverted tets are reversed, and a note counts them. In the unit of the file. TetGen's pair of files is read given
/// the name of either. Errors name the file and, for text, the line. Memory is bounded by the actual size of the file,
/// whatever its header says.
[[nodiscard]] Result<TetMesh> read_tet_mesh(const std::filesystem::path& path);
[[nodiscard]] Result<TetMesh> parse_tet_mesh(std::string_view bytes, const std::string& name);

/// Versions 2.0 to 5.1, ASCII or binary, UNSTRUCTURED_GRID. Integer cell data named "region", "material", "medit:ref"
/// or "gmsh:physical" become regions; a text field "region_names" or the title of vtk_bytes() gives the name of each
/// number.
[[nodiscard]] Result<TetMesh> parse_vtk(std::string_view bytes, const std::string& name);

/// UnstructuredGrid with any number of pieces; arrays as text, base64 or appended, raw or zlib-compressed, of either
/// byte order. Regions as for parse_vtk().
[[nodiscard]] Result<TetMesh> parse_vtu(std::string_view bytes, const std::string& name);

/// Gmsh 2.2 and 4.1, text and binary. Regions are the physical volumes with their names or, if there are none, the
/// elementary volumes.
[[nodiscard]] Result<TetMesh> parse_msh(std::string_view bytes, const std::string& name);

/// Medit text: Tetrahedra or TetrahedraP2; the reference of a tet is its region.
[[nodiscard]] Result<TetMesh> parse_medit(std::string_view bytes, const std::string& name);

/// Abaqus and CalculiX: all variants of C3D4 and C3D10. Element sets become regions; inp_reader.cpp says which.
[[nodiscard]] Result<TetMesh> parse_inp(std::string_view bytes, const std::string& name);

/// GiD text: the region of an element is its material or, without one, the name of its block.
[[nodiscard]] Result<TetMesh> parse_gid(std::string_view bytes, const std::string& name);

/// TetGen's .node and .ele: the first attribute of a tet is its region.
[[nodiscard]] Result<TetMesh> parse_tetgen(std::string_view nodes, const std::string& nodes_name, std::string_view tets,
                                           const std::string& tets_name);

/// True if the content begins like a format of read_tet_mesh().
[[nodiscard]] bool looks_like_tet_mesh(std::string_view bytes);

}  // namespace pliant::mesh
