#include "mesh/tet_collector.hpp"

#include <algorithm>
#include <utility>

namespace pliant::mesh {
namespace {

void turn_inside_out_tets(TetMesh& mesh) {
    std::size_t turned = 0;
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        int* n = mesh.nodes.data() + t * width;
        if (signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]) >= 0)
            continue;
        ++turned;
        std::swap(n[1], n[2]);
        if (mesh.order == 2) {  // edges 01-02 and 13-23 change places with corners 1 and 2
            std::swap(n[4], n[6]);
            std::swap(n[8], n[9]);
        }
    }
    if (turned > 0)
        mesh.notes.push_back(fmt::format("{} of {} tets were inside out and were turned", turned, mesh.tet_count()));
}

}  // namespace

Status TetCollector::add(std::span<const std::int64_t> nodes, std::int64_t region) {
    const int order = nodes.size() == 4 ? 1 : 2;
    if (nodes.size() != 4 && nodes.size() != 10) return input_error("a tetrahedron has {} nodes", nodes.size());
    if (mesh_.region.empty()) mesh_.order = order;
    if (mesh_.order != order) return input_error("mixes tetrahedra of 4 and 10 nodes");
    for (std::size_t a = 0; a < nodes.size(); ++a) {
        if (nodes[a] < 0 || static_cast<std::uint64_t>(nodes[a]) >= points_.size())
            return input_error("a tetrahedron names point {}, there are {}", nodes[a], points_.size());
        if (std::find(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(a), nodes[a]) !=
            nodes.begin() + static_cast<std::ptrdiff_t>(a))
            return input_error("a tetrahedron names point {} twice", nodes[a]);
    }
    for (const std::int64_t node : nodes) {
        int& number = index_[static_cast<std::size_t>(node)];
        if (number < 0) {
            number = static_cast<int>(mesh_.points.size());
            mesh_.points.push_back(points_[static_cast<std::size_t>(node)]);
        }
        mesh_.nodes.push_back(number);
    }
    mesh_.region.push_back(region_of_.try_emplace(region, static_cast<int>(region_of_.size())).first->second);
    return {};
}

Result<TetMesh> TetCollector::finish(const std::map<std::int64_t, std::string>& names) {
    if (mesh_.region.empty()) return input_error("holds no tetrahedra");
    mesh_.region_names.resize(region_of_.size());
    for (const auto& [number, region] : region_of_) {
        const auto name = names.find(number);
        mesh_.region_names[static_cast<std::size_t>(region)] =
            name != names.end() && !name->second.empty() ? name->second : fmt::format("{}", number);
    }
    turn_inside_out_tets(mesh_);
    return std::move(mesh_);
}

}  // namespace pliant::mesh
