// Tetrahedral meshes from and to files. The format is recognised by the content, not by the name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "mesh/tet_mesh.hpp"

namespace pliant::mesh {

/// Legacy VTK (2.0 to 5.1, ASCII or binary): UNSTRUCTURED_GRID with tets of 4 or 10 nodes among any other cells, which
/// are passed over, as are points that no tet uses. Cell data named "region", "material" or "medit:ref" become regions.
/// Inside-out tets are turned. The unit is the file's.
[[nodiscard]] Result<TetMesh> read_tet_mesh(const std::filesystem::path& path);
[[nodiscard]] Result<TetMesh> parse_vtk(std::string_view bytes, const std::string& name);

/// True if the content begins like a format of read_tet_mesh().
[[nodiscard]] bool looks_like_tet_file(const std::filesystem::path& path);

/// By the extension: .vtk (legacy, ASCII) or .vtu. Regions are written as cell data "region".
[[nodiscard]] Status write_tet_mesh(const std::filesystem::path& path, const TetMesh& mesh);
[[nodiscard]] std::string vtk_text(const TetMesh& mesh);

}  // namespace pliant::mesh
