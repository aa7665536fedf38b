#include "geometry/meshing/drawn_improver.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "geometry/mesh/mesh_report.hpp"
#include "geometry/meshing/tet_improver.hpp"

namespace pliant::mesh {
namespace {

/// Faces at a smaller angle to each other count as one plane.
constexpr double flat_deg = 0.5;

using Place = std::tuple<double, double, double>;
using Edge = std::pair<Place, Place>;  ///< its ends, the lower one first

Place place(const Vec3& p) {
    return {p.x, p.y, p.z};
}

Edge edge(const Vec3& a, const Vec3& b) {
    return std::minmax(place(a), place(b));
}

/// Positions of the mid-edge nodes that are off the midpoint of their edge.
std::map<Edge, Vec3> curved_middles(const TetMesh& mesh) {
    std::map<Edge, Vec3> middles;
    for (std::size_t t = 0; mesh.order == 2 && t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        for (std::size_t e = 0; e < 6; ++e) {
            const Vec3& a = mesh.points[n[edge_corners[e][0]]];
            const Vec3& b = mesh.points[n[edge_corners[e][1]]];
            const Vec3& middle = mesh.points[n[4 + e]];
            if (norm(middle - 0.5 * (a + b)) > 1e-9 * norm(b - a)) middles.emplace(edge(a, b), middle);
        }
    }
    return middles;
}

/// The mesh of the corner nodes only, numbered in the order of the tets.
TetMesh corners_of(const TetMesh& mesh) {
    TetMesh linear{1, {}, {}, mesh.region, mesh.region_names, mesh.notes};
    std::vector<int> index(mesh.points.size(), -1);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (std::size_t a = 0; a < 4; ++a) {
            const auto node = static_cast<std::size_t>(mesh.tet(t)[a]);
            if (index[node] < 0) {
                index[node] = static_cast<int>(linear.points.size());
                linear.points.push_back(mesh.points[node]);
            }
            linear.nodes.push_back(index[node]);
        }
    }
    return linear;
}

void restore_middles(TetMesh& mesh, const std::map<Edge, Vec3>& middles) {
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        for (std::size_t e = 0; e < 6; ++e) {
            const auto found =
                middles.find(edge(mesh.points[n[edge_corners[e][0]]], mesh.points[n[edge_corners[e][1]]]));
            if (found != middles.end()) mesh.points[n[4 + e]] = found->second;
        }
    }
}

}  // namespace

void improve_drawn_tets(TetMesh& mesh, double wanted_deg) {
    const double before = smallest_dihedral_deg(mesh);
    if (sliver_count(mesh, wanted_deg) == 0) return;
    TetMesh improved = corners_of(mesh);
    improve_tets(improved, {.wanted_deg = wanted_deg, .feature_deg = flat_deg});
    if (smallest_dihedral_deg(improved) <= before) return;
    if (mesh.order == 2) {
        improved = to_quadratic(improved);
        restore_middles(improved, curved_middles(mesh));
    }
    mesh = std::move(improved);
}

}  // namespace pliant::mesh
