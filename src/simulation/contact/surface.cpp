#include "simulation/contact/surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/core/disjoint_sets.hpp"

namespace pliant::sim::contact {

namespace {

template <class T>
void sort_unique(std::vector<T>& items) {
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
}

template <class T>
std::size_t index_of(const std::vector<T>& sorted, const T& item) {
    return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), item) - sorted.begin());
}

std::array<int, 2> edge_of(const std::array<int, 3>& t, int k) {
    const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
    return {low, high};
}

/// Two triangles with a common edge lie in one plane, on both sides of the edge. `opposite`: their third corners.
bool is_flat(const std::array<int, 2>& edge, const std::array<int, 2>& opposite, std::span<const double> positions) {
    constexpr double flat = 1e-6;  // sine of the angle: a hundred times that of coordinates of 32 bits
    const Vec3 a = node_at(positions, edge[0]), u = node_at(positions, edge[1]) - a;
    const Vec3 one = cross(u, node_at(positions, opposite[0]) - a),
               other = cross(u, node_at(positions, opposite[1]) - a);
    const double scale = norm(one) * norm(other);
    return dot(one, other) < 0 && norm(cross(one, other)) <= flat * scale;
}

/// A third of a triangle's area.
double third_of(const std::array<int, 3>& t, std::span<const double> positions) {
    const Vec3 a = node_at(positions, t[0]), b = node_at(positions, t[1]), c = node_at(positions, t[2]);
    return norm(cross(b - a, c - a)) / 6;
}

/// By how much the points on the boundary of each flat face must represent more than their own share, for those inside.
std::map<std::int64_t, double> growth_of_boundaries(const Surface& surface, std::span<const double> positions) {
    std::map<std::int64_t, double> all, outside;
    for (std::size_t i = 0; i < surface.flat_face.size(); ++i) {
        const std::int64_t face = surface.flat_face[i];
        if (face < 0) continue;
        const double share = third_of(surface.triangles[i], positions);
        all[face] += 3 * share;
        for (const int point : surface.triangles[i])
            if (surface.acts(index_of(surface.points, point))) outside[face] += share;
    }
    for (auto& [face, area] : all) area = outside[face] > 0 ? area / outside[face] : 1;
    return all;
}

}  // namespace

Surface make_surface(std::span<const std::array<int, 3>> triangles) {
    Surface surface;
    surface.triangles.assign(triangles.begin(), triangles.end());
    for (const auto& t : triangles)
        for (int k = 0; k < 3; ++k) {
            surface.points.push_back(t[k]);
            surface.edges.push_back(edge_of(t, k));
        }
    sort_unique(surface.points);
    sort_unique(surface.edges);
    return surface;
}

Surface make_rigid_surface(std::span<const std::array<int, 3>> triangles, std::span<const double> positions) {
    struct Side {
        int triangle, opposite;
    };
    std::map<std::array<int, 2>, std::vector<Side>> sides;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (int k = 0; k < 3; ++k)
            sides[edge_of(triangles[t], k)].push_back({static_cast<int>(t), triangles[t][(k + 2) % 3]});
    std::erase_if(sides, [&](const auto& item) {
        const auto& [edge, at] = item;
        return at.size() != 2 || !is_flat(edge, {at[0].opposite, at[1].opposite}, positions);
    });
    DisjointSets faces(triangles.size());
    for (const auto& [edge, at] : sides) faces.join(at[0].triangle, at[1].triangle);

    Surface surface = make_surface(triangles);
    std::erase_if(surface.edges, [&](const std::array<int, 2>& edge) { return sides.contains(edge); });
    surface.inside_face.assign(surface.points.size(), 1);
    for (const auto& edge : surface.edges)
        for (const int point : edge) surface.inside_face[index_of(surface.points, point)] = 0;
    std::vector<std::int64_t> name(triangles.size(), -1);
    const auto nodes = static_cast<std::int64_t>(positions.size() / 3);
    for (const auto& [edge, at] : sides) {
        std::int64_t& first = name[static_cast<std::size_t>(faces.find(at[0].triangle))];
        if (first < 0) first = edge[0] * nodes + edge[1];
    }
    for (std::size_t t = 0; t < triangles.size(); ++t)
        surface.flat_face.push_back(name[static_cast<std::size_t>(faces.find(static_cast<int>(t)))]);
    return surface;
}

Surface robot_surface(const mesh::TetMesh& mesh) {
    std::vector<std::array<int, 3>> triangles;
    for (const mesh::Face& face : mesh::boundary_faces(mesh)) {
        const auto& n = face.nodes;
        if (mesh.order == 1) {
            triangles.push_back({n[0], n[1], n[2]});
            continue;
        }
        triangles.push_back({n[0], n[3], n[5]});
        triangles.push_back({n[3], n[1], n[4]});
        triangles.push_back({n[5], n[4], n[2]});
        triangles.push_back({n[3], n[4], n[5]});
    }
    return make_surface(triangles);
}

SurfaceAreas surface_areas(const Surface& surface, std::span<const double> positions) {
    SurfaceAreas areas{std::vector<double>(surface.points.size()), std::vector<double>(surface.edges.size()), {}};
    const std::map<std::int64_t, double> growth = growth_of_boundaries(surface, positions);
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        const auto& t = surface.triangles[i];
        const double share = third_of(t, positions);
        const auto grown = growth.empty() ? growth.end() : growth.find(surface.flat_face[i]);
        areas.triangles.push_back(3 * share);
        std::vector<std::size_t> edges;
        for (int k = 0; k < 3; ++k) {
            const std::size_t point = index_of(surface.points, t[k]);
            if (surface.acts(point)) areas.points[point] += share * (grown == growth.end() ? 1 : grown->second);
            const std::size_t edge = index_of(surface.edges, edge_of(t, k));
            if (edge < surface.edges.size() && surface.edges[edge] == edge_of(t, k)) edges.push_back(edge);
        }
        for (const std::size_t edge : edges) areas.edges[edge] += 3 * share / static_cast<double>(edges.size());
    }
    std::map<std::int64_t, double> whole;
    for (std::size_t t = 0; t < surface.flat_face.size(); ++t) whole[surface.flat_face[t]] += areas.triangles[t];
    for (std::size_t t = 0; t < surface.flat_face.size(); ++t)
        if (surface.flat_face[t] >= 0) areas.triangles[t] = whole[surface.flat_face[t]];
    return areas;
}

}  // namespace pliant::sim::contact
