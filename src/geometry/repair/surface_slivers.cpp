#include "geometry/repair/surface_slivers.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

namespace pliant::mesh {
namespace {

using Triangle = std::array<int, 3>;

/// Smallest height divided by longest edge.
double flatness(const TriMesh& surface, const Triangle& t) {
    const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
    const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
    return longest > 0 ? norm(cross(b - a, c - a)) / (longest * longest) : 0;
}

/// The triangle of each directed edge.
class Edges {
public:
    explicit Edges(const TriMesh& surface) {
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) add(surface.triangles[t], t);
    }
    void add(const Triangle& t, std::size_t index) {
        for (std::size_t i = 0; i < 3; ++i) owner_[key(t[i], t[(i + 1) % 3])] = index;
    }
    void remove(const Triangle& t) {
        for (std::size_t i = 0; i < 3; ++i) owner_.erase(key(t[i], t[(i + 1) % 3]));
    }
    /// The triangle that runs from a to b, or -1.
    [[nodiscard]] std::ptrdiff_t find(int a, int b) const {
        const auto found = owner_.find(key(a, b));
        return found == owner_.end() ? -1 : static_cast<std::ptrdiff_t>(found->second);
    }

private:
    static std::uint64_t key(int a, int b) {
        return (std::uint64_t{static_cast<std::uint32_t>(a)} << 32) | static_cast<std::uint32_t>(b);
    }
    std::unordered_map<std::uint64_t, std::size_t> owner_;
};

/// The same triangle with its longest edge first.
Triangle longest_first(const TriMesh& surface, const Triangle& t) {
    std::size_t best = 0;
    double longest = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double length = norm(surface.points[t[(i + 1) % 3]] - surface.points[t[i]]);
        if (length <= longest) continue;
        longest = length;
        best = i;
    }
    return {t[best], t[(best + 1) % 3], t[(best + 2) % 3]};
}

/// Flips the longest edge of triangle `index` if both resulting triangles are less flat and the new edge does not exist
/// yet.
bool flip(TriMesh& surface, Edges& edges, std::size_t index) {
    const Triangle old = surface.triangles[index];
    const auto [a, b, m] = longest_first(surface, old);
    const std::ptrdiff_t found = edges.find(b, a);
    if (found < 0) return false;
    const auto other = static_cast<std::size_t>(found);
    const Triangle neighbour = surface.triangles[other];
    int d = neighbour[0];
    for (const int corner : neighbour) {
        if (corner != a && corner != b) d = corner;
    }
    if (d == m || edges.find(m, d) >= 0 || edges.find(d, m) >= 0) return false;
    const Triangle first{a, d, m};
    const Triangle second{d, b, m};
    const double before = std::min(flatness(surface, old), flatness(surface, neighbour));
    if (std::min(flatness(surface, first), flatness(surface, second)) <= std::max(before, flat_triangle)) return false;
    edges.remove(old);
    edges.remove(neighbour);
    edges.add(first, index);
    edges.add(second, other);
    surface.triangles[index] = first;
    surface.triangles[other] = second;
    return true;
}

std::size_t drop_equal_corners(TriMesh& surface) {
    return std::erase_if(surface.triangles,
                         [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

}  // namespace

bool has_flat_triangles(const TriMesh& surface) {
    return std::any_of(surface.triangles.begin(), surface.triangles.end(),
                       [&](const Triangle& t) { return flatness(surface, t) < flat_triangle; });
}

SliverCount remove_slivers(TriMesh& surface) {
    SliverCount count;
    count.removed = drop_equal_corners(surface);
    std::vector<std::size_t> flat;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (flatness(surface, surface.triangles[t]) < flat_triangle) flat.push_back(t);
    }
    if (flat.empty()) return count;
    Edges edges(surface);
    // A flat triangle may be next to another one: it can be flipped after that one is gone.
    for (std::size_t before = flat.size() + 1; flat.size() < before;) {
        before = flat.size();
        std::erase_if(flat, [&](std::size_t t) { return flip(surface, edges, t); });
        count.removed += before - flat.size();
    }
    count.left = flat.size();
    return count;
}

}  // namespace pliant::mesh
