#include "base/linalg/coarse_space.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "base/linalg/simd_targets.hpp"

using namespace pliant;
using namespace pliant::linalg;

namespace {

/// A lattice of nodes, each coupled to its neighbours along the axes and the diagonals, and one node by itself. The
/// blocks are pseudo-random.
struct Lattice {
    static constexpr int side = 6, nodes = side * side * side + 1;

    Lattice() : pattern(make_pattern(nodes, 3, cliques())), values(pattern.entries()) {
        for (int i = 0; i < nodes; ++i) {
            for (const int place : {i % side, i / side % side, i / side / side})
                positions.push_back(place + 0.1 * std::sin(i));
        }
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = std::sin(12.9898 * static_cast<double>(k) + 1);
        dense = whole(pattern, values);
        inverse_diagonal.resize(9 * nodes);
        for (int i = 0; i < nodes; ++i)
            Eigen::Map<Eigen::Matrix3f>(inverse_diagonal.data() + 9 * static_cast<std::size_t>(i)) =
                dense.block<3, 3>(3 * i, 3 * i).inverse().cast<float>();
    }

    static std::vector<std::vector<int>> cliques() {
        std::vector<std::vector<int>> all;
        for (int i = 0; i + 1 < nodes; ++i) {
            std::vector<int> cell;
            for (const int corner : {0, 1, side, side + 1, side * side, side * side + 1}) {
                if (i + corner + 1 < nodes) cell.push_back(i + corner);
            }
            all.push_back(cell);
        }
        return all;
    }

    /// Of a diagonal block the lower triangle counts.
    static Eigen::MatrixXd whole(const SymmetricPattern& p, std::span<const double> values) {
        Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(3 * p.nodes, 3 * p.nodes);
        for (int j = 0; j < p.nodes; ++j) {
            for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k)
                lower.block<3, 3>(3 * p.node_row[k], 3 * j) =
                    Eigen::Map<const Eigen::Matrix3d>(values.data() + 9 * static_cast<std::size_t>(k));
        }
        return lower.selfadjointView<Eigen::Lower>();
    }

    SymmetricPattern pattern;
    std::vector<double> values, positions;
    std::vector<float> inverse_diagonal;
    Eigen::MatrixXd dense;
};

struct Coarse {
    explicit Coarse(const Lattice& lattice) : blocks(lattice.pattern), space(blocks) {
        blocks.set(lattice.values);
        space.set({blocks, lattice.positions, lattice.inverse_diagonal.data(), 0.3F});
    }
    /// P, one column per coarse unknown.
    [[nodiscard]] Eigen::MatrixXd prolongation() const {
        const int size = space.pattern().size();
        Eigen::MatrixXd P(3 * blocks.nodes(), size);
        for (int c = 0; c < size; ++c) {
            const Eigen::VectorXd unit = Eigen::VectorXd::Unit(size, c);
            Eigen::VectorXf column = Eigen::VectorXf::Zero(P.rows());
            space.add_prolonged(unit.data(), column.data());
            P.col(c) = column.cast<double>();
        }
        return P;
    }
    SymmetricBlocks blocks;
    CoarseSpace space;
};

}  // namespace

TEST_CASE("the coarse matrix is P^T A P, and 1 for rotations that a group of one node has not") {
    const Lattice lattice;
    on_each_simd_target([&](const char* target) {
        CAPTURE(target);
        const Coarse coarse(lattice);
        const Eigen::MatrixXd P = coarse.prolongation();
        Eigen::MatrixXd wanted = P.transpose() * lattice.dense * P;
        int dropped = 0;
        for (Eigen::Index c = 0; c < P.cols(); ++c) {
            if (!P.col(c).isZero(0)) continue;
            wanted(c, c) = 1;
            ++dropped;
        }
        CHECK(dropped == 3);
        CHECK(P.cols() > 6 * 5);
        const Eigen::MatrixXd made = Lattice::whole(coarse.space.pattern(), coarse.space.values());
        CHECK((made - wanted).cwiseAbs().maxCoeff() < 1e-11 * wanted.cwiseAbs().maxCoeff());
    });
}
