// Triangle surfaces from files. The format is recognised by the content, not by the name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct SurfaceFile {
    TriMesh mesh;                       ///< exactly equal points are one; the unit is the file's
    std::vector<std::string> warnings;  ///< what was odd but could be read
};

/// STL, ASCII or binary. Errors name the file and the line, or the facet.
[[nodiscard]] Result<SurfaceFile> read_surface(const std::filesystem::path& path);
[[nodiscard]] Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name);

/// Binary STL with `points * factor`; coordinates are stored as 32-bit floats.
[[nodiscard]] Status write_stl(const std::filesystem::path& path, const TriMesh& mesh);

}  // namespace pliant::mesh
