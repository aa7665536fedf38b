// What a person wants to know about a tet mesh.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "mesh/tet_mesh.hpp"

namespace pliant::mesh {

struct MeshReport {
    int order = 1;
    std::size_t points = 0;
    std::size_t tets = 0;
    Box3 box;
    std::vector<std::string> region_names;
    std::vector<double> region_volumes;  ///< in the mesh's unit, cubed
    double worst_quality = 0;            ///< 6 sqrt(2) V / Lmax^3: 1 for a regular tet, 0 for a flat one
    double median_quality = 0;
    double min_dihedral_deg = 0;     ///< smallest angle between two faces of a tet: 70.5 for a regular tet
    std::vector<std::string> notes;  ///< the mesh's own
};

[[nodiscard]] MeshReport report_on(const TetMesh& mesh);
[[nodiscard]] std::string report_text(const MeshReport& report);

/// What a person wants to know about a file that holds a tet mesh or a surface, whichever it is; a line for each
/// oddity. Errors: those of the reader, and a content that no reader knows.
[[nodiscard]] Result<std::string> describe_mesh_file(const std::filesystem::path& path);

}  // namespace pliant::mesh
