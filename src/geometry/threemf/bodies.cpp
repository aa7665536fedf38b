#include "geometry/threemf/bodies.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "base/core/disjoint_sets.hpp"
#include "geometry/repair/surface_shells.hpp"

namespace pliant::threemf {
namespace {

/// Sets of points that are connected by triangles or coincide.
DisjointSets shells_of(const mesh::TriMesh& mesh) {
    std::vector<int> order(mesh.points.size());
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](int i) {
        const Vec3& p = mesh.points[static_cast<std::size_t>(i)];
        return std::tuple(p.x, p.y, p.z);
    };
    std::sort(order.begin(), order.end(), [&](int a, int b) { return place(a) < place(b); });
    DisjointSets sets(mesh.points.size());
    for (std::size_t i = 1; i < order.size(); ++i) {
        if (place(order[i]) == place(order[i - 1])) sets.join(order[i], order[i - 1]);
    }
    for (const auto& t : mesh.triangles) {
        sets.join(t[0], t[1]);
        sets.join(t[0], t[2]);
    }
    return sets;
}

std::string most_frequent(const Object& object) {
    std::vector<int> counts(object.materials.size(), 0);
    for (const int m : object.material_of_triangle) ++counts[static_cast<std::size_t>(m)];
    const auto most = std::max_element(counts.begin(), counts.end());
    return most == counts.end() ? "default" : object.materials[static_cast<std::size_t>(most - counts.begin())];
}

}  // namespace

std::vector<Body> split_by_material(const Object& object, std::vector<std::string>& warnings) {
    if (object.materials.size() <= 1) {
        const std::string material = !object.materials.empty() ? object.materials[0] : object.material;
        return {{object.name, material.empty() ? "default" : material, object.mesh, {}}};
    }
    DisjointSets shells = shells_of(object.mesh);
    std::map<int, int> material_of_shell;  // -1: several
    for (std::size_t t = 0; t < object.mesh.triangles.size(); ++t) {
        const int m = object.material_of_triangle[t];
        const auto [entry, fresh] = material_of_shell.try_emplace(shells.find(object.mesh.triangles[t][0]), m);
        if (!fresh && entry->second != m) entry->second = -1;
    }
    std::map<std::string, std::vector<std::size_t>> triangles_of;
    const std::string mixed = object.material.empty() ? most_frequent(object) : object.material;
    bool any_mixed = false;
    for (std::size_t t = 0; t < object.mesh.triangles.size(); ++t) {
        const int m = material_of_shell[shells.find(object.mesh.triangles[t][0])];
        any_mixed = any_mixed || m < 0;
        triangles_of[m < 0 ? mixed : object.materials[static_cast<std::size_t>(m)]].push_back(t);
    }
    if (any_mixed)
        warnings.push_back(
            fmt::format("{}: its triangles name {} materials or colours "
                        "that do not bound volumes; it is printed in \"{}\"",
                        object.name, object.materials.size(), mixed));
    std::vector<Body> bodies;
    for (const auto& [material, triangles] : triangles_of)
        bodies.push_back({object.name, material, mesh::part_of(object.mesh, triangles), {}});
    return bodies;
}

}  // namespace pliant::threemf
