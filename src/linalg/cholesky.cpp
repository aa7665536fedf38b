#include "linalg/cholesky.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>

#include "core/aligned_array.hpp"
#include "core/array_pool.hpp"
#include "core/parallel.hpp"
#include "linalg/elimination.hpp"
#include "linalg/multifrontal.hpp"
#include "linalg/panel.hpp"

namespace pliant::linalg {
namespace {

/// Where the blocks of the matrix go, in the order of the supernodes.
struct Source {
    int pair;        ///< of the pattern
    int row;         ///< node, counted from the top of the panel
    int column;      ///< node of the supernode
    bool transpose;  ///< the order of elimination turned the pair round
};

}  // namespace

struct Cholesky::State {
    using Real = double;

    SymmetricPattern pattern;
    Elimination e;
    FrontLayout layout;
    std::vector<Source> sources;
    std::vector<int> source_start;           ///< (supernodes + 1)
    std::vector<std::vector<int>> children;  ///< (supernodes)
    AlignedArray<Real> factor;
    AlignedArray<Real> work;
    mutable ArrayPool<Real> scratch;  ///< of solve()

    [[nodiscard]] Panel<Real> panel(int s) const {
        return {factor.data() + layout.panel[s], e.columns(s) * pattern.block, e.rows_below(s) * pattern.block};
    }
    [[nodiscard]] std::size_t leading(int s) const {
        return static_cast<std::size_t>(whole_packets<Real>(e.rows_below(s) * pattern.block));
    }
    /// Row of a node in the front of s: its own nodes first, then those below.
    [[nodiscard]] int local_row(int s, int node) const {
        if (node < e.first[s + 1]) return node - e.first[s];
        const auto begin = e.row.begin() + e.row_start[s];
        return e.columns(s) +
               static_cast<int>(std::lower_bound(begin, e.row.begin() + e.row_start[s + 1], node) - begin);
    }

    void find_sources();
    [[nodiscard]] bool eliminate_supernode(int s, std::span<const double> values) const;
    template <int block>
    void add_sources(int s, std::span<const double> values) const;
    void add_to_panel(int child, const std::vector<Stretch>& stretches, int s) const;
    void add_to_update(int child, const std::vector<Stretch>& stretches, int s) const;
    [[nodiscard]] std::vector<Stretch> stretches(int child, int s) const;
    void solve(double* right_side, int count) const;
};

void Cholesky::State::find_sources() {
    std::vector<int> supernode_of(e.position.size());
    for (int s = 0; s < e.supernodes(); ++s) std::fill_n(supernode_of.begin() + e.first[s], e.columns(s), s);
    source_start.assign(static_cast<std::size_t>(e.supernodes()) + 1, 0);
    const auto visit = [&](const auto& use) {
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k) {
                const auto [low, high] = std::minmax(e.position[j], e.position[pattern.node_row[k]]);
                use(supernode_of[low], k, low, high, high == e.position[j]);
            }
        }
    };
    visit([&](int s, int, int, int, bool) { ++source_start[s + 1]; });
    for (int s = 0; s < e.supernodes(); ++s) source_start[s + 1] += source_start[s];
    sources.resize(pattern.node_row.size());
    std::vector<int> next(source_start.begin(), source_start.end() - 1);
    visit([&](int s, int k, int low, int high, bool transpose) {
        sources[next[s]++] = {k, local_row(s, high), low - e.first[s], transpose};
    });
}

/// Unknowns of the panel: its own fill whole packets, so those below begin with the next one.
template <class Real>
static int panel_row(const Panel<Real>& panel, int unknown) {
    return unknown < panel.columns ? unknown : unknown - panel.columns + panel.first_below();
}

template <int block>
void Cholesky::State::add_sources(int s, std::span<const double> values) const {
    const Panel<Real> p = panel(s);
    for (int k = source_start[s]; k < source_start[s + 1]; ++k) {
        const Source& source = sources[k];
        const double* value = values.data() + static_cast<std::size_t>(source.pair) * block * block;
        const int down = source.transpose ? block : 1;
        const int across = source.transpose ? 1 : block;
        const int row = panel_row(p, source.row * block);
        for (int c = 0; c < block; ++c) {
            for (int r = 0; r < block; ++r)
                *p.at(row + r, source.column * block + c) = static_cast<Real>(value[c * across + r * down]);
        }
    }
}

std::vector<Stretch> Cholesky::State::stretches(int child, int s) const {
    std::vector<Stretch> result;
    for (int k = 0; k < e.rows_below(child); ++k) {
        const int node = e.row[e.row_start[child] + k];
        if (!result.empty()) {
            Stretch& last = result.back();
            const int next = last.to + last.length;  // row in the front of s
            const bool own = next < e.columns(s);
            if (next != e.columns(s) &&
                (own ? node == e.first[s] + next
                     : next - e.columns(s) < e.rows_below(s) && node == e.row[e.row_start[s] + next - e.columns(s)])) {
                ++last.length;
                continue;
            }
        }
        result.push_back({k, local_row(s, node), 1});
    }
    return result;
}

/// The columns of a child's update that belong to the nodes of its parent.
void Cholesky::State::add_to_panel(int child, const std::vector<Stretch>& parts, int s) const {
    const Panel<Real> p = panel(s);
    const int b = pattern.block;
    const Real* from = work.data() + layout.update[child];
    const std::size_t leading_dimension = leading(child);
    std::vector<std::size_t> place;  // of each row of the child, in column 0 of the panel
    for (const Stretch& part : parts) {
        for (int r = 0; r < part.length * b; ++r)
            place.push_back(static_cast<std::size_t>(p.at(panel_row(p, part.to * b + r), 0) - p.values));
    }
    const int rows = static_cast<int>(place.size());
    for (const Stretch& part : parts) {
        if (part.to >= e.columns(s)) break;
        for (int c = 0; c < part.length * b; ++c) {
            const int first = part.from * b + c;
            const Real* source = from + static_cast<std::size_t>(first) * leading_dimension;
            Real* column = p.at(0, part.to * b + c);
            for (int r = first; r < rows; ++r) column[place[r]] += source[r];
        }
    }
}

/// The other columns, which its parent passes on.
void Cholesky::State::add_to_update(int child, const std::vector<Stretch>& parts, int s) const {
    const int own = e.columns(s);
    const auto passed = std::find_if(parts.begin(), parts.end(), [&](const Stretch& part) { return part.to >= own; });
    const std::vector<Stretch> rest(passed, parts.end());
    add_lower(work.data() + layout.update[child], leading(child), work.data() + layout.update[s], leading(s), rest, own,
              pattern.block);
}

bool Cholesky::State::eliminate_supernode(int s, std::span<const double> values) const {
    const Panel<Real> p = panel(s);
    std::fill_n(p.values, p.size(), Real(0));
    if (pattern.block == 3)
        add_sources<3>(s, values);
    else
        add_sources<1>(s, values);
    std::vector<std::vector<Stretch>> parts;
    for (const int child : children[s]) {
        parts.push_back(stretches(child, s));
        add_to_panel(child, parts.back(), s);
    }
    if (!pliant::linalg::factorise(p)) return false;
    negative_product(p, work.data() + layout.update[s]);
    for (std::size_t k = 0; k < parts.size(); ++k) add_to_update(children[s][k], parts[k], s);
    return true;
}

void Cholesky::State::solve(double* x, int count) const {
    const int b = pattern.block;
    const auto size = static_cast<std::size_t>(pattern.size());
    // In the order of elimination, and one supernode's part of it.
    const auto permuted = scratch.lend(size * static_cast<std::size_t>(count));
    const auto permute = [&](const auto& move) {
        for (int c = 0; c < count; ++c) {
            Real* to = permuted.data() + static_cast<std::size_t>(c) * size;
            double* from = x + static_cast<std::size_t>(c) * size;
            for (int node = 0; node < pattern.nodes; ++node) {
                for (int u = 0; u < b; ++u) move(from[node * b + u], to[e.position[node] * b + u]);
            }
        }
    };
    permute([](double& from, Real& to) { to = static_cast<Real>(from); });
    std::vector<Real> own;
    std::vector<Real> below;
    const auto gather = [&](int s, const Panel<Real>& p) {
        own.resize(static_cast<std::size_t>(p.columns * count));
        below.resize(leading(s) * static_cast<std::size_t>(count));
        for (int c = 0; c < count; ++c)
            std::copy_n(permuted.data() + c * size + e.first[s] * b, p.columns, own.data() + c * p.columns);
    };
    const auto put_back = [&](int s, const Panel<Real>& p) {
        for (int c = 0; c < count; ++c)
            std::copy_n(own.data() + c * p.columns, p.columns, permuted.data() + c * size + e.first[s] * b);
    };
    const auto for_rows = [&](int s, const auto& use) {
        for (int c = 0; c < count; ++c) {
            Real* part = below.data() + c * leading(s);
            Real* all = permuted.data() + c * size;
            for (int k = e.row_start[s]; k < e.row_start[s + 1]; ++k) {
                for (int u = 0; u < b; ++u) use(*part++, all[e.row[k] * b + u]);
            }
        }
    };
    for (int s = 0; s < e.supernodes(); ++s) {
        const Panel<Real> p = panel(s);
        gather(s, p);
        solve_lower(p, count, own.data(), below.data());
        put_back(s, p);
        for_rows(s, [](Real part, Real& all) { all -= part; });
    }
    for (int s = e.supernodes() - 1; s >= 0; --s) {
        const Panel<Real> p = panel(s);
        gather(s, p);
        std::fill(below.begin(), below.end(), Real(0));
        for_rows(s, [](Real& part, Real all) { part = all; });
        solve_upper(p, count, own.data(), below.data());
        put_back(s, p);
    }
    permute([](double& from, Real& to) { from = static_cast<double>(to); });
}

Cholesky::Cholesky(const SymmetricPattern& pattern) : state_(std::make_unique<State>()) {
    state_->pattern = pattern;
    state_->e = eliminate(pattern);
    state_->layout = lay_out(state_->e, pattern.block, packet<State::Real>);
    state_->children.resize(static_cast<std::size_t>(state_->e.supernodes()));
    for (int s = 0; s < state_->e.supernodes(); ++s) {
        if (state_->e.parent[s] >= 0) state_->children[state_->e.parent[s]].push_back(s);
    }
    state_->find_sources();
}

Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;
Cholesky::~Cholesky() = default;

bool Cholesky::factorise(std::span<const double> values) {
    assert(values.size() == state_->pattern.entries());
    State& state = *state_;
    state.factor.resize(state.layout.panel.back());
    state.work.resize(state.layout.work_space);
    std::atomic<bool> definite = true;
    parallel_for(state.layout.branches.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto& branch = state.layout.branches[k];
            for (int s = branch.first; s < branch.last && definite; ++s) {
                if (!state.eliminate_supernode(s, values)) definite = false;
            }
        }
    });
    for (const int s : state.layout.trunk) {
        if (!definite) return false;
        if (!state.eliminate_supernode(s, values)) definite = false;
    }
    return definite;
}

void Cholesky::solve(std::span<double> right_hand_sides, int columns) const {
    const auto n = static_cast<std::size_t>(state_->pattern.size());
    assert(right_hand_sides.size() == n * static_cast<std::size_t>(columns));
    constexpr int together = 4;
    for (int c = 0; c < columns && n > 0; c += together)
        state_->solve(right_hand_sides.data() + static_cast<std::size_t>(c) * n, std::min(together, columns - c));
}

double Cholesky::factor_entries() const {
    return static_cast<double>(state_->layout.panel.back());
}

double Cholesky::factor_work() const {
    return state_->layout.work;
}

}  // namespace pliant::linalg
