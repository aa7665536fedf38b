// Loads on the outer surface.
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::sim {

/// The consistent nodal shares (sum 1) of a uniform traction over the rest area of `faces`; `nodes` ascending. For a
/// straight quadratic face all of it is at the mid-edge nodes. Precondition: at least one face of positive area.
struct SurfaceShares {
    std::vector<int> nodes;
    std::vector<double> shares;
    double area_m2 = 0;
};
[[nodiscard]] SurfaceShares surface_shares(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces);

/// Rate of each share, in their order, for a motion (3n) of the mesh's points.
[[nodiscard]] std::vector<double> share_rates(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces,
                                              std::span<const double> motion);
/// The transpose: gradient (3n) += that of the sum of worth[i] times share i, with respect to the mesh's points.
void add_share_gradient(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces, std::span<const double> worth,
                        std::span<double> gradient);

}  // namespace pliant::sim
