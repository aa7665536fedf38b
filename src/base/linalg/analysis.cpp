#include "base/linalg/analysis.hpp"

#include <algorithm>
#include <utility>

#include "base/core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t supernodes_at_once = 64;  // in a parallel piece

void find_sources(Analysis& a) {
    const Elimination& e = a.e;
    const SymmetricPattern& pattern = a.pattern;
    std::vector<int> supernode_of(e.position.size());
    for (int s = 0; s < e.supernodes(); ++s) std::fill_n(supernode_of.begin() + e.first[s], e.columns(s), s);
    a.source_start.assign(static_cast<std::size_t>(e.supernodes()) + 1, 0);
    const auto visit = [&](const auto& use) {
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[j]; k < pattern.node_start[j + 1]; ++k) {
                const auto [low, high] = std::minmax(e.position[j], e.position[pattern.node_row[k]]);
                use(supernode_of[low], k, low, high, high == e.position[j]);
            }
        }
    };
    visit([&](int s, int, int, int, bool) { ++a.source_start[s + 1]; });
    for (int s = 0; s < e.supernodes(); ++s) a.source_start[s + 1] += a.source_start[s];
    a.sources.resize(pattern.node_row.size());
    std::vector<int> next(a.source_start.begin(), a.source_start.end() - 1);
    visit([&](int s, int k, int low, int high, bool transpose) {
        a.sources[next[s]++] = {k, high, low - e.first[s], transpose};
    });
    parallel_for(static_cast<std::size_t>(e.supernodes()), supernodes_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            for (int k = a.source_start[s]; k < a.source_start[s + 1]; ++k)
                a.sources[k].row = a.local_row(static_cast<int>(s), a.sources[k].row);
        }
    });
}

/// Positions of the rows below a child in the front of its parent s.
std::vector<Stretch> stretches_of(const Analysis& a, int child, int s) {
    const Elimination& e = a.e;
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
        result.push_back({k, a.local_row(s, node), 1});
    }
    return result;
}

}  // namespace

int Analysis::local_row(int s, int node) const {
    if (node < e.first[s + 1]) return node - e.first[s];
    const auto begin = e.row.begin() + e.row_start[s];
    return e.columns(s) + static_cast<int>(std::lower_bound(begin, e.row.begin() + e.row_start[s + 1], node) - begin);
}

std::shared_ptr<const Analysis> analyse(const SymmetricPattern& pattern) {
    Analysis a{pattern, eliminate(pattern), {}, {}, {}, {}};
    a.pattern.block = 1;
    a.pattern.points = {};
    a.children.resize(static_cast<std::size_t>(a.e.supernodes()));
    for (int s = 0; s < a.e.supernodes(); ++s) {
        const int parent = a.e.parent[s];
        if (parent >= 0) a.children[parent].push_back(s);
    }
    a.stretches.resize(a.children.size());
    parallel_for(a.stretches.size(), supernodes_at_once, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
            const int parent = a.e.parent[s];
            if (parent >= 0) a.stretches[s] = stretches_of(a, static_cast<int>(s), parent);
        }
    });
    find_sources(a);
    return std::make_shared<const Analysis>(std::move(a));
}

}  // namespace pliant::linalg
