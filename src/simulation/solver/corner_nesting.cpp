#include "simulation/solver/corner_nesting.hpp"

#include <array>
#include <vector>

namespace pliant::sim {

std::optional<linalg::Nesting> nest_in_corners(const Model& model) {
    const mesh::TetMesh& mesh = model.mesh();
    if (mesh.order == 1) return std::nullopt;
    constexpr std::array<int, 2> itself = {-1, -1};
    std::vector<std::array<int, 2>> between(static_cast<std::size_t>(model.node_count()), itself);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto nodes = mesh.tet(t);
        for (std::size_t e = 0; e < mesh::edge_corners.size(); ++e) {
            const auto& [a, b] = mesh::edge_corners[e];
            between[static_cast<std::size_t>(nodes[4 + e])] = {nodes[static_cast<std::size_t>(a)],
                                                               nodes[static_cast<std::size_t>(b)]};
        }
    }
    const std::vector<int>& free = model.free_index();
    linalg::Nesting nesting;
    std::vector<int> coarse(between.size(), -1);
    for (std::size_t node = 0; node < between.size(); ++node) {
        if (free[node] >= 0 && between[node] == itself) coarse[node] = nesting.coarse_nodes++;
    }
    nesting.ends.resize(static_cast<std::size_t>(model.free_count()));
    for (std::size_t node = 0; node < between.size(); ++node) {
        if (free[node] < 0) continue;
        auto& ends = nesting.ends[static_cast<std::size_t>(free[node])];
        ends = {coarse[node], coarse[node]};
        if (between[node] == itself) continue;
        for (std::size_t k = 0; k < 2; ++k) ends[k] = coarse[static_cast<std::size_t>(between[node][k])];
    }
    return nesting;
}

}  // namespace pliant::sim
