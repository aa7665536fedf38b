#include "simulation/distributed/local_pattern.hpp"

#include <numeric>

namespace pliant::sim::distributed {

LocalPattern local_pattern(const DistributedEquilibrium& system) {
    LocalPattern local;
    const auto nodes = static_cast<int>(system.all_nodes().size());
    local.pattern = linalg::make_pattern(nodes, 3, system.cliques());
    local.sums = system.elements().block_sums(system.all_nodes(), local.pattern);
    const std::vector<char>& fixed = system.share().fixed;
    const auto for_places = [&](const auto& visit) {
        for (int j = 0; j < nodes; ++j) {
            for (int k = local.pattern.node_start[static_cast<std::size_t>(j)];
                 k < local.pattern.node_start[static_cast<std::size_t>(j) + 1]; ++k) {
                const int i = local.pattern.node_row[static_cast<std::size_t>(k)];
                if (fixed[static_cast<std::size_t>(i)] != 0 || fixed[static_cast<std::size_t>(j)] != 0) continue;
                visit(i, LocalPattern::Place{k, j, false});
                if (i != j) visit(j, LocalPattern::Place{k, i, true});
            }
        }
    };
    local.row_start.assign(static_cast<std::size_t>(nodes) + 1, 0);
    for_places([&](int row, const LocalPattern::Place&) { ++local.row_start[static_cast<std::size_t>(row) + 1]; });
    std::partial_sum(local.row_start.begin(), local.row_start.end(), local.row_start.begin());
    local.places.resize(static_cast<std::size_t>(local.row_start.back()));
    std::vector<int> next(local.row_start.begin(), local.row_start.end() - 1);
    for_places([&](int row, const LocalPattern::Place& place) {
        local.places[static_cast<std::size_t>(next[static_cast<std::size_t>(row)]++)] = place;
    });
    return local;
}

Owned<Mat, MatDestroy> make_matrix(const DistributedEquilibrium& system, int block,
                                   const std::function<void(Mat)>& add) {
    const auto own = static_cast<PetscInt>(system.share().owned) * block;
    const auto make = [&](MatType type) {
        Owned<Mat, MatDestroy> matrix;
        must(MatCreate(system.ranks().comm(), matrix.fill()));
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
