// Text summary of a mesh file.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "geometry/mesh/mesh_report.hpp"

namespace pliant::mesh {

/// A tet mesh, a surface or a 3MF file, whichever it is; one line for each oddity. Errors: those of the reader, and
/// content that no reader recognises.
[[nodiscard]] Result<std::string> describe_mesh_file(const std::filesystem::path& path);

/// The report on a file that must contain a tet mesh.
[[nodiscard]] Result<MeshReport> report_on_file(const std::filesystem::path& path);

}  // namespace pliant::mesh
