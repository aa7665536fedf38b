#include "slice/section.hpp"

#include <algorithm>

namespace pliant::slice {
namespace {

constexpr int block_layers = 32;

struct Crossing {
    double x, y;
};

/// Where the edge meets the plane; `below.z < plane <= above.z`.
Crossing cross_edge(const GridPoint& below, const GridPoint& above, std::int64_t plane) {
    const double up = static_cast<double>(plane - below.z);
    const double height = static_cast<double>(std::int64_t{above.z} - below.z);
    const auto at = [&](std::int32_t from, std::int32_t to) {
        return from + static_cast<double>(std::int64_t{to} - from) * up / height;
    };
    return {at(below.x, above.x), at(below.y, above.y)};
}

}  // namespace

Sectioner::Sectioner(GridSurface surface, int layer_um)
    : surface_(std::move(surface)), half_layer_(std::int64_t{layer_um} * grid_per_um / 2) {
    for (std::size_t i = 0; i < surface_.triangles.size(); ++i) {
        const auto [a, b, c] = surface_.triangles[i];
        const auto [low, high] = std::minmax({surface_.points[a].z, surface_.points[b].z, surface_.points[c].z});
        const int first = layers_below(low), end = layers_below(high);  // planes in (low, high]
        if (first == end) continue;
        layer_count_ = std::max(layer_count_, end);
        const auto last_block = static_cast<std::size_t>((end - 1) / block_layers);
        if (blocks_.size() <= last_block) blocks_.resize(last_block + 1);
        for (std::size_t block = static_cast<std::size_t>(first / block_layers); block <= last_block; ++block)
            blocks_[block].push_back(static_cast<int>(i));
    }
}

/// The number of planes at or below height z.
int Sectioner::layers_below(std::int64_t z) const {
    if (z < half_layer_) return 0;
    return static_cast<int>((z - half_layer_) / (2 * half_layer_)) + 1;
}

void Sectioner::cut(const Triangle& t, std::int64_t plane, std::vector<Segment>& segments) const {
    std::array<bool, 3> above{};
    for (std::size_t i = 0; i < 3; ++i) above[i] = surface_.points[t[i]].z >= plane;
    if (above[0] == above[1] && above[1] == above[2]) return;
    // Seen with the solid behind it, the triangle is crossed downwards at the segment's start and upwards at its end.
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
    const auto block = static_cast<std::size_t>(layer / block_layers);
    if (layer < 0 || block >= blocks_.size()) return;
    const std::int64_t z = plane(layer);
    for (const int t : blocks_[block]) cut(surface_.triangles[t], z, segments);
}

}  // namespace pliant::slice
