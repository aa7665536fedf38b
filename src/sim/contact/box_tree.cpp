#include "sim/contact/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant::sim::contact {

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
    if (leaves > 1) {
        Bounds box;
        for (std::size_t i = begin; i < end; ++i) box.add(centres[order_[i]]);
        std::size_t axis = 0;
        for (std::size_t k = 1; k < 3; ++k)
            if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
        const std::size_t middle = begin + (leaves + 1) / 2 * leaf_size;
        const auto before = [&](int a, int b) {
            return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
        };
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, before);
        split(centres, begin, middle);
        split(centres, middle, end);
    }
    return nodes_[node].next = nodes_.size();
}

BoxTree::Fit BoxTree::fit(std::span<const Bounds> items) const {
    Fit fit{std::vector<Bounds>(order_.size()), std::vector<Bounds>(nodes_.size())};
    for (std::size_t i = 0; i < order_.size(); ++i) fit.items[i] = items[order_[i]];
    for (std::size_t n = nodes_.size(); n-- > 0;) {
        if (nodes_[n].next == n + 1) {
            const std::size_t begin = (nodes_[n].end_leaf - 1) * leaf_size;
            const std::size_t end = std::min(begin + leaf_size, order_.size());
            for (std::size_t i = begin; i < end; ++i) fit.nodes[n].add(fit.items[i]);
        } else {
            fit.nodes[n].add(fit.nodes[n + 1]);
            fit.nodes[n].add(fit.nodes[nodes_[n + 1].next]);
        }
    }
    return fit;
}

}  // namespace pliant::sim::contact
