#include <algorithm>
#include <numeric>
#include <vector>

#include "base/core/aligned_array.hpp"
#include "base/linalg/factor.hpp"

namespace pliant::linalg {

/// With A = L L^T, rows and columns of A^-1 are W^T W, where W are these columns of L^-1. A column of W begins at its
/// unknown and has numbers in the supernodes on the way from there to the root of the elimination tree, and nowhere
/// else. Columns are worked on in groups of `lanes`, of unknowns that are near each other in the order of elimination.
template <class Real>
class Factor<Real>::InversePart {
public:
    InversePart(const Factor& factor, std::span<const int> unknowns)
        : factor_(factor), e_(factor.analysis_->e), block_(factor.block_), place_(unknowns.size()) {
        for (std::size_t k = 0; k < unknowns.size(); ++k)
            place_[k] = e_.position[unknowns[k] / block_] * block_ + unknowns[k] % block_;
        order_.resize(unknowns.size());
        std::iota(order_.begin(), order_.end(), std::size_t{0});
        std::ranges::sort(order_, [&](std::size_t a, std::size_t b) { return place_[a] < place_[b]; });
        groups_.resize((order_.size() + lanes - 1) / lanes);
        find_ways();
        number_unknowns();
    }

    /// result (unknowns, unknowns).
    void find(double* result) {
        parallel_for(groups_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t g = begin; g < end; ++g) go_down(g);
        });
        parallel_for(groups_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t g = begin; g < end; ++g) {
                for (std::size_t h = 0; h <= g; ++h) multiply(g, h, result);
            }
        });
    }

private:
    struct Group {
        std::vector<int> way;        ///< supernodes, ascending
        AlignedArray<Real> columns;  ///< (numbered unknowns, lanes)
    };
    /// Its columns, in order_.
    [[nodiscard]] std::span<const std::size_t> members(std::size_t group) const {
        const std::size_t begin = group * lanes;
        return std::span(order_).subspan(begin, std::min<std::size_t>(lanes, order_.size() - begin));
    }

    void find_ways() {
        std::vector<std::size_t> seen_by(static_cast<std::size_t>(e_.supernodes()), groups_.size());
        for (std::size_t g = 0; g < groups_.size(); ++g) {
            for (const std::size_t k : members(g)) {
                int s = static_cast<int>(std::ranges::upper_bound(e_.first, place_[k] / block_) - e_.first.begin()) - 1;
                for (; s >= 0 && seen_by[s] != g; s = e_.parent[s]) {
                    seen_by[s] = g;
                    groups_[g].way.push_back(s);
                }
            }
            std::ranges::sort(groups_[g].way);
        }
    }

    /// Of all supernodes on a way, one after the other: arrays hold no others.
    void number_unknowns() {
        std::vector<char> used(static_cast<std::size_t>(e_.supernodes()), 0);
        for (const Group& group : groups_) {
            for (const int s : group.way) used[s] = 1;
        }
        start_.assign(used.size(), -1);
        for (std::size_t s = 0; s < used.size(); ++s) {
            if (used[s] == 0) continue;
            start_[s] = count_;
            count_ += e_.columns(static_cast<int>(s)) * block_;
        }
        number_.assign(e_.position.size(), -1);
        for (std::size_t s = 0; s < used.size(); ++s) {
            if (used[s] == 0) continue;
            for (int node = e_.first[s]; node < e_.first[s + 1]; ++node)
                number_[node] = start_[s] + (node - e_.first[s]) * block_;
        }
    }

    [[nodiscard]] Real* at(Group& group, int unknown) const {
        return group.columns.data() + static_cast<std::size_t>(unknown) * lanes;
    }

    /// Columns of W.
    void go_down(std::size_t g) {
        Group& group = groups_[g];
        group.columns.resize(static_cast<std::size_t>(count_) * lanes);
        for (const int s : group.way) std::fill_n(at(group, start_[s]), e_.columns(s) * block_ * lanes, Real(0));
        const std::span<const std::size_t> mine = members(g);
        for (std::size_t lane = 0; lane < mine.size(); ++lane) {
            const int place = place_[mine[lane]];
            at(group, number_[place / block_] + place % block_)[lane] = 1;
        }
        std::vector<int> below;
        for (const int s : group.way) {
            below.clear();
            for (int k = e_.row_start[s]; k < e_.row_start[s + 1]; ++k) {
                for (int u = 0; u < block_; ++u) below.push_back(number_[e_.row[k]] + u);
            }
            solve_lower_lanes(factor_.panel(s), at(group, start_[s]),
                              LaneRows<Real>{below.data(), group.columns.data(), nullptr, count_});
        }
    }

    /// The numbers of group g's rows and group h's columns, and of the reverse.
    void multiply(std::size_t g, std::size_t h, double* result) {
        AlignedArray<Real> sums(static_cast<std::size_t>(lanes) * lanes);
        std::ranges::fill(sums.span(), Real(0));
        std::vector<int> common;
        std::ranges::set_intersection(groups_[g].way, groups_[h].way, std::back_inserter(common));
        for (const int s : common)
            add_lane_products(e_.columns(s) * block_, at(groups_[g], start_[s]), at(groups_[h], start_[s]),
                              sums.data());
        const std::span<const std::size_t> rows = members(g), columns = members(h);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            for (std::size_t j = 0; j < columns.size(); ++j) {
                const auto sum = static_cast<double>(sums[i * lanes + j]);
                result[rows[i] * order_.size() + columns[j]] = result[columns[j] * order_.size() + rows[i]] = sum;
            }
        }
    }

    const Factor& factor_;
    const Elimination& e_;
    const int block_;
    std::vector<int> place_;          ///< (unknowns) in the order of elimination
    std::vector<std::size_t> order_;  ///< (unknowns) ascending by place
    std::vector<Group> groups_;
    std::vector<int> start_;   ///< (supernodes) number of the first unknown, or -1
    std::vector<int> number_;  ///< (nodes) in the order of elimination: number of the first unknown, or -1
    int count_ = 0;            ///< of numbered unknowns
};

template <class Real>
void Factor<Real>::inverse_part(std::span<const int> unknowns, double* result) const {
    InversePart(*this, unknowns).find(result);
}

template void Factor<float>::inverse_part(std::span<const int>, double*) const;
template void Factor<double>::inverse_part(std::span<const int>, double*) const;

}  // namespace pliant::linalg
