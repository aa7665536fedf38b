#include "simulation/distributed/partition.hpp"

#include <petscmat.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/linalg/sparse.hpp"
#include "simulation/distributed/petsc.hpp"

namespace pliant::sim::distributed {
namespace {

static_assert(sizeof(PetscInt) == sizeof(int));

/// Neighbours of each corner of the mesh.
struct Graph {
    std::vector<int> corner;  ///< (nodes of the mesh) index in the graph, or -1
    linalg::Lists neighbours;
    [[nodiscard]] int size() const { return neighbours.count(); }
};

Graph graph_of(const mesh::TetMesh& mesh) {
    Graph graph{std::vector<int>(mesh.points.size(), -1), {}};
    for (std::size_t t = 0; t < mesh.tet_count(); ++t)
        for (const int node : mesh.tet(t).first(4)) graph.corner[static_cast<std::size_t>(node)] = 0;
    int count = 0;
    for (int& corner : graph.corner)
        if (corner == 0) corner = count++;
    linalg::Lists tets;
    tets.item.reserve(4 * mesh.tet_count());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        std::array<int, 4> corners{};
        for (std::size_t k = 0; k < 4; ++k) corners[k] = graph.corner[static_cast<std::size_t>(mesh.tet(t)[k])];
        tets.push_back(corners);
    }
    const linalg::SymmetricPattern lower = linalg::make_pattern(count, 1, tets);
    std::vector<int> degree(static_cast<std::size_t>(count) + 1, 0);
    const auto for_pairs = [&](const auto& visit) {
        for (int j = 0; j < count; ++j)
            for (int k = lower.node_start[static_cast<std::size_t>(j)] + 1;
                 k < lower.node_start[static_cast<std::size_t>(j) + 1]; ++k)
                visit(static_cast<std::size_t>(lower.node_row[static_cast<std::size_t>(k)]),
                      static_cast<std::size_t>(j));
    };
    for_pairs([&](std::size_t i, std::size_t j) { ++degree[i + 1], ++degree[j + 1]; });
    std::partial_sum(degree.begin(), degree.end(), degree.begin());
    graph.neighbours.start = degree;
    graph.neighbours.item.resize(static_cast<std::size_t>(degree.back()));
    for_pairs([&](std::size_t i, std::size_t j) {
        graph.neighbours.item[static_cast<std::size_t>(degree[i]++)] = static_cast<int>(j);
        graph.neighbours.item[static_cast<std::size_t>(degree[j]++)] = static_cast<int>(i);
    });
    return graph;
}

/// First row of each rank (ranks + 1) if all have equally many.
std::vector<int> even_rows(int rows, int ranks) {
    std::vector<int> first(static_cast<std::size_t>(ranks) + 1);
    for (int r = 0; r <= ranks; ++r)
        first[static_cast<std::size_t>(r)] = static_cast<int>(static_cast<long long>(rows) * r / ranks);
    return first;
}

/// This rank's part of root's list, in memory that PETSc takes over.
PetscInt* scattered(const Ranks& ranks, const std::vector<int>& list, const std::vector<int>& first) {
    std::vector<int> counts(static_cast<std::size_t>(ranks.count()));
    for (std::size_t r = 0; r < counts.size(); ++r) counts[r] = first[r + 1] - first[r];
    const int own = counts[static_cast<std::size_t>(ranks.own())];
    PetscInt* piece = nullptr;
    must(PetscMalloc1(static_cast<std::size_t>(own) + 1, &piece));
    must(MPI_Scatterv(list.data(), counts.data(), first.data(), MPI_INT, piece, own, MPI_INT, 0, ranks.comm()));
    return piece;
}

/// This rank's rows of the graph, for the partitioner.
Mat spread_graph(const Ranks& ranks, const Graph& graph, const std::vector<int>& first_row) {
    std::vector<int> first_item(first_row.size(), 0);
    if (ranks.is_root())
        for (std::size_t r = 0; r < first_row.size(); ++r)
            first_item[r] = graph.neighbours.start[static_cast<std::size_t>(first_row[r])];
    must(MPI_Bcast(first_item.data(), static_cast<int>(first_item.size()), MPI_INT, 0, ranks.comm()));
    const auto own = static_cast<std::size_t>(ranks.own());
    const int rows = first_row[own + 1] - first_row[own];
    PetscInt* start = scattered(ranks, graph.neighbours.start, first_row);
    PetscInt* item = scattered(ranks, graph.neighbours.item, first_item);
    for (int k = 0; k < rows; ++k) start[k] -= first_item[own];
    start[rows] = first_item[own + 1] - first_item[own];
    Mat matrix = nullptr;
    must(MatCreateMPIAdj(ranks.comm(), rows, first_row.back(), start, item, nullptr, &matrix));
    return matrix;
}

/// (corners) rank of each, on root.
std::vector<int> cut(const Ranks& ranks, const Graph& graph) {
    int rows = graph.size();
    must(MPI_Bcast(&rows, 1, MPI_INT, 0, ranks.comm()));
    const std::vector<int> first_row = even_rows(rows, ranks.count());
    Owned<Mat, MatDestroy> matrix;
    *matrix.fill() = spread_graph(ranks, graph, first_row);
    Owned<MatPartitioning, MatPartitioningDestroy> partitioning;
    must(MatPartitioningCreate(ranks.comm(), partitioning.fill()));
    must(MatPartitioningSetAdjacency(partitioning.get(), matrix.get()));
    must(MatPartitioningSetType(partitioning.get(), MATPARTITIONINGPTSCOTCH));
    must(MatPartitioningSetFromOptions(partitioning.get()));
    Owned<IS, ISDestroy> owners;
    must(MatPartitioningApply(partitioning.get(), owners.fill()));
    const PetscInt* own = nullptr;
    must(ISGetIndices(owners.get(), &own));
    std::vector<int> counts(static_cast<std::size_t>(ranks.count()));
    for (std::size_t r = 0; r < counts.size(); ++r) counts[r] = first_row[r + 1] - first_row[r];
    std::vector<int> all(ranks.is_root() ? static_cast<std::size_t>(rows) : 0);
    must(MPI_Gatherv(own, counts[static_cast<std::size_t>(ranks.own())], MPI_INT, all.data(), counts.data(),
                     first_row.data(), MPI_INT, 0, ranks.comm()));
    must(ISRestoreIndices(owners.get(), &own));
    return all;
}

}  // namespace

std::vector<int> node_owners(const Ranks& ranks, const mesh::TetMesh& mesh) {
    if (ranks.count() == 1) return std::vector<int>(mesh.points.size(), 0);
    const Graph graph = ranks.is_root() ? graph_of(mesh) : Graph{};
    const std::vector<int> of_corner = cut(ranks, graph);
    if (!ranks.is_root()) return {};
    std::vector<int> owner(mesh.points.size(), 0);  // nodes without tets are root's
    for (std::size_t n = 0; n < owner.size(); ++n)
        if (graph.corner[n] >= 0) owner[n] = of_corner[static_cast<std::size_t>(graph.corner[n])];
    for (std::size_t t = 0; mesh.order == 2 && t < mesh.tet_count(); ++t) {
        for (std::size_t e = 0; e < 6; ++e) {
            const auto middle = static_cast<std::size_t>(mesh.tet(t)[4 + e]);
            const auto& ends = mesh::edge_corners[e];
            const int a = mesh.tet(t)[static_cast<std::size_t>(ends[0])];
            const int b = mesh.tet(t)[static_cast<std::size_t>(ends[1])];
            owner[middle] = owner[static_cast<std::size_t>(middle % 2 == 0 ? std::min(a, b) : std::max(a, b))];
        }
    }
    return owner;
}

}  // namespace pliant::sim::distributed
