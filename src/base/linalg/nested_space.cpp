#include "base/linalg/nested_space.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>
#include <utility>

#include "base/core/parallel.hpp"

namespace pliant::linalg {
namespace {

constexpr std::size_t grain = 1024;
constexpr std::size_t pieces = 4;  // of the fine pairs, with separate sums

/// Calls visit(pair, column, a, b) for each pair of fine nodes, each moving end a of its row and b of its column.
template <class Visit>
void for_pairs(const SymmetricPattern& fine, const Nesting& nesting, const Visit& visit) {
    for (int j = 0; j < fine.nodes; ++j) {
        for (int k = fine.node_start[j]; k < fine.node_start[j + 1]; ++k) {
            for (const int a : nesting.ends[static_cast<std::size_t>(fine.node_row[k])]) {
                for (const int b : nesting.ends[static_cast<std::size_t>(j)]) {
                    if (a >= 0 && b >= 0) visit(k, j, a, b);
                }
            }
        }
    }
}

}  // namespace

NestedSpace::NestedSpace(const SymmetricPattern& fine, Nesting nesting) : nesting_(std::move(nesting)) {
    find_pattern(fine);
    find_uses(fine);
    coarse_.resize(pattern_.entries());
    sums_.resize(pieces * coarse_.size());
}

void NestedSpace::find_pattern(const SymmetricPattern& fine) {
    const auto ends_of = [&](int node) -> const std::array<int, 2>& {
        return nesting_.ends[static_cast<std::size_t>(node)];
    };
    const auto coarse = static_cast<std::size_t>(nesting_.coarse_nodes);
    std::vector<std::vector<int>> on(coarse), later(coarse);
    std::vector<int> own(coarse, 0);
    for (int i = 0; i < fine.nodes; ++i) {
        const auto [a, b] = ends_of(i);
        if (a == b && a >= 0) own[static_cast<std::size_t>(a)] = i;
        if (a >= 0) on[static_cast<std::size_t>(a)].push_back(i);
        if (b >= 0 && b != a) on[static_cast<std::size_t>(b)].push_back(i);
    }
    on_ = Lists(on);
    for_pairs(fine, nesting_, [&](int, int, int a, int b) {
        std::vector<int>& rows = later[static_cast<std::size_t>(std::min(a, b))];
        const auto place = std::lower_bound(rows.begin(), rows.end(), std::max(a, b));
        if (a != b && (place == rows.end() || *place != std::max(a, b))) rows.insert(place, std::max(a, b));
    });
    pattern_.block = 3;
    pattern_.nodes = nesting_.coarse_nodes;
    pattern_.node_start.assign(1, 0);
    for (std::size_t c = 0; c < coarse; ++c) {
        pattern_.node_row.push_back(static_cast<int>(c));
        pattern_.node_row.insert(pattern_.node_row.end(), later[c].begin(), later[c].end());
        pattern_.node_start.push_back(static_cast<int>(pattern_.node_row.size()));
        if (!fine.points.empty()) pattern_.points.push_back(fine.points[static_cast<std::size_t>(own[c])]);
    }
}

void NestedSpace::find_uses(const SymmetricPattern& fine) {
    std::vector<int> count(fine.node_row.size() + 1, 0);
    for_pairs(fine, nesting_, [&](int pair, int row, int a, int b) {
        const bool diagonal = pair == fine.node_start[row];
        if (diagonal && a < b) return;  // the upper triangle of a diagonal block
        const Use use{pattern_.find(std::max(a, b), std::min(a, b)), 0.25F,
                      diagonal ? Use::symmetric
                      : a == b ? Use::both
                      : a > b  ? Use::as_it_is
                               : Use::transposed};
        int& used = count[static_cast<std::size_t>(pair) + 1];
        const auto known = std::find_if(use_.end() - used, use_.end(), [&](const Use& other) {
            return other.target == use.target && other.kind == use.kind;
        });
        if (known != use_.end()) {
            known->share += use.share;
            return;
        }
        use_.push_back(use);
        ++used;
    });
    use_start_.resize(count.size());
    std::partial_sum(count.begin(), count.end(), use_start_.begin());
}

void NestedSpace::set(const Fine& fine) {
    using Block = Eigen::Matrix3d;
    const std::size_t size = coarse_.size(), pairs = use_start_.size() - 1;
    const std::size_t piece = (pairs + pieces - 1) / pieces;
    parallel_for(pairs, piece, [&](std::size_t begin, std::size_t end) {
        double* sums = sums_.data() + begin / piece * size;
        std::fill_n(sums, size, 0.0);
        for (std::size_t k = begin; k < end; ++k) {
            const Eigen::Map<const Block> block(fine.values.data() + 9 * k);
            for (int u = use_start_[k]; u < use_start_[k + 1]; ++u) {
                const Use& use = use_[static_cast<std::size_t>(u)];
                Eigen::Map<Block> sum(sums + 9 * static_cast<std::size_t>(use.target));
                const auto share = static_cast<double>(use.share);
                if (use.kind == Use::symmetric) {
                    sum += share * Block(block.selfadjointView<Eigen::Lower>());
                    continue;
                }
                if (use.kind != Use::transposed) sum += share * block;
                if (use.kind != Use::as_it_is) sum += share * block.transpose();
            }
        }
    });
    const std::size_t used = (pairs + piece - 1) / piece;
    parallel_for(size, 9 * grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            coarse_[k] = sums_[k];
            for (std::size_t p = 1; p < used; ++p) coarse_[k] += sums_[p * size + k];
        }
    });
}

void NestedSpace::restrict(const float* fine, double* coarse) {
    parallel_for(static_cast<std::size_t>(nesting_.coarse_nodes), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            std::array<float, 3> sum{};
            for (const int i : on_[c]) {
                const auto& ends = nesting_.ends[static_cast<std::size_t>(i)];
                const float share = ends[0] == ends[1] ? 1.0F : 0.5F;
                for (std::size_t k = 0; k < 3; ++k) sum[k] += share * fine[3 * static_cast<std::size_t>(i) + k];
            }
            for (std::size_t k = 0; k < 3; ++k) coarse[3 * c + k] = static_cast<double>(sum[k]);
        }
    });
}

void NestedSpace::add_prolonged(const double* coarse, float* fine) const {
    parallel_for(nesting_.ends.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            for (const int c : nesting_.ends[i]) {
                for (std::size_t k = 0; c >= 0 && k < 3; ++k)
                    fine[3 * i + k] += static_cast<float>(0.5 * coarse[3 * static_cast<std::size_t>(c) + k]);
            }
        }
    });
}

}  // namespace pliant::linalg
