#include "linalg/factor.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/parallel.hpp"

namespace pliant::linalg {
namespace {

/// Unknowns of the panel: its own fill whole packets, so those below begin with the next one.
template <class Real>
int panel_row(const Panel<Real>& panel, int unknown) {
    return unknown < panel.columns ? unknown : unknown - panel.columns + panel.first_below();
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
    const Panel<Real> p = panel(s);
    for (int k = analysis_->source_start[s]; k < analysis_->source_start[s + 1]; ++k) {
        const Source& source = analysis_->sources[k];
        const double* value = values.data() + static_cast<std::size_t>(source.pair) * b * b;
        const int down = source.transpose ? b : 1;
        const int across = source.transpose ? 1 : b;
        const int row = panel_row(p, source.row * b);
        for (int c = 0; c < b; ++c) {
            for (int r = 0; r < b; ++r)
                *p.at(row + r, source.column * b + c) = static_cast<Real>(value[c * across + r * down]);
        }
    }
}

/// The columns of a child's update that belong to the nodes of its parent.
template <class Real>
void Factor<Real>::add_to_panel(int child, const Real* update, const std::vector<Stretch>& parts, int s) const {
    const Panel<Real> p = panel(s);
    const int b = block_;
    const std::size_t leading_dimension = leading(child);
    std::vector<std::size_t> place;  // of each row of the child, in column 0 of the panel
    for (const Stretch& part : parts) {
        for (int r = 0; r < part.length * b; ++r)
            place.push_back(static_cast<std::size_t>(p.at(panel_row(p, part.to * b + r), 0) - p.values));
    }
    const int rows = static_cast<int>(place.size());
    for (const Stretch& part : parts) {
        if (part.to >= analysis_->e.columns(s)) break;
        for (int c = 0; c < part.length * b; ++c) {
            const int first = part.from * b + c;
            const Real* source = update + static_cast<std::size_t>(first) * leading_dimension;
            Real* column = p.at(0, part.to * b + c);
            for (int r = first; r < rows; ++r) column[place[r]] += source[r];
        }
    }
}

/// The other columns, which its parent passes on.
template <class Real>
void Factor<Real>::add_to_update(int child, const Real* update, const std::vector<Stretch>& parts, int s,
                                 Real* to) const {
    const int own = analysis_->e.columns(s);
    const auto passed = std::find_if(parts.begin(), parts.end(), [&](const Stretch& part) { return part.to >= own; });
    const std::vector<Stretch> rest(passed, parts.end());
    add_lower(update, leading(child), to, leading(s), rest, own, block_);
}

template <class Real>
bool Factor<Real>::eliminate_supernode(int s, std::span<const double> values, const Real* below, Real* above) const {
    const Panel<Real> p = panel(s);
    std::fill_n(p.values, p.size(), Real(0));
    if (block_ == 3)
        add_sources<3>(s, values);
    else
        add_sources<1>(s, values);
    const std::vector<int>& children = analysis_->children[s];
    std::vector<std::vector<Stretch>> parts;
    for (const int child : children) {
        parts.push_back(analysis_->stretches(child, s));
        add_to_panel(child, below + layout_.update[child], parts.back(), s);
    }
    if (!pliant::linalg::factorise(p)) return false;
    Real* update = above + layout_.update[s];
    negative_product(p, update);
    for (std::size_t k = 0; k < parts.size(); ++k)
        add_to_update(children[k], below + layout_.update[children[k]], parts[k], s, update);
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

template <class Real>
class Factor<Real>::Sweep {
public:
    Sweep(const Factor& factor, int count)
        : factor_(factor),
          e_(factor.analysis_->e),
          block_(factor.block_),
          count_(count),
          size_(factor.size()),
          all_(factor.scratch_.lend(size_ * static_cast<std::size_t>(count))) {}

    void take(const double* x) {
        permute([&](std::size_t given, Real& in_order) { in_order = static_cast<Real>(x[given]); });
    }
    void give(double* x) {
        permute([&](std::size_t given, Real& in_order) { x[given] = static_cast<double>(in_order); });
    }
    void go_down(int s) {
        const Panel<Real> p = factor_.panel(s);
        gather(s, p);
        solve_lower(p, count_, own_.data(), below_.data());
        put_back(s, p);
        for_rows(s, [](Real part, Real& all) { all -= part; });
    }
    void go_up(int s) {
        const Panel<Real> p = factor_.panel(s);
        gather(s, p);
        std::fill(below_.begin(), below_.end(), Real(0));
        for_rows(s, [](Real& part, Real all) { part = all; });
        solve_upper(p, count_, own_.data(), below_.data());
        put_back(s, p);
    }

private:
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
    /// What belongs to the columns of s; makes room for what belongs to the rows below.
    void gather(int s, const Panel<Real>& p) {
        own_.resize(static_cast<std::size_t>(p.columns * count_));
        below_.resize(factor_.leading(s) * static_cast<std::size_t>(count_));
        for (int c = 0; c < count_; ++c)
            std::copy_n(all_.data() + c * size_ + e_.first[s] * block_, p.columns, own_.data() + c * p.columns);
    }
    void put_back(int s, const Panel<Real>& p) {
        for (int c = 0; c < count_; ++c)
            std::copy_n(own_.data() + c * p.columns, p.columns, all_.data() + c * size_ + e_.first[s] * block_);
    }
    template <class Use>
    void for_rows(int s, const Use& use) {
        for (int c = 0; c < count_; ++c) {
            Real* part = below_.data() + c * factor_.leading(s);
            Real* all = all_.data() + c * size_;
            for (int k = e_.row_start[s]; k < e_.row_start[s + 1]; ++k) {
                for (int u = 0; u < block_; ++u) use(*part++, all[e_.row[k] * block_ + u]);
            }
        }
    }

    const Factor& factor_;
    const Elimination& e_;
    const int block_, count_;
    const std::size_t size_;
    typename ArrayPool<Real>::Loan all_;  ///< (count, size) in the order of elimination
    std::vector<Real> own_, below_;       ///< of one supernode
};

template <class Real>
void Factor<Real>::solve(double* right_side, int count) const {
    Sweep sweep(*this, count);
    sweep.take(right_side);
    const int supernodes = analysis_->e.supernodes();
    for (int s = 0; s < supernodes; ++s) sweep.go_down(s);
    for (int s = supernodes - 1; s >= 0; --s) sweep.go_up(s);
    sweep.give(right_side);
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
