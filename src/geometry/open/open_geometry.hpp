// The single place that decides what a geometry file is, by its content; names and extensions do not count.
#pragma once

#include <filesystem>
#include <string_view>
#include <variant>

#include "base/core/error.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/tet_mesh.hpp"
#include "geometry/threemf/read_3mf.hpp"

namespace pliant::mesh {

enum class GeometryKind { unknown, threemf, step, tets, surface };

/// From the first bytes; some hundreds are enough. Binary STL has no signature: bytes that are neither text nor another
/// format count as a surface.
[[nodiscard]] GeometryKind geometry_kind(std::string_view bytes);
/// The same for a file; unknown if it cannot be read.
[[nodiscard]] GeometryKind geometry_kind_of(const std::filesystem::path& path);

/// A STEP file: read_step() still needs the names of the wanted solids and the unit.
struct StepPath {
    std::filesystem::path path;
};
using Geometry = std::variant<threemf::ThreeMf, StepPath, TetMesh, SurfaceFile>;

/// Errors: those of the readers, and content that none of them recognises.
[[nodiscard]] Result<Geometry> open_geometry(const std::filesystem::path& path);

}  // namespace pliant::mesh
