#include "robot/bodies/passage.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace pliant::robot {
namespace {

/// The share [begin, end] of the segment from a to b inside a tet; empty if begin >= end.
std::pair<double, double> clip(const std::array<Vec3, 4>& corner, const Vec3& a, const Vec3& b) {
    double begin = 0;
    double end = 1;
    for (const auto& face : mesh::face_corners) {
        const auto at = [&](std::size_t i) { return corner[static_cast<std::size_t>(face[i])]; };
        const Vec3 outward = cross(at(1) - at(0), at(2) - at(0));
        const double from = dot(outward, a - at(0));
        const double to = dot(outward, b - at(0));
        if (from > 0 && to > 0) return {1, 0};
        if (from == to) continue;
        const double crossing = from / (from - to);
        if (to > from)
            end = std::min(end, crossing);
        else
            begin = std::max(begin, crossing);
    }
    return {begin, end};
}

}  // namespace

Passage passage_through(const mesh::TetMesh& mesh, int region, const std::vector<Vec3>& points) {
    Vec3 sum;
    Passage passage;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (mesh.region[t] != region) continue;
        std::array<Vec3, 4> corner;
        for (std::size_t i = 0; i < 4; ++i) corner[i] = mesh.points[static_cast<std::size_t>(mesh.tet(t)[i])];
        for (std::size_t k = 1; k < points.size(); ++k) {
            const auto [begin, end] = clip(corner, points[k - 1], points[k]);
            if (begin >= end) continue;
            const Vec3 way = points[k] - points[k - 1];
            const double length = (end - begin) * norm(way);
            sum += (end - begin) * way;
            passage.center += length * (points[k - 1] + 0.5 * (begin + end) * way);
            passage.length += length;
        }
    }
    if (norm(sum) > 0) passage.direction = unit(sum);
    if (passage.length > 0) passage.center = passage.center / passage.length;
    return passage;
}

}  // namespace pliant::robot
