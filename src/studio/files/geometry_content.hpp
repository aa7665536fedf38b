// The contents of a geometry file, for a page that is about to create bodies from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"

namespace pliant::studio {

struct GeometryContent {
    std::string kind;    ///< "surface", "step", "3mf" or "tets"
    double unit_mm = 0;  ///< unit of its coordinates; 0: not in the file
    Box3 box;            ///< in that unit
    std::string text;    ///< for people: "surface, 12 triangles"
    /// What a body may refer to: regions of a tet mesh, materials of a 3MF file. Empty: the file is one body.
    std::vector<std::string> parts{};
    std::vector<std::string> notes{};  ///< defects found, one sentence each
};

/// Reads the whole file, in the format recognised from its content. Errors: those of the readers; slices instead of
/// surfaces, which can only be printed.
[[nodiscard]] Result<GeometryContent> geometry_content(const std::filesystem::path& path);

}  // namespace pliant::studio
