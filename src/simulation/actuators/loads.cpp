#include "simulation/actuators/loads.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace pliant::sim {
namespace {

/// A point of the integration rule on a face, with the shape functions and their derivatives along b1 and b2, where
/// b0 = 1 - b1 - b2.
struct FaceSample {
    double weight;  ///< sum 1/2, the area of the reference triangle
    std::array<double, 6> N{};
    std::array<std::array<double, 2>, 6> dN{};
};

FaceSample linear_sample() {
    constexpr double third = 1.0 / 3;
    FaceSample s{0.5};
    s.N = {third, third, third};
    s.dN = {{{-1, -1}, {1, 0}, {0, 1}}};
    return s;
}

FaceSample quadratic_sample(std::size_t q) {
    FaceSample s{1.0 / 6};
    std::array<double, 3> b = {1.0 / 6, 1.0 / 6, 1.0 / 6};
    b[q] = 2.0 / 3;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        s.N[i] = b[i] * (2 * b[i] - 1);
        s.N[3 + i] = 4 * b[i] * b[j];
        for (std::size_t k = 0; k < 2; ++k) {
            const double di = (i == k + 1 ? 1 : 0) - (i == 0 ? 1 : 0);
            const double dj = (j == k + 1 ? 1 : 0) - (j == 0 ? 1 : 0);
            s.dN[i][k] = (4 * b[i] - 1) * di;
            s.dN[3 + i][k] = 4 * (b[j] * di + b[i] * dj);
        }
    }
    return s;
}

/// One point on a flat face; three, a rule of degree 2, on one of six nodes, which may be curved.
const std::vector<FaceSample>& face_samples(int order) {
    static const std::vector<FaceSample> one = {linear_sample()};
    static const std::vector<FaceSample> three = {quadratic_sample(0), quadratic_sample(1), quadratic_sample(2)};
    return order == 2 ? three : one;
}

/// The tangents of a face at a sample; also of a motion of its nodes.
template <class At>
std::array<Vec3, 2> tangents(const mesh::Face& face, const FaceSample& s, std::size_t count, const At& at) {
    std::array<Vec3, 2> sum;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < 2; ++k) sum[k] += s.dN[i][k] * at(face.nodes[i]);
    }
    return sum;
}

/// Calls visit(face, sample, u, v) with the tangents at every sample of every face.
template <class Visit>
void visit_samples(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces, const Visit& visit) {
    const std::size_t count = mesh.order == 2 ? 6 : 3;
    const auto at = [&](int node) { return mesh.points[static_cast<std::size_t>(node)]; };
    for (const mesh::Face& face : faces) {
        for (const FaceSample& s : face_samples(mesh.order)) {
            const auto [u, v] = tangents(face, s, count, at);
            visit(face, s, count, u, v);
        }
    }
}

}  // namespace

SurfaceShares surface_shares(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces) {
    std::map<int, double> weight;
    visit_samples(mesh, faces,
                  [&](const mesh::Face& face, const FaceSample& s, std::size_t count, const Vec3& u, const Vec3& v) {
                      const double area = s.weight * norm(cross(u, v));
                      for (std::size_t i = 0; i < count; ++i) weight[face.nodes[i]] += s.N[i] * area;
                  });
    SurfaceShares result;
    for (const auto& [node, w] : weight) result.area_m2 += w;
    for (const auto& [node, w] : weight) {
        result.nodes.push_back(node);
        result.shares.push_back(w / result.area_m2);
    }
    return result;
}

std::vector<double> share_rates(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces,
                                std::span<const double> motion) {
    const SurfaceShares now = surface_shares(mesh, faces);
    const auto moved = [&](int node) {
        const double* m = motion.data() + 3 * static_cast<std::size_t>(node);
        return Vec3{m[0], m[1], m[2]};
    };
    std::map<int, double> rate;  // of each node's part of the area
    double total = 0;
    visit_samples(mesh, faces,
                  [&](const mesh::Face& face, const FaceSample& s, std::size_t count, const Vec3& u, const Vec3& v) {
                      const auto [du, dv] = tangents(face, s, count, moved);
                      const double area = s.weight * dot(unit(cross(u, v)), cross(du, v) + cross(u, dv));
                      for (std::size_t i = 0; i < count; ++i) rate[face.nodes[i]] += s.N[i] * area;
                      total += area;
                  });
    std::vector<double> rates;
    for (std::size_t i = 0; i < now.nodes.size(); ++i)
        rates.push_back((rate[now.nodes[i]] - now.shares[i] * total) / now.area_m2);
    return rates;
}

void add_share_gradient(const mesh::TetMesh& mesh, std::span<const mesh::Face> faces, std::span<const double> worth,
                        std::span<double> gradient) {
    const SurfaceShares now = surface_shares(mesh, faces);
    double mean = 0;
    for (std::size_t i = 0; i < now.nodes.size(); ++i) mean += worth[i] * now.shares[i];
    const auto worth_of = [&](int node) {
        return worth[static_cast<std::size_t>(std::ranges::lower_bound(now.nodes, node) - now.nodes.begin())];
    };
    visit_samples(mesh, faces,
                  [&](const mesh::Face& face, const FaceSample& s, std::size_t count, const Vec3& u, const Vec3& v) {
                      double here = -mean;
                      for (std::size_t i = 0; i < count; ++i) here += s.N[i] * worth_of(face.nodes[i]);
                      const Vec3 n = unit(cross(u, v));
                      const Vec3 by_u = cross(v, n), by_v = cross(n, u);
                      for (std::size_t i = 0; i < count; ++i) {
                          const Vec3 g = (s.weight * here / now.area_m2) * (s.dN[i][0] * by_u + s.dN[i][1] * by_v);
                          double* to = gradient.data() + 3 * static_cast<std::size_t>(face.nodes[i]);
                          for (std::size_t c = 0; c < 3; ++c) to[c] += g[c];
                      }
                  });
}

}  // namespace pliant::sim
