#include "geometry/repair/surface_shells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "base/core/disjoint_sets.hpp"

namespace pliant::mesh {
namespace {

constexpr std::size_t most_shells = 1000;

struct Shell {
    TriMesh mesh;
    double volume;
    Box3 box;

    [[nodiscard]] bool surrounds(const Shell& other) const {
        const Vec3& p = other.mesh.points.front();
        return box.contains(p) && std::fabs(winding_number(mesh, p)) > 0.5;
    }
};

/// The smallest shell around shell `s`, or -1.
int parent_of(const std::vector<Shell>& shells, std::size_t s) {
    int parent = -1;
    for (std::size_t o = 0; o < shells.size(); ++o) {
        if (o == s || !shells[o].surrounds(shells[s])) continue;
        const auto size = [&](std::size_t i) { return std::fabs(shells[i].volume); };
        if (parent < 0 || size(o) < size(static_cast<std::size_t>(parent))) parent = static_cast<int>(o);
    }
    return parent;
}

}  // namespace

std::vector<std::vector<std::size_t>> shell_triangles(const TriMesh& surface) {
    struct Edge {
        int low, high;
        std::size_t triangle;
    };
    std::vector<Edge> edges;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax(surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]);
            edges.push_back({low, high, t});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    DisjointSets sets(surface.triangles.size());
    for (std::size_t i = 1; i < edges.size(); ++i) {
        if (edges[i].low == edges[i - 1].low && edges[i].high == edges[i - 1].high)
            sets.join(edges[i].triangle, edges[i - 1].triangle);
    }
    std::vector<std::vector<std::size_t>> shells;
    std::map<std::size_t, std::size_t> shell_of;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto [entry, fresh] = shell_of.try_emplace(sets.find(t), shells.size());
        if (fresh) shells.emplace_back();
        shells[entry->second].push_back(t);
    }
    return shells;
}

TriMesh part_of(const TriMesh& surface, const std::vector<std::size_t>& triangles) {
    TriMesh part;
    std::map<int, int> index;
    for (const std::size_t t : triangles) {
        std::array<int, 3> triangle{};
        for (std::size_t i = 0; i < 3; ++i) {
            const int point = surface.triangles[t][i];
            const auto [entry, fresh] = index.try_emplace(point, static_cast<int>(part.points.size()));
            if (fresh) part.points.push_back(surface.points[static_cast<std::size_t>(point)]);
            triangle[i] = entry->second;
        }
        part.triangles.push_back(triangle);
    }
    return part;
}

double winding_number(const TriMesh& surface, const Vec3& point) {
    double sum = 0;
    for (const auto& [i, j, k] : surface.triangles) {
        const Vec3 a = surface.points[static_cast<std::size_t>(i)] - point;
        const Vec3 b = surface.points[static_cast<std::size_t>(j)] - point;
        const Vec3 c = surface.points[static_cast<std::size_t>(k)] - point;
        const double la = norm(a);
        const double lb = norm(b);
        const double lc = norm(c);
        sum += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return sum / (2 * std::numbers::pi);
}

Result<std::vector<TriMesh>> solid_pieces(const TriMesh& surface) {
    const auto parts = shell_triangles(surface);
    if (parts.size() == 1) return std::vector<TriMesh>{surface};
    if (parts.size() > most_shells)
        return input_error("the surface has {} separate shells; {} are possible", parts.size(), most_shells);
    std::vector<Shell> shells;
    for (const auto& triangles : parts) {
        TriMesh mesh = part_of(surface, triangles);
        const double volume = signed_volume(mesh);
        const Box3 box = bounds(mesh);
        shells.push_back({std::move(mesh), volume, box});
    }
    std::vector<TriMesh> pieces;
    std::vector<int> piece_of(shells.size(), -1);
    std::vector<int> parents;
    for (std::size_t s = 0; s < shells.size(); ++s) {
        parents.push_back(parent_of(shells, s));
        const bool in_material = parents[s] >= 0 && shells[static_cast<std::size_t>(parents[s])].volume > 0;
        if (shells[s].volume > 0 && in_material)
            return input_error("one shell of the surface lies inside the material of another; a cavity looks inwards");
        if (shells[s].volume <= 0 && !in_material)
            return input_error("one of the {} shells of the surface is inside out; turn its normals outwards",
                               shells.size());
        if (shells[s].volume <= 0) continue;
        piece_of[s] = static_cast<int>(pieces.size());
        pieces.push_back(shells[s].mesh);
    }
    for (std::size_t s = 0; s < shells.size(); ++s) {
        if (shells[s].volume <= 0)
            append(pieces[static_cast<std::size_t>(piece_of[static_cast<std::size_t>(parents[s])])], shells[s].mesh);
    }
    return pieces;
}

TriMesh with_enough_triangles(TriMesh surface, std::size_t least) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
        const auto [entry, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(surface.points.size()));
        const auto at = [&](int n) { return surface.points[static_cast<std::size_t>(n)]; };
        if (fresh) surface.points.push_back(0.5 * (at(a) + at(b)));
        return entry->second;
    };
    for (const std::vector<std::size_t>& shell : shell_triangles(surface)) {
        std::vector<std::size_t> triangles = shell;
        while (triangles.size() < least) {
            for (std::size_t i = triangles.size(); i-- > 0;) {
                const auto [a, b, c] = surface.triangles[triangles[i]];
                const int ab = middle(a, b);
                const int bc = middle(b, c);
                const int ca = middle(c, a);
                surface.triangles[triangles[i]] = {ab, bc, ca};
                for (const std::array<int, 3>& corner : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}}) {
                    triangles.push_back(surface.triangles.size());
                    surface.triangles.push_back(corner);
                }
            }
        }
    }
    return surface;
}

}  // namespace pliant::mesh
