#include "mesh/surface_seams.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

#include "core/disjoint_sets.hpp"

namespace pliant::mesh {
namespace {

/// Of the surface's size: 32 bits hold 6e-8 of a coordinate, and what was reckoned before added to that.
constexpr double rounding = 1e-6;

std::vector<int> ends_of(const std::vector<BorderEdge>& edges) {
    std::vector<int> points;
    for (const BorderEdge& edge : edges) {
        points.push_back(edge.from);
        points.push_back(edge.to);
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    return points;
}

/// Points that share a box of side `reach`, in one grid or in one that is shifted by half a box along some axes: so all
/// that are within half of it.
DisjointSets joined(const TriMesh& surface, const std::vector<int>& points, double reach) {
    DisjointSets sets(surface.points.size());
    const Vec3 low = bounds(surface).low;
    std::vector<std::pair<std::array<std::int64_t, 3>, int>> boxes(points.size());
    for (unsigned shift = 0; shift < 8; ++shift) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            boxes[i].second = points[i];
            const Vec3 from = surface.points[static_cast<std::size_t>(points[i])] - low;
            for (std::size_t k = 0; k < 3; ++k) {
                const double half = (shift >> k & 1) != 0 ? 0.5 : 0.0;
                boxes[i].first[k] = static_cast<std::int64_t>(std::floor(from[k] / reach + half));
            }
        }
        std::sort(boxes.begin(), boxes.end());
        for (std::size_t i = 1; i < boxes.size(); ++i) {
            if (boxes[i].first == boxes[i - 1].first) sets.join(boxes[i - 1].second, boxes[i].second);
        }
    }
    return sets;
}

}  // namespace

std::vector<BorderEdge> border_edges(const TriMesh& surface) {
    std::vector<std::array<int, 3>> ways;  // from, to, and which way
    ways.reserve(3 * surface.triangles.size());
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = t[k];
            const int b = t[(k + 1) % 3];
            if (a != b) ways.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
        }
    }
    std::sort(ways.begin(), ways.end());
    std::vector<BorderEdge> border;
    for (std::size_t i = 0; i < ways.size();) {
        int sum = 0;
        const auto [low, high, way] = ways[i];
        for (; i < ways.size() && ways[i][0] == low && ways[i][1] == high; ++i) sum += ways[i][2];
        if (sum > 0) border.push_back({low, high, sum});
        if (sum < 0) border.push_back({high, low, -sum});
    }
    return border;
}

TriMesh border_caps(const TriMesh& surface) {
    const std::vector<BorderEdge> border = border_edges(surface);
    DisjointSets pieces(surface.points.size());
    for (const BorderEdge& edge : border) pieces.join(edge.from, edge.to);
    TriMesh caps{surface.points, {}};
    std::unordered_map<int, Box3> around;  // of each piece
    for (const BorderEdge& edge : border)
        around[pieces.find(edge.from)].add(surface.points[static_cast<std::size_t>(edge.from)]);
    std::unordered_map<int, int> middle;
    for (const BorderEdge& edge : border) {
        const int piece = pieces.find(edge.from);
        const auto [entry, fresh] = middle.try_emplace(piece, static_cast<int>(caps.points.size()));
        if (fresh) caps.points.push_back(around[piece].center());
        for (int i = 0; i < edge.times; ++i) caps.triangles.push_back({edge.to, edge.from, entry->second});
    }
    return caps;
}

std::size_t close_seams(TriMesh& surface) {
    const std::vector<BorderEdge> before = border_edges(surface);
    const double reach = 2 * rounding * bounds(surface).diagonal();
    if (before.empty() || !(reach > 0)) return 0;
    DisjointSets sets = joined(surface, ends_of(before), reach);
    TriMesh closed{surface.points, {}};
    for (const auto& t : surface.triangles) {
        const std::array<int, 3> corners{sets.find(t[0]), sets.find(t[1]), sets.find(t[2])};
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            closed.triangles.push_back(corners);
    }
    const std::size_t after = border_edges(closed).size();
    if (after >= before.size()) return 0;
    surface = std::move(closed);
    return before.size() - after;
}

}  // namespace pliant::mesh
