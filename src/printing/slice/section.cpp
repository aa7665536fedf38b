#include "printing/slice/section.hpp"

#include <algorithm>

namespace pliant::slice {
namespace {

struct Crossing {
    double x, y;
};

/// Intersection of the edge with the plane; `below.z < plane <= above.z`.
Crossing cross_edge(const GridPoint& below, const GridPoint& above, std::int64_t plane) {
    const double up = static_cast<double>(plane - below.z);
    const double height = static_cast<double>(std::int64_t{above.z} - below.z);
    const auto at = [&](std::int32_t from, std::int32_t to) {
        return from + static_cast<double>(std::int64_t{to} - from) * up / height;
    };
    return {at(below.x, above.x), at(below.y, above.y)};
}

/// Calls `visit(node)` for the fewest nodes that together cover leaves [first, end).
template <class Visit>
void cover(std::size_t leaves, std::size_t first, std::size_t end, const Visit& visit) {
    for (first += leaves, end += leaves; first < end; first /= 2, end /= 2) {
        if (first % 2 == 1) visit(first++);
        if (end % 2 == 1) visit(--end);
    }
}

}  // namespace

Sectioner::Sectioner(GridSurface surface, Layers layers) : surface_(std::move(surface)), layers_(std::move(layers)) {
    for (const Triangle& t : surface_.triangles) {
        const auto [low, high] = crossed(t);
        if (low < high) layer_count_ = std::max(layer_count_, high);
    }
    plant_tree();
}

/// The layers [low, high) whose planes a triangle crosses.
std::pair<int, int> Sectioner::crossed(const Triangle& t) const {
    const auto [low, high] = std::minmax({surface_.points[t[0]].z, surface_.points[t[1]].z, surface_.points[t[2]].z});
    return {layers_.middles_up_to(low, grid_per_um), layers_.middles_up_to(high, grid_per_um)};
}

void Sectioner::plant_tree() {
    while (leaves_ < static_cast<std::size_t>(layer_count_)) leaves_ *= 2;
    node_starts_.assign(2 * leaves_ + 1, 0);
    const auto each_node = [&](std::size_t i, const auto& visit) {
        const auto [low, high] = crossed(surface_.triangles[i]);
        cover(leaves_, static_cast<std::size_t>(low), static_cast<std::size_t>(high), visit);
    };
    for (std::size_t i = 0; i < surface_.triangles.size(); ++i)
        each_node(i, [&](std::size_t node) { ++node_starts_[node + 1]; });
    for (std::size_t n = 1; n < node_starts_.size(); ++n) node_starts_[n] += node_starts_[n - 1];
    listed_.resize(node_starts_.back());
    std::vector<std::uint32_t> next(node_starts_.begin(), node_starts_.end() - 1);
    for (std::size_t i = 0; i < surface_.triangles.size(); ++i)
        each_node(i, [&](std::size_t node) { listed_[next[node]++] = static_cast<int>(i); });
}

void Sectioner::cut(const Triangle& t, std::int64_t plane, std::vector<Segment>& segments) const {
    std::array<bool, 3> above{};
    for (std::size_t i = 0; i < 3; ++i) above[i] = surface_.points[t[i]].z >= plane;
    if (above[0] == above[1] && above[1] == above[2]) return;
    // With the solid behind the triangle, its boundary crosses the plane downwards at the segment's start and upwards
    // at its end.
    Crossing start{}, end{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const GridPoint &p = surface_.points[t[i]], &q = surface_.points[t[j]];
        if (above[i] && !above[j]) start = cross_edge(q, p, plane);
        if (!above[i] && above[j]) end = cross_edge(p, q, plane);
    }
    segments.push_back({start.x, start.y, end.x, end.y});
}

void Sectioner::section(int layer, std::vector<Segment>& segments) const {
    if (layer < 0 || layer >= layer_count_) return;
    const std::int64_t z = plane(layer);
    for (std::size_t node = static_cast<std::size_t>(layer) + leaves_; node > 0; node /= 2) {
        for (std::uint32_t i = node_starts_[node]; i < node_starts_[node + 1]; ++i)
            cut(surface_.triangles[listed_[i]], z, segments);
    }
}

}  // namespace pliant::slice
