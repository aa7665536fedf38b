#include "geometry/mesh/curved_tets.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "geometry/mesh/curved_point.hpp"

namespace pliant::mesh {
namespace {

using Barycentric = std::array<double, 4>;

/// Corners, mid-edge points, face centres, centroid. The determinant is cubic over the tet; its extrema are near these
/// points.
constexpr std::array<Barycentric, 15> samples = [] {
    std::array<Barycentric, 15> points{};
    for (std::size_t k = 0; k < 4; ++k) points[k][k] = 1;
    for (std::size_t e = 0; e < 6; ++e) {
        for (const int corner : edge_corners[e]) points[4 + e][static_cast<std::size_t>(corner)] = 0.5;
    }
    for (std::size_t f = 0; f < 4; ++f) {
        for (const int corner : face_corners[f]) points[10 + f][static_cast<std::size_t>(corner)] = 1.0 / 3;
    }
    points[14] = {0.25, 0.25, 0.25, 0.25};
    return points;
}();

double jacobian(const TetMesh& mesh, std::size_t t, const Barycentric& b) {
    const auto column = curved_derivative(nodes_of(mesh, t), b);
    return dot(column[1] - column[0], cross(column[2] - column[0], column[3] - column[0]));
}

}  // namespace

double worst_scaled_jacobian(const TetMesh& mesh, std::size_t t) {
    const auto n = mesh.tet(t);
    const double straight =
        6 * signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
    double worst = std::numeric_limits<double>::infinity();
    for (const Barycentric& b : samples) worst = std::min(worst, jacobian(mesh, t, b));
    return worst / straight;
}

/// The determinant is cubic: a rule of degree 3 with five points is exact (Zienkiewicz, The Finite Element Method).
double curved_volume(const TetMesh& mesh, std::size_t t) {
    if (mesh.order == 1) {
        const auto n = mesh.tet(t);
        return signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
    }
    constexpr double in_the_middle = -4.0 / 5, near_a_corner = 9.0 / 20;
    double sum = in_the_middle * jacobian(mesh, t, {0.25, 0.25, 0.25, 0.25});
    for (std::size_t k = 0; k < 4; ++k) {
        Barycentric b = {1.0 / 6, 1.0 / 6, 1.0 / 6, 1.0 / 6};
        b[k] = 0.5;
        sum += near_a_corner * jacobian(mesh, t, b);
    }
    return sum / 6;
}

std::size_t straighten_folded_tets(TetMesh& mesh, double least) {
    std::size_t moved = 0;
    // Moving a node for one tet can fold its neighbour; every round moves a node permanently, so this terminates.
    for (bool again = true; again;) {
        again = false;
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            if (worst_scaled_jacobian(mesh, t) >= least) continue;
            const auto n = mesh.tet(t);
            for (std::size_t e = 0; e < 6; ++e) {
                // All tets on the edge must compute identical midpoints: sort the corners.
                const auto [low, high] = std::minmax(n[edge_corners[e][0]], n[edge_corners[e][1]]);
                const Vec3 middle = 0.5 * (mesh.points[low] + mesh.points[high]);
                if (mesh.points[n[4 + e]] == middle) continue;
                mesh.points[n[4 + e]] = middle;
                ++moved;
                again = true;
            }
        }
    }
    return moved;
}

}  // namespace pliant::mesh
