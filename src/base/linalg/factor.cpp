#include "base/linalg/factor.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include "base/core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t numbers_to_share = 250000;  // entries of a panel from which clearing is parallel

/// Positions of a supernode's rows in the panel: its own are padded to whole packets, so those below begin with the
/// next packet.
template <class Real>
int panel_row(const Panel<Real>& panel, int unknown) {
    return unknown < panel.columns ? unknown : unknown - panel.columns + panel.first_below();
}

/// Sets all numbers to 0.
template <class Real>
void clear(const Panel<Real>& panel) {
    parallel_for(panel.size(), numbers_to_share, [&](std::size_t begin, std::size_t end) {
        std::fill(panel.values + begin, panel.values + end, Real(0));
    });
}

}  // namespace

template <class Real>
Factor<Real>::Factor(std::shared_ptr<const Analysis> analysis, int block)
    : analysis_(std::move(analysis)), block_(block), layout_(lay_out(analysis_->e, block, packet<Real>)) {}

template <class Real>
Panel<Real> Factor<Real>::panel(int s) const {
    return {factor_.data() + layout_.panel[s], analysis_->e.columns(s) * block_, analysis_->e.rows_below(s) * block_};
}

template <class Real>
std::size_t Factor<Real>::leading(int s) const {
    return static_cast<std::size_t>(whole_packets<Real>(analysis_->e.rows_below(s) * block_));
}

template <class Real>
template <int b>
void Factor<Real>::add_sources(int s, std::span<const double> values) const {
    constexpr std::array<int, 2> strides = {1, b};
    const Panel<Real> p = panel(s);
    for (int k = analysis_->source_start[s]; k < analysis_->source_start[s + 1]; ++k) {
        const Source& source = analysis_->sources[k];
        const double* value = values.data() + static_cast<std::size_t>(source.pair) * b * b;
        const int down = strides[source.transpose];
        const int across = strides[!source.transpose];
        const int row = panel_row(p, source.row * b);
        for (int c = 0; c < b; ++c) {
            for (int r = 0; r < b; ++r)
                *p.at(row + r, source.column * b + c) = static_cast<Real>(value[c * across + r * down]);
        }
    }
}

template <class Real>
bool Factor<Real>::eliminate_supernode(int s, std::span<const double> values, const Real* below, Real* above) const {
    const Panel<Real> p = panel(s);
    clear(p);
    if (block_ == 3)
        add_sources<3>(s, values);
    else
        add_sources<1>(s, values);
    const std::vector<int>& children = analysis_->children[s];
    const auto& stretches = analysis_->stretches;
    for (const int child : children)
        add_to_panel<Real>(below + layout_.update[child], leading(child), stretches[child], block_, p);
    if (!pliant::linalg::factorise(p)) return false;
    Real* update = above + layout_.update[s];
    negative_product(p, update);
    for (const int child : children)
        add_to_update<Real>(below + layout_.update[child], leading(child), stretches[child], block_, p, update);
    return true;
}

template <class Real>
bool Factor<Real>::eliminate_branch(const FrontLayout::Branch& branch, std::span<const double> values) const {
    const auto inside = branches_.lend(layout_.branch_space);
    for (int s = branch.first; s < branch.last; ++s) {
        Real* above = s + 1 < branch.last ? inside.data() : work_.data();
        if (!eliminate_supernode(s, values, inside.data(), above)) return false;
    }
    return true;
}

/// Passes the right-hand sides through the tree: down all branches in parallel, down the trunk, and back. Contributions
/// of a branch to the trunk are summed separately and added in order when all branches are done.
template <class Real>
class Factor<Real>::Sweep {
public:
    Sweep(const Factor& factor, int count)
        : factor_(factor),
          e_(factor.analysis_->e),
          branches_(factor.layout_.branches),
          block_(factor.block_),
          count_(count),
          size_(factor.size()),
          all_(factor.scratch_.lend(size_ * static_cast<std::size_t>(count))),
          handed_(branches_.size()) {}

    void solve(double* x) {
        permute([&](std::size_t given, Real& in_order) { in_order = static_cast<Real>(x[given]); });
        factor_.for_branches([&](std::size_t k) { go_down_branch(k); });
        for (std::size_t k = 0; k < branches_.size(); ++k)
            for_handed(k, all_.data(), [](Real sum, Real& all) { all += sum; });
        Front front;
        const std::vector<int>& trunk = factor_.layout_.trunk;
        for (const int s : trunk) go_down(s, front, e_.row_start[s + 1], nullptr);
        for (auto s = trunk.rbegin(); s != trunk.rend(); ++s) go_up(*s, front);
        factor_.for_branches([&](std::size_t k) {
            Front own;
            for (int s = branches_[k].last - 1; s >= branches_[k].first; --s) go_up(s, own);
        });
        permute([&](std::size_t given, Real& in_order) { x[given] = static_cast<double>(in_order); });
    }

private:
    /// Working data of one supernode.
    struct Front {
        std::vector<Real> own, below;
    };

    template <class Move>
    void permute(const Move& move) {
        for (int c = 0; c < count_; ++c) {
            const std::size_t start = c * size_;
            for (std::size_t node = 0; node < e_.position.size(); ++node) {
                for (int u = 0; u < block_; ++u)
                    move(start + node * block_ + u, all_.data()[start + e_.position[node] * block_ + u]);
            }
        }
    }
    void go_down_branch(std::size_t k) {
        const FrontLayout::Branch& branch = branches_[k];
        const auto sums = factor_.scratch_.lend(size_ * static_cast<std::size_t>(count_));
        handed_[k].resize(static_cast<std::size_t>(e_.rows_below(branch.last - 1) * block_ * count_));
        for_handed(k, sums.data(), [](Real, Real& sum) { sum = 0; });
        Front front;
        for (int s = branch.first; s < branch.last; ++s) {
            const auto rows = e_.row.begin() + e_.row_start[s];
            const auto beyond = std::lower_bound(rows, e_.row.begin() + e_.row_start[s + 1], e_.first[branch.last]);
            go_down(s, front, static_cast<int>(beyond - e_.row.begin()), sums.data());
        }
        for_handed(k, sums.data(), [](Real& handed, Real sum) { handed = sum; });
    }
    /// Calls `use` on the contributions of branch k and the same rows of `full`.
    template <class Use>
    void for_handed(std::size_t k, Real* full, const Use& use) {
        const int root = branches_[k].last - 1;
        for_rows(e_.row_start[root], e_.row_start[root + 1], handed_[k].data(),
                 static_cast<std::size_t>(e_.rows_below(root) * block_), full, use);
    }
    /// Rows from `beyond` on are outside the branch and go to `sums`.
    void go_down(int s, Front& front, int beyond, Real* sums) {
        const Panel<Real> p = factor_.panel(s);
        gather(s, p, front);
        solve_lower(p, count_, front.own.data(), front.below.data());
        put_back(s, p, front);
        const auto subtract = [](Real part, Real& all) { all -= part; };
        const int start = e_.row_start[s], end = e_.row_start[s + 1];
        for_rows(start, beyond, front.below.data(), factor_.leading(s), all_.data(), subtract);
        for_rows(beyond, end, front.below.data() + (beyond - start) * block_, factor_.leading(s), sums, subtract);
    }
    void go_up(int s, Front& front) {
        const Panel<Real> p = factor_.panel(s);
        gather(s, p, front);
        std::fill(front.below.begin(), front.below.end(), Real(0));
        for_rows(e_.row_start[s], e_.row_start[s + 1], front.below.data(), factor_.leading(s), all_.data(),
                 [](Real& part, Real all) { part = all; });
        solve_upper(p, count_, front.own.data(), front.below.data());
        put_back(s, p, front);
    }
    /// Gathers the entries for the columns of s; makes room for those of the rows below.
    void gather(int s, const Panel<Real>& p, Front& front) {
        front.own.resize(static_cast<std::size_t>(p.columns * count_));
        front.below.resize(factor_.leading(s) * static_cast<std::size_t>(count_));
        for (int c = 0; c < count_; ++c)
            std::copy_n(all_.data() + c * size_ + e_.first[s] * block_, p.columns, front.own.data() + c * p.columns);
    }
    void put_back(int s, const Panel<Real>& p, const Front& front) {
        for (int c = 0; c < count_; ++c)
            std::copy_n(front.own.data() + c * p.columns, p.columns, all_.data() + c * size_ + e_.first[s] * block_);
    }
    /// Rows `from` .. `to` in elimination order: those of `part`, one after the other, with their places in `full`.
    /// Right-hand sides are `stride` apart in `part`.
    template <class Use>
    void for_rows(int from, int to, Real* part, std::size_t stride, Real* full, const Use& use) {
        for (int c = 0; c < count_; ++c) {
            Real* mine = part + c * stride;
            Real* all = full + c * size_;
            for (int k = from; k < to; ++k) {
                for (int u = 0; u < block_; ++u) use(*mine++, all[e_.row[k] * block_ + u]);
            }
        }
    }

    const Factor& factor_;
    const Elimination& e_;
    const std::vector<FrontLayout::Branch>& branches_;
    const int block_, count_;
    const std::size_t size_;
    typename ArrayPool<Real>::Loan all_;     ///< (count, size) in elimination order
    std::vector<std::vector<Real>> handed_;  ///< contribution of each branch to the trunk: (count, rows below its last
                                             ///< supernode)
};

template <class Real>
void Factor<Real>::solve(double* right_side, int count) const {
    Sweep(*this, count).solve(right_side);
}

template <class Real>
bool Factor<Real>::factorise(std::span<const double> values) {
    factor_.resize(layout_.panel.back());
    work_.resize(layout_.work_space);
    std::atomic<bool> definite = true;
    parallel_for(layout_.branches.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && definite; ++k) {
            if (!eliminate_branch(layout_.branches[k], values)) definite = false;
        }
    });
    for (const int s : layout_.trunk) {
        if (!definite) return false;
        if (!eliminate_supernode(s, values, work_.data(), work_.data())) definite = false;
    }
    return definite;
}

template <class Real>
void Factor<Real>::release_work_space() {
    work_ = {};
    branches_.clear();
}

template class Factor<float>;
template class Factor<double>;

}  // namespace pliant::linalg
