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

/// What a slice stack says about the heights from the top of the slice below it (or the stack's bottom) to its own.
struct Slice {
    double bottom_mm = 0, top_mm = 0;
    std::vector<Contour> contours;
};

/// One object on the plate, or the part of it that one material fills. Coordinates are on the plate.
struct Body {
    std::string name;      ///< the object's, or "object 7"; not unique
    std::string material;  ///< of a base material its name, of a colour "#RRGGBB"; "default" where the file names none
    mesh::TriMesh mesh_mm;
    std::vector<Slice> slices;  ///< from the bottom up; where there are any, they are the body, and not the mesh
};

struct ThreeMf {
    std::vector<Body> bodies;           ///< in the order of the build
    std::vector<std::string> warnings;  ///< each starts with the file's name
};

/// Core specification 1.x with the extensions for materials, production and slices, whose prefix a file may require;
/// any other required extension is refused by name. An object's property, or one that all its triangles name, is its
/// material; where triangles differ, every connected shell of a single property becomes a body, and a shell of several
/// stays one body with a warning, since colours of a surface do not bound volumes.
///
/// Safe for files from anywhere: sizes are checked before memory is taken, no part outside the file is looked for, and
/// a document type is refused. Errors name file, part, line and what would be right.
[[nodiscard]] Result<ThreeMf> read_3mf(const std::filesystem::path& path);

/// The same from the text of a model part without others beside it.
[[nodiscard]] Result<ThreeMf> parse_3mf_model(std::string text, const std::string& name);

/// True if the bytes begin like a zip file, as every 3MF file does.
[[nodiscard]] bool looks_like_zip(std::string_view bytes);

}  // namespace pliant::threemf
