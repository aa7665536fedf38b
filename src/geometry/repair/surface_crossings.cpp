#include "geometry/repair/surface_crossings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/core/box_tree.hpp"
#include "base/core/boxes.hpp"

namespace pliant::mesh {
namespace {

constexpr double touching_share = 1e-7;  // of a height or of an edge: smaller distances count as touching

struct Corners {
    std::array<Vec3, 3> p;
    std::array<int, 3> node;
    Box3 box;
};

bool has_node(const Corners& t, int node) {
    return std::find(t.node.begin(), t.node.end(), node) != t.node.end();
}

/// True if the edge a-b meets a triangle.
bool passes(const Vec3& a, const Vec3& b, const std::array<Vec3, 3>& t) {
    const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
    const double reach = touching_share * norm(n) * std::max({norm(b - a), norm(t[1] - t[0]), norm(t[2] - t[0])});
    const double da = dot(n, a - t[0]);
    const double db = dot(n, b - t[0]);
    if ((da > reach && db > reach) || (da < -reach && db < -reach)) return false;
    if (std::fabs(da - db) <= 2 * reach) return false;  // in the plane: detected by the other triangle's edges
    const Vec3 p = a + std::clamp(da / (da - db), 0.0, 1.0) * (b - a);
    const double twice = dot(n, n);
    for (std::size_t k = 0; k < 3; ++k) {
        const double share = dot(n, cross(t[(k + 1) % 3] - t[k], p - t[k])) / twice;
        if (share < -touching_share) return false;
    }
    return true;
}

/// Tests the edges of one that have no corner in the other against the other.
bool edges_pass(const Corners& one, const Corners& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        if (has_node(other, one.node[k]) || has_node(other, one.node[next])) continue;
        if (passes(one.p[k], one.p[next], other.p)) return true;
    }
    return false;
}

Vec3 normal(const Corners& t) {
    return unit(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
}

/// Two triangles with a common edge, less than half a degree apart.
bool folded(const Corners& one, const Corners& other) {
    return dot(normal(one), normal(other)) < -0.99996;
}

/// Two coplanar triangles with overlapping interiors.
bool overlap(const Corners& one, const Corners& other) {
    const Vec3 n = normal(one);
    const double size = norm(one.box.size()) + norm(other.box.size());
    for (const Vec3& p : other.p) {
        if (std::fabs(dot(n, p - one.p[0])) > touching_share * size) return false;
    }
    for (const Corners* t : {&one, &other}) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 across = unit(cross(t->p[(k + 1) % 3] - t->p[k], n));
            const auto reach = [&](const Corners& of) {
                const std::array<double, 3> d = {dot(across, of.p[0]), dot(across, of.p[1]), dot(across, of.p[2])};
                return std::pair(*std::min_element(d.begin(), d.end()), *std::max_element(d.begin(), d.end()));
            };
            const auto [low, high] = reach(one);
            const auto [from, to] = reach(other);
            if (std::min(high, to) - std::max(low, from) < 1e-5 * size) return false;
        }
    }
    return true;
}

bool meet(const Corners& one, const Corners& other) {
    if (!boxes_meet(one.box, other.box)) return false;
    const auto common = std::count_if(one.node.begin(), one.node.end(), [&](int n) { return has_node(other, n); });
    if (common >= 2) return folded(one, other);
    return edges_pass(one, other) || edges_pass(other, one) || overlap(one, other);
}

}  // namespace

bool cuts_itself(const TriMesh& surface) {
    std::vector<Corners> triangles;
    std::vector<Bounds> boxes;
    for (const auto& nodes : surface.triangles) {
        Corners t{{}, nodes, {}};
        Bounds around;
        for (std::size_t k = 0; k < 3; ++k) {
            t.p[k] = surface.points[static_cast<std::size_t>(nodes[k])];
            t.box.add(t.p[k]);
            around.add(t.p[k]);
        }
        triangles.push_back(t);
        boxes.push_back(around);
    }
    const BoxTree tree(boxes);
    const BoxTree::Fit fit = tree.fit(boxes);
    // Of each pair the one that begins farther along the surface is tested first, because rounding may give them
    // different results.
    const std::size_t axis = longest_axis(bounds(surface));
    const auto begins = [&](int t) { return std::pair(triangles[static_cast<std::size_t>(t)].box.low[axis], t); };
    bool found = false;
    for (std::size_t leaf = 0; leaf < tree.leaf_count() && !found; ++leaf) {
        tree.visit_overlaps(fit, leaf, tree, fit, [&](int i, int j) {
            if (begins(i) < begins(j)) std::swap(i, j);
            found = found || meet(triangles[static_cast<std::size_t>(i)], triangles[static_cast<std::size_t>(j)]);
        });
    }
    return found;
}

double finest_detail(const TriMesh& surface) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : surface.triangles) {
        const auto at = [&](int n) { return surface.points[static_cast<std::size_t>(n)]; };
        const Vec3 a = at(j) - at(i);
        const Vec3 b = at(k) - at(i);
        least = std::min(least, norm(cross(a, b)) / std::max({norm(a), norm(b), norm(b - a)}));
    }
    return least / bounds(surface).diagonal();
}

}  // namespace pliant::mesh
