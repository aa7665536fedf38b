// Axis-aligned boxes: overlap tests, and splitting what a box contains.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>

#include "base/core/vec3.hpp"

namespace pliant {

/// The smallest box that holds all points; empty without any.
[[nodiscard]] inline Box3 bounds_of(std::span<const Vec3> points) {
    Box3 box;
    for (const Vec3& p : points) box.add(p);
    return box;
}

/// Whether two boxes overlap or touch, one of them widened by `margin` on all sides.
[[nodiscard]] inline bool boxes_meet(const Box3& a, const Box3& b, double margin = 0) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.low[k] > b.high[k] + margin || b.low[k] > a.high[k] + margin) return false;
    }
    return true;
}

/// Whether two boxes share space; touching is not enough.
[[nodiscard]] inline bool boxes_overlap(const Box3& a, const Box3& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.low[k] >= b.high[k] || b.low[k] >= a.high[k]) return false;
    }
    return true;
}

/// The axis along which a box is longest, the first of equal ones. Box: Box3 or Bounds.
template <class Box>
[[nodiscard]] std::size_t longest_axis(const Box& box) {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k) {
        if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
    }
    return axis;
}

/// How a tree of boxes splits its items: moves the `first` items with the smallest key(item) to the front. Equal keys
/// are ordered by item number, so the result does not depend on the initial order.
/// Precondition: first <= items.size(). Cost: about linear.
template <class Key>
void halve(std::span<int> items, std::size_t first, const Key& key) {
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(first), items.end(),
                     [&](int a, int b) { return std::pair(key(a), a) < std::pair(key(b), b); });
}

}  // namespace pliant
