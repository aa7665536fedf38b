#include "simulation/distributed/known_pattern.hpp"

#include <numeric>

namespace pliant::sim::distributed {

KnownPattern known_pattern(const Balance& balance) {
    KnownPattern known;
    const auto nodes = static_cast<int>(balance.all_nodes().size());
    known.pattern = linalg::make_pattern(nodes, 3, balance.cliques());
    known.sums = balance.elements().block_sums(balance.all_nodes(), known.pattern);
    const std::vector<char>& fixed = balance.share().fixed;
    const auto for_places = [&](const auto& visit) {
        for (int j = 0; j < nodes; ++j) {
            for (int k = known.pattern.node_start[static_cast<std::size_t>(j)];
                 k < known.pattern.node_start[static_cast<std::size_t>(j) + 1]; ++k) {
                const int i = known.pattern.node_row[static_cast<std::size_t>(k)];
                if (fixed[static_cast<std::size_t>(i)] != 0 || fixed[static_cast<std::size_t>(j)] != 0) continue;
                visit(i, KnownPattern::Place{k, j, false});
                if (i != j) visit(j, KnownPattern::Place{k, i, true});
            }
        }
    };
    known.row_start.assign(static_cast<std::size_t>(nodes) + 1, 0);
    for_places([&](int row, const KnownPattern::Place&) { ++known.row_start[static_cast<std::size_t>(row) + 1]; });
    std::partial_sum(known.row_start.begin(), known.row_start.end(), known.row_start.begin());
    known.places.resize(static_cast<std::size_t>(known.row_start.back()));
    std::vector<int> next(known.row_start.begin(), known.row_start.end() - 1);
    for_places([&](int row, const KnownPattern::Place& place) {
        known.places[static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++)] = place;
    });
    return known;
}

Owned<Mat, MatDestroy> make_matrix(const Balance& balance, int block, const std::function<void(Mat)>& add) {
    const auto own = static_cast<PetscInt>(balance.share().owned) * block;
    const auto make = [&](MatType type) {
        Owned<Mat, MatDestroy> matrix;
        must(MatCreate(balance.ranks().comm(), matrix.fill()));
        must(MatSetSizes(matrix.get(), own, own, PETSC_DETERMINE, PETSC_DETERMINE));
        must(MatSetBlockSize(matrix.get(), block));
        must(MatSetType(matrix.get(), type));
        return matrix;
    };
    const auto fill = [&](Mat matrix) {
        add(matrix);
        must(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
        must(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
    };
    const Owned<Mat, MatDestroy> counter = make(MATPREALLOCATOR);
    must(MatSetUp(counter.get()));
    fill(counter.get());
    Owned<Mat, MatDestroy> matrix = make(MATAIJ);
    must(MatPreallocatorPreallocate(counter.get(), PETSC_TRUE, matrix.get()));
    must(MatSetOption(matrix.get(), MAT_NEW_NONZERO_LOCATION_ERR, PETSC_TRUE));
    fill(matrix.get());
    return matrix;
}

}  // namespace pliant::sim::distributed
