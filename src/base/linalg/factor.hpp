// The numeric part of a multifrontal factorisation (Duff and Reid 1983), in single or double precision.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/core/array_pool.hpp"
#include "base/core/parallel.hpp"
#include "base/linalg/analysis.hpp"
#include "base/linalg/multifrontal.hpp"
#include "base/linalg/panel.hpp"

namespace pliant::linalg {

/// Real: float or double. Bit-identical on any number of cores.
template <class Real>
class Factor {
public:
    /// `block`: unknowns of each node, 1 or 3.
    Factor(std::shared_ptr<const Analysis> analysis, int block);

    /// False if the matrix is not positive definite in this precision.
    [[nodiscard]] bool factorise(std::span<const double> values);
    /// Solves in place for at most four right-hand sides of nodes * block each, one after the other.
    void solve(double* right_side, int count) const;
    /// Solves in place for at most two fields of three components per node, (count, nodes, 3): each component is a
    /// right-hand side. Precondition: block 1.
    void solve_fields(double* fields, int count) const;

    /// result (unknowns, unknowns) <- these rows and columns of the inverse.
    void inverse_part(std::span<const int> unknowns, double* result) const;

    /// Frees the work space of factorise() and keeps the factor.
    void release_work_space();

    [[nodiscard]] const FrontLayout& layout() const { return layout_; }

private:
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(analysis_->pattern.nodes) * block_; }
    [[nodiscard]] Panel<Real> panel(int s) const;
    [[nodiscard]] std::size_t leading(int s) const;
    /// The updates of the children begin at `below`; its own is written to `above`.
    [[nodiscard]] bool eliminate_supernode(int s, std::span<const double> values, const Real* below, Real* above) const;
    [[nodiscard]] bool eliminate_branch(const FrontLayout::Branch& branch, std::span<const double> values) const;
    template <int b>
    void add_sources(int s, std::span<const double> values) const;

    /// Calls work(k) for all branches in parallel.
    template <class Work>
    void for_branches(const Work& work) const {
        parallel_for(layout_.branches.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) work(k);
        });
    }

    class Sweep;       ///< passes right-hand sides through the tree
    class FieldSweep;  ///< the same for fields
    class InversePart;

    std::shared_ptr<const Analysis> analysis_;
    int block_;
    FrontLayout layout_;
    AlignedArray<Real> factor_;
    AlignedArray<Real> work_;
    mutable ArrayPool<Real> branches_;  ///< work space of each branch in progress
    mutable ArrayPool<Real> scratch_;   ///< work space of solve()
};

extern template class Factor<float>;
extern template class Factor<double>;

}  // namespace pliant::linalg
