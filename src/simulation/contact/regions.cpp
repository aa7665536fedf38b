#include "simulation/contact/regions.hpp"

#include <algorithm>

#include "base/core/boxes.hpp"

namespace pliant::sim::contact {

namespace {

constexpr std::size_t leaf_points = 8;

/// Minimum height of a triangle relative to its longest side; below it the corners count as collinear.
constexpr double least_height = 0.1;

std::optional<std::array<int, 3>> spread_corners(std::span<const int> points, std::span<const double> positions) {
    const auto at = [&](int point) { return node_at(positions, point); };
    const auto farthest = [&](const auto& distance) {
        return *std::max_element(points.begin(), points.end(), [&](int a, int b) { return distance(a) < distance(b); });
    };
    const int a = points.front();
    const int b = farthest([&](int p) { return norm(at(p) - at(a)); });
    const Vec3 side = at(b) - at(a);
    const auto doubled_area = [&](int p) { return norm(cross(side, at(p) - at(a))); };
    const int c = farthest(doubled_area);
    if (!(doubled_area(c) > least_height * dot(side, side))) return std::nullopt;
    return std::array{a, b, c};
}

}  // namespace

Regions::Regions(const Surface& surface, std::span<const double> positions)
    : points_(surface.points), leaf_of_(positions.size() / 3) {
    if (!points_.empty()) split(positions, 0, points_.size());
    corners_.resize(nodes_.size());
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (!nodes_[n].is_leaf()) continue;
        corners_[n] = spread_corners(points_of(nodes_[n]), positions);
        for (const int point : points_of(nodes_[n])) leaf_of_[static_cast<std::size_t>(point)] = n;
    }
}

std::size_t Regions::split(std::span<const double> positions, std::size_t begin, std::size_t end) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({begin, end, 0, 0});
    if (end - begin <= leaf_points) return node;
    Bounds box;
    for (std::size_t i = begin; i < end; ++i) box.add(node_at(positions, points_[i]));
    const std::size_t axis = longest_axis(box);
    const std::size_t middle = begin + (end - begin) / 2;
    halve(std::span(points_).subspan(begin, end - begin), middle - begin,
          [&](int point) { return node_at(positions, point)[axis]; });
    const std::size_t left = split(positions, begin, middle);
    const std::size_t right = split(positions, middle, end);
    nodes_[node].left = left;
    nodes_[node].right = right;
    return node;
}

void Regions::add_up(std::vector<Bounds>& boxes) const {
    for (std::size_t n = nodes_.size(); n-- > 0;) {
        if (nodes_[n].is_leaf()) continue;
        boxes[n].add(boxes[nodes_[n].left]);
        boxes[n].add(boxes[nodes_[n].right]);
    }
}

std::vector<Bounds> Regions::boxes(const Surface& surface, std::span<const double> positions) const {
    std::vector<Bounds> boxes(nodes_.size());
    for (const auto& triangle : surface.triangles) {
        Bounds box;
        for (const int node : triangle) box.add(node_at(positions, node));
        for (const int node : triangle) boxes[leaf_of(node)].add(box);
    }
    add_up(boxes);
    return boxes;
}

std::vector<Bounds> Regions::displacements(std::span<const double> from, std::span<const double> x,
                                           std::span<const double> dx) const {
    std::vector<Bounds> boxes(nodes_.size());
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (!nodes_[n].is_leaf()) continue;
        for (const int point : points_of(nodes_[n])) {
            const Vec3 gone = node_at(x, point) - node_at(from, point);
            boxes[n].add(gone);
            if (!dx.empty()) boxes[n].add(gone + node_at(dx, point));
        }
    }
    add_up(boxes);
    return boxes;
}

}  // namespace pliant::sim::contact
