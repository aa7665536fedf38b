// Quality report on a tet mesh.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

struct RegionReport {
    std::string name;
    std::size_t tets = 0;
    double volume = 0;  ///< in the mesh's unit, cubed
};

struct MeshReport {
    static constexpr std::size_t quality_bins = 20;   ///< bins of 0.05
    static constexpr std::size_t dihedral_bins = 36;  ///< bins of 5 degrees

    int order = 1;
    std::size_t points = 0;
    std::size_t tets = 0;
    Box3 box;
    std::vector<RegionReport> regions;
    double worst_quality = 0;  ///< 6 sqrt(2) V / Lmax^3: 1 for a regular tet, 0 for a flat one
    double median_quality = 0;
    Vec3 worst_at;                ///< centroid of the tet with the worst quality
    double min_dihedral_deg = 0;  ///< smallest angle between two faces of a tet: 70.5 for a regular tet
    double max_dihedral_deg = 0;
    double worst_jacobian = 1;                                 ///< minimum of worst_scaled_jacobian(); 1 for linear
                                                               ///< tets
    std::array<std::size_t, quality_bins> quality_counts{};    ///< number of tets
    std::array<std::size_t, dihedral_bins> dihedral_counts{};  ///< number of angles, six per tet
    std::vector<std::string> notes;                            ///< the notes of the mesh
};

[[nodiscard]] MeshReport report_on(const TetMesh& mesh);
/// The smallest angle between two faces of a tet, over all tets; 180 if there are none.
[[nodiscard]] double smallest_dihedral_deg(const TetMesh& mesh);

/// Number of tets with a dihedral angle below this many degrees.
[[nodiscard]] std::size_t sliver_count(const TetMesh& mesh, double below_deg);
[[nodiscard]] std::string report_text(const MeshReport& report);
/// The report as a JSON object; docs/reference/geometry.md lists its keys. `unit_mm`: the mesh's unit, where it is
/// known.
[[nodiscard]] std::string report_json(const MeshReport& report, std::optional<double> unit_mm = {});

}  // namespace pliant::mesh
