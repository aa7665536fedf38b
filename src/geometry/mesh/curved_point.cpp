#include "geometry/mesh/curved_point.hpp"

#include "geometry/mesh/nearest_in_simplex.hpp"

namespace pliant::mesh {
namespace {

using Barycentric = std::array<double, 4>;

constexpr int most_steps = 40;
constexpr int most_halvings = 30;

/// Interpolates between two points of the simplex.
Barycentric between(const Barycentric& from, const Barycentric& to, double share) {
    Barycentric b{};
    for (std::size_t k = 0; k < 4; ++k) b[k] = from[k] + share * (to[k] - from[k]);
    return b;
}

/// The corners of the straight tet tangent to the map at `b`.
std::array<Vec3, 4> tangent_tet(const TetNodes& nodes, const Barycentric& b) {
    const auto column = curved_derivative(nodes, b);
    Vec3 origin = curved_position(nodes, b);
    for (std::size_t k = 0; k < 4; ++k) origin -= b[k] * column[k];
    std::array<Vec3, 4> corner;
    for (std::size_t k = 0; k < 4; ++k) corner[k] = origin + column[k];
    return corner;
}

/// Steps from `b` as long as each reduces the distance.
CurvedPoint descend(const TetNodes& nodes, const Vec3& p, const Barycentric& b) {
    CurvedPoint at{b, norm(curved_position(nodes, b) - p)};
    for (int step = 0; step < most_steps && at.distance > 0; ++step) {
        const Barycentric target = nearest_weights(tangent_tet(nodes, at.barycentric), p);
        bool nearer = false;
        double share = 1;
        for (int k = 0; k < most_halvings && !nearer; ++k, share *= 0.5) {
            const Barycentric next = between(at.barycentric, target, share);
            const double distance = norm(curved_position(nodes, next) - p);
            if (!(distance < at.distance)) continue;
            at = {next, distance};
            nearer = true;
        }
        if (!nearer) break;
    }
    return at;
}

}  // namespace

TetNodes nodes_of(const TetMesh& mesh, std::size_t tet) {
    const auto n = mesh.tet(tet);
    TetNodes nodes;
    for (std::size_t a = 0; a < n.size(); ++a) nodes[a] = mesh.points[n[a]];
    for (std::size_t e = 0; mesh.order == 1 && e < 6; ++e)
        nodes[4 + e] = 0.5 * (mesh.points[n[edge_corners[e][0]]] + mesh.points[n[edge_corners[e][1]]]);
    return nodes;
}

Vec3 curved_position(const TetNodes& nodes, const Barycentric& b) {
    Vec3 sum;
    for (std::size_t k = 0; k < 4; ++k) sum += b[k] * (2 * b[k] - 1) * nodes[k];
    for (std::size_t e = 0; e < 6; ++e) {
        const auto [i, j] = edge_corners[e];
        sum += 4 * b[static_cast<std::size_t>(i)] * b[static_cast<std::size_t>(j)] * nodes[4 + e];
    }
    return sum;
}

std::array<Vec3, 4> curved_derivative(const TetNodes& nodes, const Barycentric& b) {
    std::array<Vec3, 4> column;
    for (std::size_t k = 0; k < 4; ++k) column[k] = (4 * b[k] - 1) * nodes[k];
    for (std::size_t e = 0; e < 6; ++e) {
        const auto i = static_cast<std::size_t>(edge_corners[e][0]);
        const auto j = static_cast<std::size_t>(edge_corners[e][1]);
        column[i] += 4 * b[j] * nodes[4 + e];
        column[j] += 4 * b[i] * nodes[4 + e];
    }
    return column;
}

Box3 curved_bounds(const TetNodes& nodes) {
    Box3 box;
    for (std::size_t k = 0; k < 4; ++k) box.add(nodes[k]);
    for (std::size_t e = 0; e < 6; ++e) {
        const auto i = static_cast<std::size_t>(edge_corners[e][0]);
        const auto j = static_cast<std::size_t>(edge_corners[e][1]);
        box.add(2 * nodes[4 + e] - 0.5 * (nodes[i] + nodes[j]));
    }
    return box;
}

CurvedPoint nearest_in_curved_tet(const TetNodes& nodes, const Vec3& p) {
    const std::array<Vec3, 4> corner = {nodes[0], nodes[1], nodes[2], nodes[3]};
    CurvedPoint best = descend(nodes, p, nearest_weights(corner, p));
    const double inside = 1e-13 * curved_bounds(nodes).diagonal();
    if (best.distance <= inside) return best;
    // On a face that bulges inwards descent may end in a local minimum: try other starts, too.
    std::array<Barycentric, 5> starts{};
    starts[0] = {0.25, 0.25, 0.25, 0.25};
    for (std::size_t f = 0; f < 4; ++f) {
        for (const int k : face_corners[f]) starts[1 + f][static_cast<std::size_t>(k)] = 1.0 / 3;
    }
    for (const Barycentric& start : starts) {
        const CurvedPoint other = descend(nodes, p, start);
        if (other.distance < best.distance) best = other;
        if (best.distance <= inside) break;
    }
    return best;
}

}  // namespace pliant::mesh
