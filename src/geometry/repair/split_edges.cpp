#include "geometry/repair/split_edges.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

namespace pliant::mesh {
namespace {

using Middles = std::map<std::pair<int, int>, int>;

/// The point in the middle of each edge that is too long, -1 for one that has been found short enough.
void find_middles(TriMesh& surface, const std::function<double(const Vec3&)>& longest, Middles& middles) {
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [entry, fresh] = middles.try_emplace(std::minmax(t[k], t[(k + 1) % 3]), -1);
            if (!fresh) continue;
            const Vec3 a = surface.points[static_cast<std::size_t>(entry->first.first)];
            const Vec3 b = surface.points[static_cast<std::size_t>(entry->first.second)];
            const Vec3 middle = 0.5 * (a + b);
            if (norm(b - a) <= longest(middle)) continue;
            entry->second = static_cast<int>(surface.points.size());
            surface.points.push_back(middle);
        }
    }
}

/// The pieces of a triangle; `middle` of the edges 01, 12 and 20, or -1.
std::vector<std::array<int, 3>> pieces_of(const TriMesh& surface, std::array<int, 3> t, std::array<int, 3> middle) {
    const auto count = std::ranges::count_if(middle, [](int m) { return m >= 0; });
    if (count == 0) return {t};
    if (count == 3)
        return {{t[0], middle[0], middle[2]},
                {middle[0], t[1], middle[1]},
                {middle[2], middle[1], t[2]},
                {middle[0], middle[1], middle[2]}};
    // Turned so that edge 01 is the only one that is split, or 20 the only one that is not.
    while (count == 1 ? middle[0] < 0 : middle[2] >= 0) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        std::rotate(middle.begin(), middle.begin() + 1, middle.end());
    }
    if (count == 1) return {{t[0], middle[0], t[2]}, {middle[0], t[1], t[2]}};
    const auto apart = [&](int a, int b) {
        return norm(surface.points[static_cast<std::size_t>(a)] - surface.points[static_cast<std::size_t>(b)]);
    };
    const std::array<int, 3> corner = {middle[0], t[1], middle[1]};
    if (apart(t[0], middle[1]) <= apart(middle[0], t[2]))
        return {corner, {t[0], middle[0], middle[1]}, {t[0], middle[1], t[2]}};
    return {corner, {t[0], middle[0], t[2]}, {middle[0], middle[1], t[2]}};
}

}  // namespace

TriMesh with_short_edges(TriMesh surface, const std::function<double(const Vec3&)>& longest, std::size_t most) {
    Middles middles;
    while (surface.triangles.size() < most) {
        const std::size_t before = surface.points.size();
        find_middles(surface, longest, middles);
        if (surface.points.size() == before) break;
        std::vector<std::array<int, 3>> triangles;
        for (const auto& t : surface.triangles) {
            const auto middle = [&](int a, int b) { return middles.at(std::minmax(a, b)); };
            const auto pieces = pieces_of(surface, t, {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])});
            triangles.insert(triangles.end(), pieces.begin(), pieces.end());
        }
        surface.triangles = std::move(triangles);
    }
    return surface;
}

}  // namespace pliant::mesh
