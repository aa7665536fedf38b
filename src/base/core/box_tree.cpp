#include "base/core/box_tree.hpp"

#include <cmath>
#include <numeric>

#include "base/core/boxes.hpp"

namespace pliant {

namespace {

/// Stores the box in single precision, rounded outwards.
void put(const Bounds& box, BoxTree::Leaf& leaf, std::size_t i) {
    constexpr float rounding = 1.2e-7F, least = 1e-37F;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto low = static_cast<float>(box.low[k]), high = static_cast<float>(box.high[k]);
        leaf.low[k][i] = low - (std::fabs(low) * rounding + least);
        leaf.high[k][i] = high + (std::fabs(high) * rounding + least);
    }
}

BoxTree::Leaf empty_leaf() {
    BoxTree::Leaf leaf;
    for (std::size_t k = 0; k < 3; ++k) {
        leaf.low[k].fill(HUGE_VALF);
        leaf.high[k].fill(-HUGE_VALF);
    }
    return leaf;
}

}  // namespace

BoxTree::BoxTree(std::span<const Bounds> items) : order_(items.size()) {
    if (items.empty()) return;
    std::iota(order_.begin(), order_.end(), 0);
    std::vector<Vec3> centres;
    for (const Bounds& b : items)
        centres.push_back({0.5 * (b.low[0] + b.high[0]), 0.5 * (b.low[1] + b.high[1]), 0.5 * (b.low[2] + b.high[2])});
    split(centres, 0, items.size());
}

std::size_t BoxTree::split(std::span<const Vec3> centres, std::size_t begin, std::size_t end) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({node + 1, (end + leaf_size - 1) / leaf_size});
    const std::size_t leaves = (end - begin + leaf_size - 1) / leaf_size;
    if (leaves == 1) node_of_leaf_.push_back(node);
    if (leaves > 1) {
        Bounds box;
        for (std::size_t i = begin; i < end; ++i) box.add(centres[order_[i]]);
        const std::size_t axis = longest_axis(box);
        const std::size_t middle = begin + (leaves + 1) / 2 * leaf_size;
        halve(std::span(order_).subspan(begin, end - begin), middle - begin, [&](int i) { return centres[i][axis]; });
        split(centres, begin, middle);
        split(centres, middle, end);
    }
    return nodes_[node].next = nodes_.size();
}

BoxTree::Fit BoxTree::fit(std::span<const Bounds> items) const {
    Fit fit{std::vector<Bounds>(nodes_.size()), std::vector<Leaf>(leaf_count(), empty_leaf())};
    for (std::size_t l = 0; l < leaf_count(); ++l) {
        const std::span<const int> held = leaf(l);
        for (std::size_t i = 0; i < held.size(); ++i) {
            fit.nodes[node_of_leaf_[l]].add(items[held[i]]);
            put(items[held[i]], fit.leaves[l], i);
        }
    }
    for_children([&](std::size_t node, std::size_t child) { fit.nodes[node].add(fit.nodes[child]); });
    return fit;
}

BoxTree::MovingFit BoxTree::fit(std::span<const Bounds> start, std::span<const Bounds> end,
                                std::span<const char> moves) const {
    MovingFit moving{fit(start), fit(end), std::vector<char>(nodes_.size(), 0)};
    for (std::size_t l = 0; l < leaf_count(); ++l) {
        for (const int item : leaf(l)) moving.moves[node_of_leaf_[l]] |= moves[static_cast<std::size_t>(item)];
    }
    for_children([&](std::size_t node, std::size_t child) { moving.moves[node] |= moving.moves[child]; });
    return moving;
}

}  // namespace pliant
