// Triangle surfaces from files. The format is recognised by the content, not by the name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/printed_digits.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::mesh {

struct SurfaceFile {
    TriMesh mesh;                       ///< duplicate points are merged; in the unit of the file
    std::vector<std::string> warnings;  ///< oddities that did not prevent reading
    PrintedDigits printed;              ///< precision of a text file's numbers
};

/// STL, OBJ, PLY or OFF, repaired by mend_surface(). Errors name the file and the line, or the facet. Memory is bounded
/// by the actual size of the file, whatever its header says.
[[nodiscard]] Result<SurfaceFile> read_surface(const std::filesystem::path& path);
[[nodiscard]] Result<SurfaceFile> parse_surface(std::string_view bytes, const std::string& name);

/// True if the content begins like a format of read_surface(). Binary STL has no signature: any non-text bytes pass.
[[nodiscard]] bool looks_like_surface(std::string_view bytes);
[[nodiscard]] bool looks_like_stl(std::string_view bytes);
[[nodiscard]] bool looks_like_off(std::string_view bytes);

// These readers return the content of the file without repairs.

/// ASCII or binary.
[[nodiscard]] Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name);

/// Vertices and faces of a Wavefront OBJ file; everything else is ignored. Faces of more than three corners are split
/// into triangles from their first corner and so should be convex.
[[nodiscard]] Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name);

/// PLY, ASCII or binary of either byte order: element "vertex" with x, y, z and element "face" with vertex_indices (or
/// vertex_index). Faces as for parse_obj().
[[nodiscard]] Result<SurfaceFile> parse_ply(std::string_view bytes, const std::string& name);

/// OFF as text, also with colours, normals or textures (COFF, NOFF, STOFF), which are ignored. Each vertex or face ends
/// with its line. Faces as for parse_obj().
[[nodiscard]] Result<SurfaceFile> parse_off(std::string_view bytes, const std::string& name);

/// Binary STL; coordinates are stored as 32-bit floats.
[[nodiscard]] Status write_stl(const std::filesystem::path& path, const TriMesh& mesh);

}  // namespace pliant::mesh
