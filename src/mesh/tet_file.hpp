// Tetrahedral meshes from and to files. The format is recognised by the content, not by the name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Legacy VTK, VTK XML (.vtu) or Gmsh (.msh) with tets of 4 or 10 nodes among any other cells, which are passed over,
/// as are points that no tet uses. Inside-out tets are turned, and a note counts them. The unit is the file's. Errors
/// name the file and, for text, the line. Memory follows what the file holds, not what it claims.
[[nodiscard]] Result<TetMesh> read_tet_mesh(const std::filesystem::path& path);
[[nodiscard]] Result<TetMesh> parse_tet_mesh(std::string_view bytes, const std::string& name);

/// Versions 2.0 to 5.1, ASCII or binary, UNSTRUCTURED_GRID. Whole numbers in cell data named "region", "material",
/// "medit:ref" or "gmsh:physical" become regions; a text field "region_names" or the title of vtk_text() names them by
/// their number.
[[nodiscard]] Result<TetMesh> parse_vtk(std::string_view bytes, const std::string& name);

/// UnstructuredGrid with any number of pieces; arrays as text, base64 or appended, raw or zlib-compressed, of either
/// byte order. Regions as for parse_vtk().
[[nodiscard]] Result<TetMesh> parse_vtu(std::string_view bytes, const std::string& name);

/// Gmsh 2.2 and 4.1, ASCII. Physical volumes become regions with their names; else the elementary volumes.
[[nodiscard]] Result<TetMesh> parse_msh(std::string_view bytes, const std::string& name);

/// True if the content begins like a format of read_tet_mesh().
[[nodiscard]] bool looks_like_tet_mesh(std::string_view bytes);

/// By the extension: .vtk (legacy, ASCII) or .vtu. Regions are written as cell data "region", their names as the text
/// field "region_names" or, in .vtk files, in the title line.
[[nodiscard]] Status write_tet_mesh(const std::filesystem::path& path, const TetMesh& mesh);
[[nodiscard]] std::string vtk_text(const TetMesh& mesh);

/// The title line of .vtk files that vtk_text() writes begins with this; the names follow, divided by commas, with %XX
/// for blanks and signs.
inline constexpr std::string_view vtk_title_mark = "pliant tet mesh, regions: ";

}  // namespace pliant::mesh
