#include "base/linalg/sparse.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "base/linalg/simd_targets.hpp"

using namespace pliant::linalg;

namespace {

struct StoredMatrix {
    SymmetricPattern pattern;
    std::vector<double> values;
    Eigen::MatrixXd dense;
};

/// A matrix over this many nodes, of which every other one is coupled to the three after it. The upper triangles of
/// diagonal blocks, which are not used, are wrong.
StoredMatrix some_matrix(int nodes, int block) {
    Lists cliques;
    for (int i = 0; i + 3 < nodes; i += 2) cliques.push_back(std::vector<int>{i, i + 1, i + 3});
    StoredMatrix m{make_pattern(nodes, block, cliques), {}, Eigen::MatrixXd::Zero(nodes * block, nodes * block)};
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int j = 0; j < nodes; ++j) {
        for (int k = m.pattern.node_start[j]; k < m.pattern.node_start[j + 1]; ++k) {
            for (int c = 0; c < block; ++c) {
                for (int r = 0; r < block; ++r) {
                    const int row = m.pattern.node_row[k] * block + r, column = j * block + c;
                    const double value = any(random);
                    m.values.push_back(row >= column ? value : 1e3);
                    if (row >= column) m.dense(row, column) = m.dense(column, row) = value;
                }
            }
        }
    }
    return m;
}

}  // namespace

TEST_CASE("the product of a symmetric matrix is that of the dense one, with every instruction set") {
    on_each_simd_target([&](const char* target) {
        CAPTURE(target);
        for (const int block : {1, 3}) {
            for (const int nodes : {1, 2, 4, 5, 12, 63}) {
                CAPTURE(nodes);
                const StoredMatrix m = some_matrix(nodes, block);
                std::mt19937 random(2);
                std::uniform_real_distribution<double> any(-1, 1);
                Eigen::VectorXd v(m.dense.rows()), sum(m.dense.rows());
                for (double& number : v) number = any(random);
                for (double& number : sum) number = any(random);
                const Eigen::VectorXd wanted = sum - 2.5 * m.dense * v;
                const auto size = static_cast<std::size_t>(v.size());
                add_product(m.pattern, m.values, {v.data(), size}, -2.5, {sum.data(), size});
                CHECK((sum - wanted).cwiseAbs().maxCoeff() < 1e-14 * std::sqrt(static_cast<double>(size)) * 30);
            }
        }
    });
}
