// Solids of a STEP file as one surface.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/error.hpp"
#include "mesh/tri_mesh.hpp"

namespace pliant::step {

/// ISO 10303-21 begins with this line.
[[nodiscard]] bool looks_like_step(std::string_view bytes);

struct StepFile {
    mesh::TriMesh surface_mm;  ///< of all solids, one closed shell or more for each, outwards
    int solids = 0;
    double volume_mm3 = 0;  ///< exact, of the solids as drawn
};

/// Lengths are those of the file, in millimetres whatever its unit. Arcs are cut into 120 chords a turn or more, which
/// is true to 0.05 % of a cylinder's area. Not to be called while another thread uses Gmsh. Errors: what Open CASCADE
/// cannot read, a file without solids, triangles whose volume is more than 0.2 % off the exact one.
[[nodiscard]] Result<StepFile> read_step(const std::filesystem::path& path);

}  // namespace pliant::step
