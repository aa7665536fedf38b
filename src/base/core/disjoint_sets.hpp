// Union-find.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant {

/// The numbers 0 to `count` - 1, each in its own set until sets are joined. A set is represented by its smallest
/// number.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0); }

    /// The representative of the set that holds `i`. Compresses the path by halving.
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

    std::vector<int> above_;  ///< parent: a member of the same set that is not larger; the smallest is its own parent
};

}  // namespace pliant
