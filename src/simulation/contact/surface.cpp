#include "simulation/contact/surface.hpp"

#include <algorithm>

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
    for (const auto& t : surface.triangles) {
        const Vec3 a = node_at(positions, t[0]), b = node_at(positions, t[1]), c = node_at(positions, t[2]);
        const double share = norm(cross(b - a, c - a)) / 6;
        areas.triangles.push_back(3 * share);
        for (int k = 0; k < 3; ++k) {
            areas.points[index_of(surface.points, t[k])] += share;
            areas.edges[index_of(surface.edges, edge_of(t, k))] += share;
        }
    }
    return areas;
}

}  // namespace pliant::sim::contact
