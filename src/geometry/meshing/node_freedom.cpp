#include "geometry/meshing/node_freedom.hpp"

#include <algorithm>

namespace pliant::mesh {
namespace {

/// Directions of the sharp edges at a node.
std::vector<Vec3> ridges_at(const EditableTets& tets, int v, const std::vector<Border>& all, double smooth) {
    std::vector<Vec3> ridges;
    std::vector<int> seen;
    for (const Border& b : all) {
        for (const int w : b.nodes) {
            if (w == v || std::find(seen.begin(), seen.end(), w) != seen.end()) continue;
            seen.push_back(w);
            std::vector<const Border*> sides;
            for (const Border& other : all) {
                if (std::find(other.nodes.begin(), other.nodes.end(), w) != other.nodes.end()) sides.push_back(&other);
            }
            if (sides.size() == 2 && dot(sides[0]->normal, sides[1]->normal) > smooth) continue;
            ridges.push_back((tets.at(w) - tets.at(v)) / norm(tets.at(w) - tets.at(v)));
        }
    }
    return ridges;
}

bool inside(const EditableTets& tets, const Vec3& p, const Border& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &from = tets.at(b.nodes[k]), &to = tets.at(b.nodes[(k + 1) % 3]);
        if (dot(cross(to - from, p - from), b.normal) < -1e-12 * dot(to - from, to - from)) return false;
    }
    return true;
}

}  // namespace

Freedom freedom_of(const EditableTets& tets, int v, double smooth) {
    const std::vector<Border> all = tets.borders(v);
    if (all.empty()) return {3, {}, false};
    Vec3 sum;
    for (const Border& b : all) sum += b.normal;
    const bool flat = std::all_of(all.begin(), all.end(),
                                  [&](const Border& b) { return dot(b.normal, all.front().normal) > one_plane; });
    if (flat) return {2, all.front().normal, false};
    const std::vector<Vec3> ridges = ridges_at(tets, v, all, smooth);
    if (ridges.empty() && norm(sum) > 0) return {2, unit(sum), true};
    if (ridges.size() == 2 && dot(ridges[0], ridges[1]) < -one_plane) return {1, ridges[0], false};
    return {};
}

std::optional<Vec3> allowed_place(const EditableTets& tets, int v, const Freedom& f, const std::vector<Border>& surface,
                                  const Vec3& step) {
    if (f.dimensions == 3) return tets.at(v) + step;
    if (f.dimensions == 1) return tets.at(v) + dot(step, f.axis) * f.axis;
    const Vec3 level_step = step - dot(step, f.axis) * f.axis;
    if (!f.curved) return tets.at(v) + level_step;
    for (const Border& b : surface) {
        const double along = dot(b.normal, f.axis);
        if (!(along > 0.1)) continue;
        // Projects onto the plane of the triangle, along the axis.
        const Vec3 p = tets.at(v) + level_step - (dot(level_step, b.normal) / along) * f.axis;
        if (inside(tets, p, b)) return p;
    }
    return std::nullopt;
}

}  // namespace pliant::mesh
