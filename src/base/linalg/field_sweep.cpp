#include <algorithm>
#include <vector>

#include "base/linalg/factor.hpp"

namespace pliant::linalg {

/// As Sweep, but right-hand sides are interleaved, `lanes` of them per unknown: the columns of a supernode are then
/// contiguous, and each number of the factor is read once for all. With one unknown per node panels are narrow, and the
/// overhead of Sweep would exceed the arithmetic.
template <class Real>
class Factor<Real>::FieldSweep {
public:
    explicit FieldSweep(const Factor& factor)
        : factor_(factor),
          e_(factor.analysis_->e),
          branches_(factor.layout_.branches),
          all_(factor.scratch_.lend(factor.size() * lanes)),
          handed_(branches_.size()) {}

    void solve(double* fields, int count) {
        take(fields, count);
        factor_.for_branches([&](std::size_t k) { go_down_branch(k); });
        for (std::size_t k = 0; k < branches_.size(); ++k) {
            const auto rows = rows_below(branches_[k].last - 1);
            for (std::size_t r = 0; r < rows.size(); ++r) add(handed_[k].data() + r * lanes, row(all_.data(), rows[r]));
        }
        const std::vector<int>& trunk = factor_.layout_.trunk;
        for (const int s : trunk) go_down(s, all_.data(), 0);
        for (auto s = trunk.rbegin(); s != trunk.rend(); ++s) go_up(*s);
        factor_.for_branches([&](std::size_t k) {
            for (int s = branches_[k].last - 1; s >= branches_[k].first; --s) go_up(s);
        });
        give(fields, count);
    }

private:
    static void add(const Real* from, Real* to) {
        for (int l = 0; l < lanes; ++l) to[l] += from[l];
    }
    static Real* row(Real* all, int position) { return all + static_cast<std::size_t>(position) * lanes; }
    [[nodiscard]] std::span<const int> rows_below(int s) const {
        return std::span(e_.row).subspan(static_cast<std::size_t>(e_.row_start[s]),
                                         static_cast<std::size_t>(e_.rows_below(s)));
    }

    void take(const double* fields, int count) {
        const std::size_t nodes = e_.position.size();
        for (std::size_t node = 0; node < nodes; ++node) {
            Real* to = row(all_.data(), e_.position[node]);
            std::fill_n(to, lanes, Real(0));
            for (int c = 0; c < count; ++c) {
                for (std::size_t i = 0; i < 3; ++i)
                    to[3 * c + i] = static_cast<Real>(fields[3 * (c * nodes + node) + i]);
            }
        }
    }
    void give(double* fields, int count) {
        const std::size_t nodes = e_.position.size();
        for (std::size_t node = 0; node < nodes; ++node) {
            const Real* from = row(all_.data(), e_.position[node]);
            for (int c = 0; c < count; ++c) {
                for (std::size_t i = 0; i < 3; ++i)
                    fields[3 * (c * nodes + node) + i] = static_cast<double>(from[3 * c + i]);
            }
        }
    }

    void go_down_branch(std::size_t k) {
        const FrontLayout::Branch& branch = branches_[k];
        const auto sums = factor_.scratch_.lend(factor_.size() * lanes);
        const auto rows = rows_below(branch.last - 1);
        for (const int position : rows) std::fill_n(row(sums.data(), position), lanes, Real(0));
        for (int s = branch.first; s < branch.last; ++s) go_down(s, sums.data(), e_.first[branch.last]);
        handed_[k].resize(rows.size() * lanes);
        for (std::size_t r = 0; r < rows.size(); ++r)
            std::copy_n(row(sums.data(), rows[r]), lanes, handed_[k].data() + r * lanes);
    }
    /// Rows from `limit` on are outside the branch and go to `beyond`.
    void go_down(int s, Real* beyond, int limit) {
        solve_lower_lanes(factor_.panel(s), row(all_.data(), e_.first[s]),
                          LaneRows<Real>{rows_below(s).data(), all_.data(), beyond, limit});
    }
    void go_up(int s) {
        solve_upper_lanes(factor_.panel(s), row(all_.data(), e_.first[s]),
                          LaneRows<Real>{rows_below(s).data(), all_.data(), all_.data(), 0});
    }

    const Factor& factor_;
    const Elimination& e_;
    const std::vector<FrontLayout::Branch>& branches_;
    typename ArrayPool<Real>::Loan all_;     ///< (size, lanes) in elimination order
    std::vector<std::vector<Real>> handed_;  ///< contribution of each branch to the trunk: (rows below its last
                                             ///< supernode, lanes)
};

template <class Real>
void Factor<Real>::solve_fields(double* fields, int count) const {
    FieldSweep(*this).solve(fields, count);
}

template void Factor<float>::solve_fields(double*, int) const;
template void Factor<double>::solve_fields(double*, int) const;

}  // namespace pliant::linalg
