#include "simulation/actuators/loads.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "simulation/actuators/face_sample.hpp"

namespace pliant::sim {
namespace {

/// One point on a flat face; three, a rule of degree 2, on one of six nodes, which may be curved.
const std::vector<FaceSample>& face_samples(int order) {
    constexpr double third = 1.0 / 3, sixth = 1.0 / 6;
    static const std::vector<FaceSample> one = {linear_sample(0.5, {third, third, third})};
    static const std::vector<FaceSample> three = {quadratic_sample(sixth, {2 * third, sixth, sixth}),
                                                  quadratic_sample(sixth, {sixth, 2 * third, sixth}),
                                                  quadratic_sample(sixth, {sixth, sixth, 2 * third})};
    return order == 2 ? three : one;
}

/// The tangents of a face at a sample; also of a motion of its nodes.
template <class At>
std::array<Vec3, 2> tangents(const mesh::Face& face, const FaceSample& s, std::size_t count, const At& at) {
    std::array<Vec3, 2> sum;
    for (std::size_t i = 0; i < count; ++i) {
        sum[0] += s.Nu[i] * at(face.nodes[i]);
        sum[1] += s.Nv[i] * at(face.nodes[i]);
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
                          const Vec3 g = (s.weight * here / now.area_m2) * (s.Nu[i] * by_u + s.Nv[i] * by_v);
                          double* to = gradient.data() + 3 * static_cast<std::size_t>(face.nodes[i]);
                          for (std::size_t c = 0; c < 3; ++c) to[c] += g[c];
                      }
                  });
}

}  // namespace pliant::sim
