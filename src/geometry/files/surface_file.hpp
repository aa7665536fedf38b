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
    TriMesh mesh;                       ///< exactly equal points are one; the unit is the file's
    std::vector<std::string> warnings;  ///< what was odd but could be read
    PrintedDigits printed;              ///< of a text file
};

/// STL, OBJ, PLY or OFF, mended by mend_surface(). Errors name the file and the line, or the facet. Memory follows what
/// the file holds, not what it claims.
[[nodiscard]] Result<SurfaceFile> read_surface(const std::filesystem::path& path);
[[nodiscard]] Result<SurfaceFile> parse_surface(std::string_view bytes, const std::string& name);

/// True if the content begins like a format of read_surface(). Binary STL has no mark: bytes that are no text pass.
[[nodiscard]] bool looks_like_surface(std::string_view bytes);
[[nodiscard]] bool looks_like_stl(std::string_view bytes);
[[nodiscard]] bool looks_like_off(std::string_view bytes);

// The readers give what the file says and mend nothing.

/// ASCII or binary.
[[nodiscard]] Result<SurfaceFile> parse_stl(std::string_view bytes, const std::string& name);

/// Vertices and faces of a Wavefront OBJ file; all else in it is passed over. Faces of more than three corners are cut
/// into triangles from their first corner and so should be convex.
[[nodiscard]] Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name);

/// PLY, ASCII or binary of either byte order: element "vertex" with x, y, z and element "face" with vertex_indices (or
/// vertex_index). Faces as for parse_obj().
[[nodiscard]] Result<SurfaceFile> parse_ply(std::string_view bytes, const std::string& name);

/// OFF as text, also with colours, normals or textures (COFF, NOFF, STOFF), which are passed over. A vertex or a face
/// ends with its line. Faces as for parse_obj().
[[nodiscard]] Result<SurfaceFile> parse_off(std::string_view bytes, const std::string& name);

/// Binary STL; coordinates are stored as 32-bit floats.
[[nodiscard]] Status write_stl(const std::filesystem::path& path, const TriMesh& mesh);

}  // namespace pliant::mesh
