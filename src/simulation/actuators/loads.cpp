#include "simulation/actuators/loads.hpp"

#include <array>
#include <map>

namespace pliant::sim {
namespace {

/// Adds the integral of every shape function over a linear face.
void add_linear(const mesh::TetMesh& mesh, const mesh::Face& face, std::map<int, double>& weight) {
    const auto& p = mesh.points;
    const Vec3 normal = cross(p[face.nodes[1]] - p[face.nodes[0]], p[face.nodes[2]] - p[face.nodes[0]]);
    for (int i = 0; i < 3; ++i) weight[face.nodes[i]] += norm(normal) / 6;
}

/// The same over a six-node face, which may be curved: three-point rule of degree 2.
void add_quadratic(const mesh::TetMesh& mesh, const mesh::Face& face, std::map<int, double>& weight) {
    for (int q = 0; q < 3; ++q) {
        std::array<double, 3> b = {1.0 / 6, 1.0 / 6, 1.0 / 6};
        b[q] = 2.0 / 3;
        std::array<double, 6> N{};
        std::array<std::array<double, 2>, 6> dN{};  // along b1 and b2, with b0 = 1 - b1 - b2
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            N[i] = b[i] * (2 * b[i] - 1);
            N[3 + i] = 4 * b[i] * b[j];
            for (int k = 0; k < 2; ++k) {
                const double di = (i == k + 1 ? 1 : 0) - (i == 0 ? 1 : 0);
                const double dj = (j == k + 1 ? 1 : 0) - (j == 0 ? 1 : 0);
                dN[i][k] = (4 * b[i] - 1) * di;
                dN[3 + i][k] = 4 * (b[j] * di + b[i] * dj);
            }
        }
        Vec3 u;
        Vec3 v;
        for (int i = 0; i < 6; ++i) {
            u += dN[i][0] * mesh.points[face.nodes[i]];
            v += dN[i][1] * mesh.points[face.nodes[i]];
        }
        for (int i = 0; i < 6; ++i) weight[face.nodes[i]] += N[i] * norm(cross(u, v)) / 6;
    }
}

}  // namespace

SurfaceShares surface_shares(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces) {
    std::map<int, double> weight;
    for (const mesh::Face& face : faces) {
        mesh.order == 2 ? add_quadratic(mesh, face, weight) : add_linear(mesh, face, weight);
    }
    SurfaceShares result;
    for (const auto& [node, w] : weight) result.area_m2 += w;
    for (const auto& [node, w] : weight) {
        result.nodes.push_back(node);
        result.shares.push_back(w / result.area_m2);
    }
    return result;
}

}  // namespace pliant::sim
