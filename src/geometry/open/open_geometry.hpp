// What a file of geometry is, decided in one place and by its content; names and extensions do not count.
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

/// By the first bytes, of which some hundreds are enough. Binary STL has no mark: bytes that are no text and nothing
/// else count as a surface.
[[nodiscard]] GeometryKind geometry_kind(std::string_view bytes);
/// The same of a file; unknown where it cannot be read.
[[nodiscard]] GeometryKind geometry_kind_of(const std::filesystem::path& path);

/// A STEP file: read_step() still needs to know which of its solids are wanted, and in which unit.
struct StepPath {
    std::filesystem::path path;
};
using Geometry = std::variant<threemf::ThreeMf, StepPath, TetMesh, SurfaceFile>;

/// Errors: those of the readers, and a content that none of them knows.
[[nodiscard]] Result<Geometry> open_geometry(const std::filesystem::path& path);

}  // namespace pliant::mesh
