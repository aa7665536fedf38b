#include "geometry/repair/surface_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "base/core/counted.hpp"
#include "geometry/repair/surface_seams.hpp"
#include "geometry/repair/surface_shells.hpp"
#include "geometry/repair/surface_slivers.hpp"

namespace pliant::mesh {
namespace {

struct EdgeUse {
    int low, high;
    int triangle;
    bool forward;  ///< the triangle runs from low to high
};

std::vector<EdgeUse> edge_uses(const TriMesh& surface) {
    std::vector<EdgeUse> uses;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const int a = surface.triangles[t][k];
            const int b = surface.triangles[t][(k + 1) % 3];
            uses.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
        }
    }
    std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    return uses;
}

double double_area(const TriMesh& surface, std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3& p = surface.points[static_cast<std::size_t>(a)];
    return norm(
        cross(surface.points[static_cast<std::size_t>(b)] - p, surface.points[static_cast<std::size_t>(c)] - p));
}

void drop_useless(TriMesh& surface, SurfaceDamage& damage) {
    std::set<std::array<int, 3>> seen;
    std::vector<std::array<int, 3>> kept;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        std::array<int, 3> sorted = surface.triangles[t];
        std::sort(sorted.begin(), sorted.end());
        if (double_area(surface, t) <= 0)
            ++damage.flat;
        else if (!seen.insert(sorted).second)
            ++damage.repeated;
        else
            kept.push_back(surface.triangles[t]);
    }
    surface.triangles = std::move(kept);
}

struct Link {
    int triangle;
    bool agrees;
};

/// Neighbours across edges of exactly two triangles; counts all others.
std::vector<std::vector<Link>> neighbours(const TriMesh& surface, SurfaceDamage& damage) {
    const std::vector<EdgeUse> uses = edge_uses(surface);
    std::vector<std::vector<Link>> links(surface.triangles.size());
    for (std::size_t i = 0; i < uses.size();) {
        std::size_t end = i + 1;
        while (end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high) ++end;
        damage.open_edges += end - i == 1 ? 1 : 0;
        damage.crowded_edges += end - i > 2 ? 1 : 0;
        if (end - i == 2) {
            const bool agrees = uses[i].forward != uses[i + 1].forward;
            links[static_cast<std::size_t>(uses[i].triangle)].push_back({uses[i + 1].triangle, agrees});
            links[static_cast<std::size_t>(uses[i + 1].triangle)].push_back({uses[i].triangle, agrees});
        }
        i = end;
    }
    return links;
}

/// Orients everything connected to triangle `first` consistently; the smaller part by area is flipped.
void agree(TriMesh& surface, const std::vector<std::vector<Link>>& links, std::size_t first, std::vector<int>& side,
           SurfaceDamage& damage) {
    std::vector<std::size_t> patch = {first};
    side[first] = 1;
    double turned_area = 0;
    double area = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
        const std::size_t t = patch[i];
        area += double_area(surface, t);
        if (side[t] < 0) turned_area += double_area(surface, t);
        for (const Link& link : links[t]) {
            const auto other = static_cast<std::size_t>(link.triangle);
            if (side[other] != 0) continue;
            side[other] = link.agrees ? side[t] : -side[t];
            patch.push_back(other);
        }
    }
    const int wrong = 2 * turned_area > area ? 1 : -1;
    for (const std::size_t t : patch) {
        if (side[t] != wrong) continue;
        std::swap(surface.triangles[t][1], surface.triangles[t][2]);
        ++damage.turned;
    }
}

}  // namespace

SurfaceDamage orient(TriMesh& surface) {
    SurfaceDamage damage;
    drop_useless(surface, damage);
    const auto links = neighbours(surface, damage);
    std::vector<int> side(surface.triangles.size(), 0);
    for (std::size_t t = 0; t < side.size(); ++t) {
        if (side[t] == 0) agree(surface, links, t, side, damage);
    }
    if (signed_volume(surface) < 0) {
        damage.inside_out = true;
        for (auto& triangle : surface.triangles) std::swap(triangle[1], triangle[2]);
    }
    return damage;
}

std::string describe(const SurfaceDamage& damage) {
    std::string text;
    const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
    const auto add_count = [&](std::size_t count, std::string_view word, std::string_view rest = "") {
        if (count > 0) add(counted(count, word) + std::string(rest));
    };
    add_count(damage.open_edges, "open edge");
    add_count(damage.crowded_edges, "edge", " of more than two triangles");
    add_count(damage.turned, "triangle", " turned");
    add_count(damage.repeated, "repeated triangle");
    add_count(damage.flat, "flat triangle");
    if (damage.inside_out) add("surface turned inside out");
    return text;
}

JudgedSurface judged(const TriMesh& surface) {
    JudgedSurface result{surface, {}};
    (void)close_seams(result.sound);
    // Flipping the edge of a flat triangle can keep a surface closed, which leaving the triangle out would open.
    TriMesh flipped = result.sound;
    const SliverCount slivers = remove_slivers(flipped);
    const bool closed = border_edges(flipped).empty();
    if (closed) result.sound = std::move(flipped);
    result.damage = orient(result.sound);
    if (closed) result.damage.flat += slivers.removed;
    return result;
}

void orient_solid(TriMesh& surface) {
    (void)orient(surface);
    const auto shells = shell_triangles(surface);
    std::vector<double> volume;
    for (const auto& shell : shells) {
        TriMesh part{surface.points, {}};
        for (const std::size_t t : shell) part.triangles.push_back(surface.triangles[t]);
        volume.push_back(signed_volume(part));
    }
    const auto smaller = [](double a, double b) { return std::fabs(a) < std::fabs(b); };
    const auto outer =
        static_cast<std::size_t>(std::max_element(volume.begin(), volume.end(), smaller) - volume.begin());
    for (std::size_t s = 0; s < shells.size(); ++s) {
        if ((s == outer) == (volume[s] > 0)) continue;
        for (const std::size_t t : shells[s]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    }
}

}  // namespace pliant::mesh
