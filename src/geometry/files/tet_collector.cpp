#include "geometry/files/tet_collector.hpp"

#include <algorithm>
#include <utility>

#include "base/core/parallel.hpp"
#include "geometry/files/measurable.hpp"

namespace pliant::mesh {
namespace {

/// The mid-edge nodes of a mesh, by the corners of their edges.
class MidEdgeNodes {
public:
    void set(int a, int b, int node) { nodes_.try_emplace(std::minmax(a, b), node); }

    /// The node between two corners; a new one at the midpoint if there is none.
    int at(int a, int b, std::vector<Vec3>& points) {
        const auto [entry, fresh] = nodes_.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
        if (fresh) points.push_back(0.5 * (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]));
        return entry->second;
    }

private:
    std::map<std::pair<int, int>, int> nodes_;
};

/// Makes one quadratic mesh from tets of 4 nodes (`linear`) and of 10, whose nodes are listed tet by tet.
void raise_linear_tets(TetMesh& mesh, const std::vector<bool>& linear) {
    MidEdgeNodes between;
    std::size_t next = 0;
    for (const bool is_linear : linear) {
        const int* n = mesh.nodes.data() + next;
        for (std::size_t e = 0; e < 6 && !is_linear; ++e)
            between.set(n[edge_corners[e][0]], n[edge_corners[e][1]], n[4 + e]);
        next += is_linear ? 4 : 10;
    }
    std::vector<int> nodes;
    nodes.reserve(10 * linear.size());
    next = 0;
    for (const bool is_linear : linear) {
        const int* n = mesh.nodes.data() + next;
        nodes.insert(nodes.end(), n, n + (is_linear ? 4 : 10));
        for (std::size_t e = 0; e < 6 && is_linear; ++e)
            nodes.push_back(between.at(n[edge_corners[e][0]], n[edge_corners[e][1]], mesh.points));
        next += is_linear ? 4 : 10;
    }
    mesh.nodes = std::move(nodes);
    mesh.notes.push_back(fmt::format("{} of {} tets have 4 nodes and the others 10: all were given 10",
                                     std::count(linear.begin(), linear.end(), true), linear.size()));
}

void turn_inside_out_tets(TetMesh& mesh) {
    constexpr std::size_t grain = 16384;
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    const double sum = parallel_sum(mesh.tet_count(), grain, [&](std::size_t begin, std::size_t end) {
        double found = 0;
        for (std::size_t t = begin; t < end; ++t) {
            int* n = mesh.nodes.data() + t * width;
            if (signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]) >= 0)
                continue;
            ++found;
            reverse_tet({n, width});
        }
        return found;
    });
    const auto turned = static_cast<std::size_t>(sum);
    if (turned > 0)
        mesh.notes.push_back(fmt::format("{} of {} tets were inside out and were turned", turned, mesh.tet_count()));
}

}  // namespace

void TetCollector::reserve(std::size_t tets, std::size_t nodes) {
    mesh_.nodes.reserve(nodes);
    mesh_.region.reserve(tets);
    mesh_.points.reserve(points_.size());
    linear_.reserve(tets);
}

Status TetCollector::add(std::span<const std::int64_t> nodes, std::int64_t region) {
    if (nodes.size() != 4 && nodes.size() != 10) return input_error("a tetrahedron has {} nodes", nodes.size());
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
            const Vec3& p = points_[static_cast<std::size_t>(node)];
            if (!is_measurable(p))
                return input_error("point {} lies at ({:g}, {:g}, {:g}): {}", node, p.x, p.y, p.z, too_far);
            number = static_cast<int>(mesh_.points.size());
            mesh_.points.push_back(p);
        }
        mesh_.nodes.push_back(number);
    }
    linear_.push_back(nodes.size() == 4);
    if (nodes.size() == 10) mesh_.order = 2;
    // Consecutive tets are mostly in the same region.
    const bool as_before = !mesh_.region.empty() && region == last_region_;
    mesh_.region.push_back(as_before
                               ? mesh_.region.back()
                               : region_of_.try_emplace(region, static_cast<int>(region_of_.size())).first->second);
    last_region_ = region;
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
    if (mesh_.order == 2 && std::find(linear_.begin(), linear_.end(), true) != linear_.end())
        raise_linear_tets(mesh_, linear_);
    turn_inside_out_tets(mesh_);
    return std::move(mesh_);
}

}  // namespace pliant::mesh
