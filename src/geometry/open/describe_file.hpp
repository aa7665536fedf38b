// Text summary of a mesh file.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "geometry/mesh/mesh_report.hpp"

namespace pliant::mesh {

/// A tet mesh, a surface or a 3MF file, whichever it is; one line for each oddity. Lengths are multiplied by `factor`.
/// Errors: those of the reader; content that no reader recognises; a factor other than 1 for a file with a unit.
[[nodiscard]] Result<std::string> describe_mesh_file(const std::filesystem::path& path, double factor = 1);

/// The report on a file that must contain a tet mesh.
[[nodiscard]] Result<MeshReport> report_on_file(const std::filesystem::path& path, double factor = 1);

}  // namespace pliant::mesh
