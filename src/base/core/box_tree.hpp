// Finds overlapping boxes: the tree's structure is fixed once, its boxes are refitted to every new state.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant {

/// An axis-aligned box, closed on all sides; empty until a point is added.
struct Bounds {
    std::array<double, 3> low{HUGE_VAL, HUGE_VAL, HUGE_VAL};
    std::array<double, 3> high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

    void add(const Vec3& p) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = p[k] < low[k] ? p[k] : low[k];
            high[k] = p[k] > high[k] ? p[k] : high[k];
        }
    }
    void add(const Bounds& b) {
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = b.low[k] < low[k] ? b.low[k] : low[k];
            high[k] = b.high[k] > high[k] ? b.high[k] : high[k];
        }
    }
    void widen(double margin) {
        for (std::size_t k = 0; k < 3; ++k) low[k] -= margin, high[k] += margin;
    }
    [[nodiscard]] bool overlaps(const Bounds& b) const {
        // Without branches: the outcome is hard to predict and the six comparisons are cheap.
        return (low[0] <= b.high[0]) & (b.low[0] <= high[0]) & (low[1] <= b.high[1]) & (b.low[1] <= high[1]) &
               (low[2] <= b.high[2]) & (b.low[2] <= high[2]);
    }
};

/// Bounding boxes of an item at the start and at the end of a motion in which its points move in straight lines.
struct MovingBounds {
    Bounds start, end;

    /// False only if the two never overlap during the motion: if one is beyond the other along the same axis at both
    /// ends, they stay apart at all times, however far both move.
    [[nodiscard]] bool may_meet(const MovingBounds& b) const {
        bool apart = false;
        for (std::size_t k = 0; k < 3; ++k) {
            apart |= (start.high[k] < b.start.low[k]) & (end.high[k] < b.end.low[k]);
            apart |= (b.start.high[k] < start.low[k]) & (b.end.high[k] < end.low[k]);
        }
        return !apart;
    }
};

/// The structure of the tree: the order of the items in leaves of eight, and the nodes above them. Immutable.
class BoxTree {
public:
    static constexpr std::size_t leaf_size = 8;

    BoxTree() = default;
    /// Splits the items in half along the longest side of the box of their centres until eight are left.
    explicit BoxTree(std::span<const Bounds> items);

    /// The boxes of the items of one leaf in SoA layout for SIMD; rounded outwards, unused ones empty.
    struct Leaf {
        std::array<std::array<float, leaf_size>, 3> low, high;
    };
    /// The boxes of one state.
    struct Fit {
        std::vector<Bounds> nodes;
        std::vector<Leaf> leaves;
    };
    /// `items` in their original order, as many as the tree was built from.
    [[nodiscard]] Fit fit(std::span<const Bounds> items) const;

    [[nodiscard]] std::size_t leaf_count() const { return (order_.size() + leaf_size - 1) / leaf_size; }
    [[nodiscard]] std::span<const int> leaf(std::size_t l) const {
        const std::size_t begin = l * leaf_size, end = begin + leaf_size;
        return {order_.data() + begin, (end < order_.size() ? end : order_.size()) - begin};
    }

    /// Calls visit(l) for each leaf whose box overlaps `box`, in ascending order, from leaf `first` on.
    template <class Visit>
    void visit_leaves(const Fit& fit, const Bounds& box, std::size_t first, Visit&& visit) const {
        walk([&](std::size_t n) { return fit.nodes[n].overlaps(box); }, first, visit);
    }

    /// Calls visit(i, j) for the items i of leaf `l` of this tree and j of `other` whose boxes overlap in single
    /// precision, in a fixed order. A tree against itself gives each pair once.
    template <class Visit>
    void visit_overlaps(const Fit& fit, std::size_t l, const BoxTree& other, const Fit& other_fit,
                        Visit&& visit) const {
        const auto hits = [&](std::size_t i, std::size_t m) {
            // In most pairs of overlapping leaves, few items reach into the other leaf's box.
            if (!box_of(fit.leaves[l], i).overlaps(other_fit.nodes[other.node_of_leaf_[m]])) return 0U;
            return overlaps(fit.leaves[l], i, other_fit.leaves[m]);
        };
        other.visit_leaves(other_fit, fit.nodes[node_of_leaf_[l]], this == &other ? l : 0,
                           [&](std::size_t m) { visit_hits(l, other, m, hits, visit); });
    }

    /// The boxes at both ends of a motion.
    struct MovingFit {
        Fit start, end;
        std::vector<char> moves;  ///< (nodes of the tree) whether anything below moves
    };
    /// `moves`: whether each item does.
    [[nodiscard]] MovingFit fit(std::span<const Bounds> start, std::span<const Bounds> end,
                                std::span<const char> moves) const;
    /// As visit_overlaps, for pairs that may overlap during the motion. Pairs of items that both stay where they are
    /// may be left out.
    template <class Visit>
    void visit_meetings(const MovingFit& fit, std::size_t l, const BoxTree& other, const MovingFit& other_fit,
                        Visit&& visit) const {
        const std::size_t own = node_of_leaf_[l];
        const MovingBounds box{fit.start.nodes[own], fit.end.nodes[own]};
        const auto enters = [&](std::size_t n) {
            return (fit.moves[own] || other_fit.moves[n]) &&
                   box.may_meet({other_fit.start.nodes[n], other_fit.end.nodes[n]});
        };
        const auto hits = [&](std::size_t i, std::size_t m) {
            const std::size_t n = other.node_of_leaf_[m];
            const MovingBounds item{box_of(fit.start.leaves[l], i), box_of(fit.end.leaves[l], i)};
            if (!item.may_meet({other_fit.start.nodes[n], other_fit.end.nodes[n]})) return 0U;
            return ~(parted(fit.start.leaves[l], fit.end.leaves[l], i, other_fit.start.leaves[m],
                            other_fit.end.leaves[m])) &
                   ~(~0u << other.leaf(m).size());
        };
        other.walk(enters, this == &other ? l : 0, [&](std::size_t m) { visit_hits(l, other, m, hits, visit); });
    }

private:
    /// Calls visit(l) for each leaf from `first` on for which enters(n) is true at all of its ancestors.
    template <class Enters, class Visit>
    void walk(const Enters& enters, std::size_t first, Visit&& visit) const {
        for (std::size_t n = 0; n < nodes_.size();) {
            const Node& node = nodes_[n];
            const bool enter = node.end_leaf > first && enters(n);
            if (enter && node.next == n + 1) visit(node.end_leaf - 1);
            n = enter ? n + 1 : node.next;
        }
    }
    /// Calls visit(i, j) for the items of leaves l and m of `other` whose bits hits(index in l, m) sets.
    template <class Hits, class Visit>
    void visit_hits(std::size_t l, const BoxTree& other, std::size_t m, const Hits& hits, Visit&& visit) const {
        const bool same = this == &other && l == m;
        const std::span<const int> mine = leaf(l), theirs = other.leaf(m);
        for (std::size_t i = 0; i < mine.size(); ++i) {
            unsigned found = hits(i, m);
            if (same) found &= ~0u << (i + 1);
            for (; found != 0; found &= found - 1) visit(mine[i], theirs[std::countr_zero(found)]);
        }
    }
    static Bounds box_of(const Leaf& leaf, std::size_t i) {
        Bounds box;
        for (std::size_t k = 0; k < 3; ++k) box.low[k] = leaf.low[k][i], box.high[k] = leaf.high[k][i];
        return box;
    }
    /// Bit j: along some axis, item i of `a` and item j of `b` are in the same order and apart at both ends of the
    /// motion.
    static unsigned parted(const Leaf& a0, const Leaf& a1, std::size_t i, const Leaf& b0, const Leaf& b1) {
        std::array<unsigned, leaf_size> apart{};
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t j = 0; j < leaf_size; ++j)
                apart[j] |= (unsigned(a0.high[k][i] < b0.low[k][j]) & unsigned(a1.high[k][i] < b1.low[k][j])) |
                            (unsigned(b0.high[k][j] < a0.low[k][i]) & unsigned(b1.high[k][j] < a1.low[k][i]));
        unsigned bits = 0;
        for (std::size_t j = 0; j < leaf_size; ++j) bits |= apart[j] << j;
        return bits;
    }

    /// In preorder: the left child follows its parent; `next` is the first node that is not below this one.
    struct Node {
        std::size_t next, end_leaf;
    };
    /// Bit j: item i of `a` overlaps item j of `b`.
    static unsigned overlaps(const Leaf& a, std::size_t i, const Leaf& b) {
        std::array<unsigned, leaf_size> hit;
        for (std::size_t j = 0; j < leaf_size; ++j)
            hit[j] = unsigned(a.low[0][i] <= b.high[0][j]) & unsigned(b.low[0][j] <= a.high[0][i]) &
                     unsigned(a.low[1][i] <= b.high[1][j]) & unsigned(b.low[1][j] <= a.high[1][i]) &
                     unsigned(a.low[2][i] <= b.high[2][j]) & unsigned(b.low[2][j] <= a.high[2][i]);
        unsigned bits = 0;
        for (std::size_t j = 0; j < leaf_size; ++j) bits |= hit[j] << j;
        return bits;
    }
    std::size_t split(std::span<const Vec3> centres, std::size_t begin, std::size_t end);
    /// Calls join(node, child) for both children of each node, those further down first.
    template <class Join>
    void for_children(const Join& join) const {
        for (std::size_t n = nodes_.size(); n-- > 0;) {
            if (nodes_[n].next == n + 1) continue;
            join(n, n + 1);
            join(n, nodes_[n + 1].next);
        }
    }

    std::vector<int> order_;
    std::vector<Node> nodes_;
    std::vector<std::size_t> node_of_leaf_;
};

}  // namespace pliant
