// Tetrahedral meshes from files; tet_writer.hpp writes them. The format is recognised by the content, not by the name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// A tet mesh in any format of tet_format.hpp: tets of 4 or 10 nodes among any other cells, which are passed over, as
/// are points that no tet uses. Inside-out tets are turned, and a note counts them. The unit is the file's. TetGen's
/// pair of files is read by the name of either. Errors name the file and, for text, the line. Memory follows what the
/// file holds, not what it claims.
[[nodiscard]] Result<TetMesh> read_tet_mesh(const std::filesystem::path& path);
[[nodiscard]] Result<TetMesh> parse_tet_mesh(std::string_view bytes, const std::string& name);

/// Versions 2.0 to 5.1, ASCII or binary, UNSTRUCTURED_GRID. Whole numbers in cell data named "region", "material",
/// "medit:ref" or "gmsh:physical" become regions; a text field "region_names" or the title of vtk_bytes() names them by
/// their number.
[[nodiscard]] Result<TetMesh> parse_vtk(std::string_view bytes, const std::string& name);

/// UnstructuredGrid with any number of pieces; arrays as text, base64 or appended, raw or zlib-compressed, of either
/// byte order. Regions as for parse_vtk().
[[nodiscard]] Result<TetMesh> parse_vtu(std::string_view bytes, const std::string& name);

/// Gmsh 2.2 and 4.1, text and binary. Physical volumes become regions with their names; else the elementary volumes.
[[nodiscard]] Result<TetMesh> parse_msh(std::string_view bytes, const std::string& name);

/// Medit text: Tetrahedra or TetrahedraP2; the reference of a tet is its region.
[[nodiscard]] Result<TetMesh> parse_medit(std::string_view bytes, const std::string& name);

/// Abaqus and CalculiX: C3D4 and C3D10 of every variety. Element sets become regions; inp_reader.cpp says which.
[[nodiscard]] Result<TetMesh> parse_inp(std::string_view bytes, const std::string& name);

/// GiD text: the material of an element is its region, else the name of its block.
[[nodiscard]] Result<TetMesh> parse_gid(std::string_view bytes, const std::string& name);

/// TetGen's .node and .ele: the first attribute of a tet is its region.
[[nodiscard]] Result<TetMesh> parse_tetgen(std::string_view nodes, const std::string& nodes_name, std::string_view tets,
                                           const std::string& tets_name);

/// True if the content begins like a format of read_tet_mesh().
[[nodiscard]] bool looks_like_tet_mesh(std::string_view bytes);

}  // namespace pliant::mesh
