// Bodies of several materials from 3MF files.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "geometry/mesh/tri_mesh.hpp"

namespace pliant::threemf {

/// A closed outline in the plane, counter-clockwise around material; the last point joins the first. Millimetres.
using Contour = std::vector<std::array<double, 2>>;

/// One slice of a stack: covers the heights from the top of the slice below (or the stack's bottom) to its own top.
struct Slice {
    double bottom_mm = 0, top_mm = 0;
    std::vector<Contour> contours;
};

/// One object on the plate, or its part of one material. Coordinates are on the plate.
struct Body {
    std::string name;      ///< the object's, or "object 7"; not unique
    std::string material;  ///< name of a base material, or "#RRGGBB" for a colour; "default" if the file names none
    mesh::TriMesh mesh_mm;
    std::vector<Slice> slices;  ///< from the bottom up; if present, they define the body instead of the mesh
};

struct ThreeMf {
    std::vector<Body> bodies;           ///< in the order of the build
    int items = 0;                      ///< of the build, without those that are excluded from printing
    std::vector<std::string> warnings;  ///< each begins with the file's name
};

/// Core specification 1.x with the extensions for materials, production and slices; any other required extension is
/// refused by name. An object's property, or one that all its triangles share, is its material; if triangles differ,
/// every connected shell of a single property becomes a body, and a shell of several stays one body with a warning,
/// since surface colours do not bound volumes.
///
/// Safe for untrusted files: sizes are checked before memory is allocated, nothing outside the file is opened, and
/// document types are refused. Errors name file, part, line and what would be right.
[[nodiscard]] Result<ThreeMf> read_3mf(const std::filesystem::path& path);

/// The same from the text of a single model part.
[[nodiscard]] Result<ThreeMf> parse_3mf_model(std::string text, const std::string& name);

/// True if the bytes begin like a zip file, as every 3MF file does.
[[nodiscard]] bool looks_like_zip(std::string_view bytes);

}  // namespace pliant::threemf
