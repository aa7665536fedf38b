#include "geometry/repair/surface_seams.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "base/core/disjoint_sets.hpp"

namespace pliant::mesh {
namespace {

/// As a fraction of the surface's size: 32-bit floats have an error of 6e-8, plus that of earlier computations.
constexpr double float_rounding = 1e-6;

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

/// A grid of boxes of twice the reach, so that all points within reach of a place are in one of eight boxes.
class NearPoints {
public:
    /// Space for `count` points of the surface, to be added.
    NearPoints(const TriMesh& surface, double reach, std::size_t count)
        : surface_(surface), low_(bounds(surface).low), reach_(reach), next_(surface.points.size(), -1) {
        first_.reserve(count);
    }

    void add(int point) {
        const auto [entry, fresh] = first_.try_emplace(key(boxes_of(at(point), 0)), point);
        if (fresh) return;
        next_[static_cast<std::size_t>(point)] = entry->second;
        entry->second = point;
    }
    /// Calls `visit` for all points within reach of a point, including itself.
    template <class Visit>
    void each_near(int point, const Visit& visit) const {
        const Box near_low = boxes_of(at(point), -reach_);
        const Box near_high = boxes_of(at(point), reach_);
        for (std::int64_t x = near_low[0]; x <= near_high[0]; ++x) {
            for (std::int64_t y = near_low[1]; y <= near_high[1]; ++y) {
                for (std::int64_t z = near_low[2]; z <= near_high[2]; ++z) visit_box({x, y, z}, point, visit);
            }
        }
    }

private:
    using Box = std::array<std::int64_t, 3>;

    [[nodiscard]] const Vec3& at(int point) const { return surface_.points[static_cast<std::size_t>(point)]; }
    [[nodiscard]] Box boxes_of(const Vec3& p, double aside) const {
        Box box{};
        for (std::size_t k = 0; k < 3; ++k)
            box[k] = static_cast<std::int64_t>(std::floor(std::min((p[k] - low_[k] + aside) / (2 * reach_), 1e15)));
        return box;
    }
    /// Boxes with the same key are told apart by the distances.
    static std::uint64_t key(const Box& box) {
        std::uint64_t h = 0;
        for (const std::int64_t k : box) h = (h ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15U, h ^= h >> 29;
        return h;
    }
    template <class Visit>
    void visit_box(const Box& box, int point, const Visit& visit) const {
        const auto found = first_.find(key(box));
        if (found == first_.end()) return;
        for (int other = found->second; other >= 0; other = next_[static_cast<std::size_t>(other)]) {
            if (norm(at(other) - at(point)) <= reach_) visit(other);
        }
    }

    const TriMesh& surface_;
    Vec3 low_;
    double reach_;
    std::unordered_map<std::uint64_t, int> first_;
    std::vector<int> next_;  ///< (points) next one in the same box
};

/// The new index of each point: the first of `points`, in ascending order, within reach of it.
std::vector<int> joined(const TriMesh& surface, const std::vector<int>& points, double reach) {
    std::vector<int> becomes(surface.points.size());
    std::iota(becomes.begin(), becomes.end(), 0);
    NearPoints near(surface, reach, points.size());
    for (const int point : points) near.add(point);
    std::vector<bool> taken(surface.points.size(), false);
    for (const int point : points) {
        if (taken[static_cast<std::size_t>(point)]) continue;
        near.each_near(point, [&](int other) {
            if (taken[static_cast<std::size_t>(other)]) return;
            taken[static_cast<std::size_t>(other)] = true;
            becomes[static_cast<std::size_t>(other)] = point;
        });
    }
    return becomes;
}

/// For each edge, how many triangles run from its lower to its higher end minus how many run back; edges are sorted by
/// lower, then higher ends. Counting sort by the lower ends, then within each: an end has only a few edges.
template <class Visit>
void each_edge(const TriMesh& surface, const Visit& visit) {
    std::vector<std::uint32_t> ends(surface.points.size() + 1, 0);
    const auto each_side = [&](const auto& take) {
        for (const auto& t : surface.triangles) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (t[k] != t[(k + 1) % 3]) take(t[k], t[(k + 1) % 3]);
            }
        }
    };
    each_side([&](int a, int b) { ++ends[static_cast<std::size_t>(std::min(a, b)) + 1]; });
    for (std::size_t p = 1; p < ends.size(); ++p) ends[p] += ends[p - 1];
    std::vector<std::pair<int, int>> ways(ends.back());  // the higher end, and the direction
    each_side([&](int a, int b) {
        ways[ends[static_cast<std::size_t>(std::min(a, b))]++] = {std::max(a, b), a < b ? 1 : -1};
    });
    std::uint32_t i = 0;
    for (std::size_t low = 0; low + 1 < ends.size(); ++low) {  // each start was advanced to the end of its ways
        std::sort(ways.begin() + i, ways.begin() + ends[low]);
        while (i < ends[low]) {
            const int high = ways[i].first;
            int sum = 0;
            for (; i < ends[low] && ways[i].first == high; ++i) sum += ways[i].second;
            visit(static_cast<int>(low), high, sum);
        }
    }
}

TriMesh without_unused_points(const TriMesh& surface, const std::vector<std::array<int, 3>>& triangles) {
    std::vector<int> index(surface.points.size(), -1);
    for (const auto& t : triangles) {
        for (const int corner : t) index[static_cast<std::size_t>(corner)] = 0;
    }
    TriMesh result;
    for (std::size_t p = 0; p < index.size(); ++p) {
        if (index[p] < 0) continue;
        index[p] = static_cast<int>(result.points.size());
        result.points.push_back(surface.points[p]);
    }
    const auto place = [&](int corner) { return index[static_cast<std::size_t>(corner)]; };
    for (const auto& t : triangles) result.triangles.push_back({place(t[0]), place(t[1]), place(t[2])});
    return result;
}

}  // namespace

std::vector<BorderEdge> border_edges(const TriMesh& surface) {
    std::vector<BorderEdge> border;
    each_edge(surface, [&](int low, int high, int sum) {
        if (sum > 0) border.push_back({low, high, sum});
        if (sum < 0) border.push_back({high, low, -sum});
    });
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

ClosedSeams close_seams(TriMesh& surface, double reach) {
    const std::vector<BorderEdge> before = border_edges(surface);
    if (before.empty() || !(reach > 0)) return {};
    const std::vector<int> points = ends_of(before);
    const std::vector<int> becomes = joined(surface, points, reach);
    const auto place = [&](int corner) { return becomes[static_cast<std::size_t>(corner)]; };
    TriMesh closed{surface.points, {}};
    for (const auto& t : surface.triangles) {
        const std::array<int, 3> corners{place(t[0]), place(t[1]), place(t[2])};
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
            closed.triangles.push_back(corners);
    }
    const std::size_t after = border_edges(closed).size();
    if (after >= before.size() || closed.triangles.empty()) return {};
    surface = without_unused_points(surface, closed.triangles);
    const auto moved = std::count_if(points.begin(), points.end(), [&](int p) { return place(p) != p; });
    return {before.size() - after, static_cast<std::size_t>(moved)};
}

ClosedSeams close_seams(TriMesh& surface) {
    return close_seams(surface, float_rounding * bounds(surface).diagonal());
}

}  // namespace pliant::mesh
