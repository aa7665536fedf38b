// What a file of geometry holds, for a page that is about to make bodies of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"

namespace pliant::studio {

struct GeometryContent {
    std::string kind;    ///< "surface", "step", "3mf" or "tets"
    double unit_mm = 0;  ///< of its coordinates; 0: the file does not say
    Box3 box;            ///< in that unit
    std::string text;    ///< for people: "surface, 12 triangles"
    /// What a body may name: regions of a tet mesh, materials of a 3MF file. Empty: the file is one body.
    std::vector<std::string> parts{};
    std::vector<std::string> notes{};  ///< what was odd, a sentence each
};

/// Read whole by the reader of its format, which the content decides. Errors: those of the readers; slices instead of
/// surfaces, which are for printing only.
[[nodiscard]] Result<GeometryContent> geometry_content(const std::filesystem::path& path);

}  // namespace pliant::studio
