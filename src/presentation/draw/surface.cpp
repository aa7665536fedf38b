#include "presentation/draw/surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

namespace pliant::report {
namespace {

constexpr double crease_cosine = 0.8191520442889918;  // 35 degrees

Vec3 area_vector(const std::array<int, 3>& triangle, std::span<const Vec3> points) {
    const Vec3& a = points[static_cast<std::size_t>(triangle[0])];
    return 0.5 *
           cross(points[static_cast<std::size_t>(triangle[1])] - a, points[static_cast<std::size_t>(triangle[2])] - a);
}

Vec3 unit_or_up(const Vec3& v) {
    const double length = norm(v);
    return length > 0 ? v / length : Vec3{0, 0, 1};
}

/// The mesh without its voids, and for each of its tets the index in the whole mesh.
std::pair<mesh::TetMesh, std::vector<int>> solid_part(const mesh::TetMesh& mesh, std::span<const int> region_material) {
    mesh::TetMesh solid{mesh.order, mesh.points, {}, {}, mesh.region_names, {}};
    std::vector<int> origin;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (region_material[static_cast<std::size_t>(mesh.region[t])] < 0) continue;
        const auto nodes = mesh.tet(t);
        solid.nodes.insert(solid.nodes.end(), nodes.begin(), nodes.end());
        solid.region.push_back(mesh.region[t]);
        origin.push_back(static_cast<int>(t));
    }
    return {std::move(solid), std::move(origin)};
}

/// Triangles whose corners are mesh nodes, with material and tet; vertices are split later.
Surface triangles_on_nodes(const mesh::TetMesh& mesh, std::span<const int> region_material) {
    static constexpr std::array<std::array<int, 3>, 4> quarters = {{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
    const auto [solid, origin] = solid_part(mesh, region_material);
    Surface surface;
    const auto add = [&, &solid = solid, &origin = origin](std::array<int, 3> triangle, int tet) {
        surface.triangles.push_back(triangle);
        surface.tet.push_back(origin[static_cast<std::size_t>(tet)]);
        const int region = solid.region[static_cast<std::size_t>(tet)];
        surface.material.push_back(region_material[static_cast<std::size_t>(region)]);
    };
    for (const mesh::Face& face : mesh::boundary_faces(solid)) {
        if (face.nodes[3] < 0) {
            add({face.nodes[0], face.nodes[1], face.nodes[2]}, face.tet);
            continue;
        }
        for (const auto& q : quarters) {
            add({face.nodes[static_cast<std::size_t>(q[0])], face.nodes[static_cast<std::size_t>(q[1])],
                 face.nodes[static_cast<std::size_t>(q[2])]},
                face.tet);
        }
    }
    return surface;
}

/// Corners (3 * triangle + k) around each node that has any, ordered by node.
std::map<int, std::vector<int>> corners_of_nodes(const Surface& surface) {
    std::map<int, std::vector<int>> corners;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (int k = 0; k < 3; ++k) {
            corners[surface.triangles[t][static_cast<std::size_t>(k)]].push_back(3 * static_cast<int>(t) + k);
        }
    }
    return corners;
}

bool share_edge_at(int node, const std::array<int, 3>& a, const std::array<int, 3>& b) {
    return std::any_of(a.begin(), a.end(),
                       [&](int n) { return n != node && std::find(b.begin(), b.end(), n) != b.end(); });
}

/// Groups the corners around one node: neighbours across an edge belong together unless the edge is sharp or the
/// material changes. For each corner returns the position, in `corners`, of the first corner of its group.
std::vector<std::size_t> smooth_groups(int node, const std::vector<int>& corners, const Surface& surface,
                                       std::span<const Vec3> normals) {
    std::vector<std::size_t> group(corners.size());
    std::iota(group.begin(), group.end(), std::size_t{0});
    for (std::size_t i = 0; i < corners.size(); ++i) {
        for (std::size_t j = i + 1; j < corners.size(); ++j) {
            const auto a = static_cast<std::size_t>(corners[i] / 3), b = static_cast<std::size_t>(corners[j] / 3);
            if (surface.material[a] != surface.material[b]) continue;
            if (dot(normals[a], normals[b]) < crease_cosine) continue;
            if (!share_edge_at(node, surface.triangles[a], surface.triangles[b])) continue;
            const std::size_t low = std::min(group[i], group[j]), high = std::max(group[i], group[j]);
            std::replace(group.begin(), group.end(), high, low);
        }
    }
    return group;
}

/// Gives every smooth group of corners a vertex of its own.
Surface split_at_creases(Surface surface, std::span<const Vec3> points) {
    std::vector<Vec3> normals;
    normals.reserve(surface.triangles.size());
    for (const auto& triangle : surface.triangles) normals.push_back(unit_or_up(area_vector(triangle, points)));

    std::vector<std::array<int, 3>> split(surface.triangles.size());
    for (const auto& [node, corners] : corners_of_nodes(surface)) {
        const auto group = smooth_groups(node, corners, surface, normals);
        std::vector<int> vertex(corners.size(), -1);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            int& id = vertex[group[i]];
            if (id < 0) {
                id = static_cast<int>(surface.vertex_node.size());
                surface.vertex_node.push_back(node);
            }
            split[static_cast<std::size_t>(corners[i] / 3)][static_cast<std::size_t>(corners[i] % 3)] = id;
        }
    }
    surface.triangles = std::move(split);
    return surface;
}

}  // namespace

Surface outer_surface(const mesh::TetMesh& mesh, std::span<const int> region_material) {
    return split_at_creases(triangles_on_nodes(mesh, region_material), mesh.points);
}

Surface rigid_surface(const mesh::TriMesh& mesh) {
    Surface surface;
    surface.triangles = mesh.triangles;
    surface.material.assign(mesh.triangles.size(), 0);
    surface.tet.assign(mesh.triangles.size(), -1);
    return split_at_creases(std::move(surface), mesh.points);
}

Pose pose(const Surface& surface, std::span<const Vec3> node_positions) {
    Pose result;
    result.positions.reserve(surface.vertex_node.size());
    for (const int node : surface.vertex_node)
        result.positions.push_back(node_positions[static_cast<std::size_t>(node)]);
    result.normals.resize(surface.vertex_node.size());
    for (const auto& triangle : surface.triangles) {
        const Vec3 area = area_vector(triangle, result.positions);
        for (const int v : triangle) result.normals[static_cast<std::size_t>(v)] += area;
    }
    for (Vec3& n : result.normals) n = unit_or_up(n);
    return result;
}

std::vector<double> at_vertices(const mesh::TetMesh& mesh, std::span<const int> region_material, const Surface& surface,
                                std::span<const double> tet_values) {
    std::map<std::pair<int, int>, std::pair<double, double>> sums;  // (node, material): weighted value, weight
    std::vector<int> vertex_material(surface.vertex_node.size(), -1);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (const int v : surface.triangles[t]) {
            vertex_material[static_cast<std::size_t>(v)] = surface.material[t];
            sums[{surface.vertex_node[static_cast<std::size_t>(v)], surface.material[t]}] = {0, 0};
        }
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const int material = region_material[static_cast<std::size_t>(mesh.region[t])];
        const auto n = mesh.tet(t);
        const auto point = [&](std::size_t i) { return mesh.points[static_cast<std::size_t>(n[i])]; };
        const double volume = mesh::signed_tet_volume(point(0), point(1), point(2), point(3));
        for (const int node : n) {
            const auto found = sums.find({node, material});
            if (found == sums.end()) continue;
            found->second.first += volume * tet_values[t];
            found->second.second += volume;
        }
    }
    std::vector<double> values(surface.vertex_node.size());
    for (std::size_t v = 0; v < values.size(); ++v) {
        const auto& [sum, weight] = sums[{surface.vertex_node[v], vertex_material[v]}];
        values[v] = weight > 0 ? sum / weight : 0;
    }
    return values;
}

}  // namespace pliant::report
