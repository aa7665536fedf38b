#include "geometry/meshing/winding_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/boxes.hpp"
#include "geometry/mesh/triangle_corners.hpp"
#include "geometry/repair/surface_seams.hpp"

namespace pliant::mesh {
namespace {

constexpr double most_cells = 4e6;
/// Limit on the work of listing the triangles of all boxes.
constexpr double most_work = 5e7;
/// For a box with more triangles the tree is faster.
constexpr std::size_t crowd = 48;
/// Border edges per triangle: with more, the caps cost as much as the surface.
constexpr double longest_border = 0.25;

Box3 box_of(const Corners& t) {
    const Box3 box = bounds_of(t);
    return box;
}

/// False only if the plane of the triangle certainly misses the box.
bool plane_meets(const Corners& t, const Box3& box) {
    const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
    const Vec3 half = 0.5 * box.size();
    const double reach = half.x * std::fabs(n.x) + half.y * std::fabs(n.y) + half.z * std::fabs(n.z);
    return std::fabs(dot(n, box.center() - t[0])) <= reach * (1 + 1e-9);
}

enum class Side { below, unclear, above };

Side side(double value, double rounding) {
    if (value > rounding) return Side::above;
    return value < -rounding ? Side::below : Side::unclear;
}

/// Change of the winding number from `a` to `b` due to one triangle; nothing if rounding could decide the crossing. Two
/// triangles decide consistently at their common edge.
std::optional<int> winding_change(const Corners& t, const Vec3& a, const Vec3& b) {
    constexpr double rounding = 1e-13;
    const Vec3 way = b - a;
    const std::array<Vec3, 3> u{t[0] - a, t[1] - a, t[2] - a};
    const double far2 = std::max({dot(u[0], u[0]), dot(u[1], u[1]), dot(u[2], u[2])});
    const double edge_rounding = rounding * norm(way) * far2;
    std::array<Side, 3> edges{};
    for (std::size_t k = 0; k < 3; ++k) edges[k] = side(dot(way, cross(u[(k + 1) % 3], u[(k + 2) % 3])), edge_rounding);
    const auto any = [&](Side s) { return std::find(edges.begin(), edges.end(), s) != edges.end(); };
    if (any(Side::below) && any(Side::above)) return 0;
    const Vec3 e1 = t[1] - t[0];
    const Vec3 e2 = t[2] - t[0];
    const Vec3 normal = cross(e1, e2);
    const double far = std::sqrt(far2);
    const double plane_rounding = rounding * norm(e1) * norm(e2) * (far + norm(way));
    const Side from = side(-dot(u[0], normal), plane_rounding);
    const Side to = side(dot(b - t[0], normal), plane_rounding);
    if (from == to && from != Side::unclear) return 0;
    if (any(Side::unclear) || from == Side::unclear || to == Side::unclear) return std::nullopt;
    return from == Side::above ? 1 : -1;
}

}  // namespace

WindingGrid::WindingGrid(TriMesh surface)
    : tree_(std::move(surface)), caps_(border_caps(tree_.surface())), closed_(caps_.surface()) {
    const std::vector<std::array<int, 3>>& triangles = tree_.surface().triangles;
    box_ = bounds(tree_.surface());
    if (triangles.empty() || closed_.triangles.size() > longest_border * static_cast<double>(triangles.size())) return;
    closed_.triangles.insert(closed_.triangles.end(), triangles.begin(), triangles.end());
    choose_cells();
    list_triangles();
    find_references();
}

double WindingGrid::winding_number(const Vec3& point) const {
    if (count_[0] == 0) return tree_.winding_number(point);
    if (!box_.contains(point)) return -caps_.winding_number(point);
    const Place place = places_of({point, point}).first;
    const std::size_t cell = index(place);
    if (triangles(cell).size() > crowd) return tree_.winding_number(point);
    const std::optional<int> more = change(cell, reference(place), point);
    return more ? winding_[cell] + *more - caps_.winding_number(point) : tree_.winding_number(point);
}

std::span<const int> WindingGrid::triangles(std::size_t cell) const {
    return {listed_.data() + begin_[cell], listed_.data() + begin_[cell + 1]};
}

std::size_t WindingGrid::index(const Place& place) const {
    const auto at = [&](std::size_t k) { return static_cast<std::size_t>(place[k]); };
    return at(0) + static_cast<std::size_t>(count_[0]) * (at(1) + static_cast<std::size_t>(count_[1]) * at(2));
}

Box3 WindingGrid::cell_box(const Place& place) const {
    Box3 box;
    const Vec3 low = box_.low + Vec3{place[0] * side_.x, place[1] * side_.y, place[2] * side_.z};
    box.add(low);
    box.add(low + side_);
    return box;
}

Vec3 WindingGrid::reference(const Place& place) const {
    // Not the middle or a simple fraction of the side, where drawings tend to have edges.
    constexpr Vec3 share{0.48713, 0.52139, 0.50931};
    return box_.low +
           Vec3{(place[0] + share.x) * side_.x, (place[1] + share.y) * side_.y, (place[2] + share.z) * side_.z};
}

std::pair<WindingGrid::Place, WindingGrid::Place> WindingGrid::places_of(const Box3& box) const {
    const auto place = [&](const Vec3& p) {
        Place found{};
        for (std::size_t k = 0; k < 3; ++k)
            found[k] = std::clamp(static_cast<int>((p[k] - box_.low[k]) / side_[k]), 0, count_[k] - 1);
        return found;
    };
    return {place(box.low), place(box.high)};
}

/// Boxes about as large as triangles, and a minimum number along the longest side.
void WindingGrid::choose_cells() {
    constexpr double least = 32;
    const Vec3 size = box_.size();
    const double longest = std::max({size.x, size.y, size.z});
    const double triangle = std::sqrt(surface_area(closed_) / static_cast<double>(closed_.triangles.size()));
    double wanted = std::min(triangle, longest / least);
    while (true) {
        double cells = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            count_[k] = static_cast<int>(std::clamp(std::ceil(size[k] / wanted), 1.0, most_cells));
            side_[k] = size[k] > 0 ? size[k] / count_[k] : 1;
            cells *= count_[k];
        }
        if (cells == 1 || (cells <= most_cells && work() <= most_work)) return;
        wanted *= 1.25;
    }
}

double WindingGrid::work() const {
    double sum = 0;
    for (std::size_t i = 0; i < closed_.triangles.size(); ++i) {
        const auto [low, high] = places_of(box_of(corners(closed_, i)));
        double cells = 1;
        for (std::size_t k = 0; k < 3; ++k) cells *= high[k] - low[k] + 1;
        sum += cells;
    }
    return sum;
}

/// Lists for every box the triangles that may reach into it, ascending: counted first, then written.
void WindingGrid::list_triangles() {
    const auto cells =
        static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]) * static_cast<std::size_t>(count_[2]);
    // A point exactly on a face of a box may fall into the next one by rounding.
    const double rounding = 1e-12 * (norm(box_.low) + norm(box_.high));
    const Vec3 margin = 1e-9 * side_ + Vec3{rounding, rounding, rounding};
    const auto for_each_pair = [&](const auto& take) {
        for (std::size_t i = 0; i < closed_.triangles.size(); ++i) {
            const Corners t = corners(closed_, i);
            const Box3 around = box_of(t);
            const auto [low, high] = places_of({around.low - margin, around.high + margin});
            Place at{};
            for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) {
                for (at[1] = low[1]; at[1] <= high[1]; ++at[1]) {
                    for (at[0] = low[0]; at[0] <= high[0]; ++at[0]) {
                        const Box3 cell = cell_box(at);
                        if (plane_meets(t, {cell.low - margin, cell.high + margin}))
                            take(index(at), static_cast<int>(i));
                    }
                }
            }
        }
    };
    begin_.assign(cells + 1, 0);
    for_each_pair([&](std::size_t cell, int) { ++begin_[cell + 1]; });
    for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];
    listed_.resize(begin_[cells]);
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for_each_pair([&](std::size_t cell, int triangle) { listed_[next[cell]++] = triangle; });
}

/// Starts outside and goes along each row of boxes, from reference point to reference point.
void WindingGrid::find_references() {
    winding_.assign(begin_.size() - 1, 0);
    Place at{};
    for (at[2] = 0; at[2] < count_[2]; ++at[2]) {
        for (at[1] = 0; at[1] < count_[1]; ++at[1]) {
            int winding = 0;
            for (at[0] = 0; at[0] < count_[0]; ++at[0]) {
                const Vec3 end = reference(at);
                Vec3 face = end;
                face.x = box_.low.x + at[0] * side_.x;
                if (at[0] == 0) face.x -= side_.x;
                std::optional<int> more = change(index(at), face, end);
                if (at[0] > 0 && more) {
                    Place before = at;
                    --before[0];
                    const std::optional<int> first = change(index(before), reference(before), face);
                    more = first ? std::optional(*first + *more) : std::nullopt;
                }
                winding = more ? winding + *more : asked_of_trees(end);
                winding_[index(at)] = static_cast<std::int16_t>(winding);
            }
        }
    }
}

std::optional<int> WindingGrid::change(std::size_t cell, const Vec3& a, const Vec3& b) const {
    int sum = 0;
    for (const int triangle : triangles(cell)) {
        const std::optional<int> more = winding_change(corners(closed_, static_cast<std::size_t>(triangle)), a, b);
        if (!more) return std::nullopt;
        sum += *more;
    }
    return sum;
}

int WindingGrid::asked_of_trees(const Vec3& point) const {
    return static_cast<int>(std::lround(tree_.winding_number(point) + caps_.winding_number(point)));
}

}  // namespace pliant::mesh
