#include "base/linalg/minimum_degree.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

namespace pliant::linalg {
namespace {

/// A bit row for each node: itself and its neighbours, the nodes first, then adjacent nodes outside.
class Neighbourhoods {
public:
    /// Precondition: `rim` is sorted.
    Neighbourhoods(const Graph& graph, const std::vector<Rim>& rim) : count_(graph.nodes()) {
        std::vector<int> bit(rim.size());
        int bits = count_;
        for (std::size_t k = 0; k < rim.size(); ++k)
            bit[k] = k > 0 && rim[k - 1].outside == rim[k].outside ? bits - 1 : bits++;
        words_ = (static_cast<std::size_t>(bits) + 63) / 64;
        bits_.assign(words_ * static_cast<std::size_t>(count_), 0);
        for (int v = 0; v < count_; ++v) {
            add(v, v);
            for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) add(v, graph.other[k]);
        }
        for (std::size_t k = 0; k < rim.size(); ++k) add(rim[k].node, bit[k]);
    }

    [[nodiscard]] int degree(int v) const {
        int sum = -1;
        for (std::size_t w = 0; w < words_; ++w) sum += std::popcount(row(v)[w]);
        return sum;
    }

    /// Connects the neighbours of v, removes v from each and calls `changed` for those that are among the nodes.
    template <class Changed>
    void eliminate(int v, const Changed& changed) {
        row(v)[v / 64] &= ~mask(v);
        for (int first = 0; first < count_; first += 64) {
            for (std::uint64_t left = row(v)[first / 64]; left != 0; left &= left - 1) {
                const int other = first + std::countr_zero(left);
                if (other >= count_) return;
                for (std::size_t w = 0; w < words_; ++w) row(other)[w] |= row(v)[w];
                row(other)[v / 64] &= ~mask(v);
                changed(other);
            }
        }
    }

private:
    void add(int v, int bit) { row(v)[bit / 64] |= mask(bit); }
    static std::uint64_t mask(int bit) { return std::uint64_t{1} << (bit % 64); }
    [[nodiscard]] std::uint64_t* row(int v) { return bits_.data() + words_ * static_cast<std::size_t>(v); }
    [[nodiscard]] const std::uint64_t* row(int v) const { return bits_.data() + words_ * static_cast<std::size_t>(v); }

    int count_;
    std::size_t words_ = 0;
    std::vector<std::uint64_t> bits_;
};

}  // namespace

std::vector<int> by_minimum_degree(const Graph& graph, std::vector<Rim> rim) {
    std::sort(rim.begin(), rim.end(),
              [](const Rim& a, const Rim& b) { return std::pair(a.outside, a.node) < std::pair(b.outside, b.node); });
    Neighbourhoods near(graph, rim);
    std::vector<int> degree(static_cast<std::size_t>(graph.nodes()));
    for (int v = 0; v < graph.nodes(); ++v) degree[v] = near.degree(v);
    std::vector<int> order;
    while (order.size() < degree.size()) {
        const auto least = std::min_element(degree.begin(), degree.end());
        const auto v = static_cast<int>(least - degree.begin());
        *least = std::numeric_limits<int>::max();
        order.push_back(v);
        near.eliminate(v, [&](int other) { degree[other] = near.degree(other); });
    }
    return order;
}

}  // namespace pliant::linalg
