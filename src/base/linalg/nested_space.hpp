// Coarse space for quadratic tets: the linear tets on the same corners. A mid-edge node moves as the mean of the edge's
// ends. The nodes of the coarse level are the corners (p-multigrid: Ronquist and Patera 1987).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/linalg/coarse_level.hpp"
#include "base/linalg/nested_products.hpp"

namespace pliant::linalg {

/// (fine nodes) the two coarse nodes whose mean each one is; the same twice for a node of the coarse level itself; -1:
/// an end that does not move.
struct Nesting {
    int coarse_nodes = 0;
    std::vector<std::array<int, 2>> ends;
};

class NestedSpace final : public CoarseLevel {
public:
    /// `fine`: pattern of the matrix; its points, if present, give the positions of the coarse nodes. Preconditions:
    /// blocks of 3, and each coarse node is one of the fine ones.
    NestedSpace(const SymmetricPattern& fine, Nesting nesting);

    void set(const Fine& fine) override;
    [[nodiscard]] bool turn(std::span<const double>) override { return false; }
    [[nodiscard]] bool turn_back() override { return false; }
    [[nodiscard]] const SymmetricPattern& pattern() const override { return pattern_; }
    [[nodiscard]] std::span<const double> values() const override { return coarse_; }
    [[nodiscard]] std::span<const double> positions() const override { return positions_; }
    void restrict(const float* fine, double* coarse) override;
    void add_prolonged(const double* coarse, float* fine) const override;

private:
    /// Work space for one column.
    struct ColumnSums {
        std::vector<int> place;    ///< (coarse nodes) of each node among those coupled to the column's
        std::vector<double> sums;  ///< (places, 9)
    };
    void find_pattern(const SymmetricPattern& fine);
    void make_column(const LowerTriangle& matrix, std::size_t c, ColumnSums& column);
    [[nodiscard]] Followers followers() const { return {nesting_.ends.data()}; }
    [[nodiscard]] double share(int fine) const { return followers().share(fine); }

    Nesting nesting_;
    SymmetricPattern pattern_;
    Lists on_;                 ///< (coarse nodes) fine nodes that depend on each
    std::vector<int> corner_;  ///< (coarse nodes) the fine node at the same place
    std::vector<double> positions_;
    LeftBlocks left_;
    std::vector<double> coarse_, mirrored_;  ///< (entries of the pattern)
};

}  // namespace pliant::linalg
