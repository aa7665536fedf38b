// Which of many things hang together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant {

/// The numbers 0 to `count` - 1, each in a set of its own until sets are joined. A set is known by its smallest number.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0); }

    /// The set that holds `i`. Halves the way there.
    [[nodiscard]] int find(int i) {
        while (above(i) != i) i = above(i) = above(above(i));
        return i;
    }
    void join(int a, int b) {
        const auto [low, high] = std::minmax({find(a), find(b)});
        above(high) = low;
    }

private:
    int& above(int i) { return above_[static_cast<std::size_t>(i)]; }

    std::vector<int> above_;  ///< a number of the same set that is not larger; itself for the smallest
};

}  // namespace pliant
