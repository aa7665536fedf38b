// Lists of indices, stored one after another.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

#include "base/core/parallel.hpp"

namespace pliant::linalg {

/// List i is item[start[i]] .. item[start[i + 1]].
struct Lists {
    std::vector<int> start{0};  ///< (count + 1)
    std::vector<int> item;

    Lists() = default;
    // Not explicit, so that short lists can be written as braces.
    Lists(std::initializer_list<std::vector<int>> lists) : Lists(std::vector(lists)) {}
    Lists(const std::vector<std::vector<int>>& lists) {
        for (const std::vector<int>& list : lists) push_back(list);
    }

    [[nodiscard]] int count() const { return static_cast<int>(start.size()) - 1; }
    [[nodiscard]] std::span<const int> operator[](std::size_t i) const {
        return std::span(item).subspan(static_cast<std::size_t>(start[i]),
                                       static_cast<std::size_t>(start[i + 1] - start[i]));
    }
    void push_back(std::span<const int> list) {
        item.insert(item.end(), list.begin(), list.end());
        start.push_back(static_cast<int>(item.size()));
    }
};

/// The items of each group, in ascending order.
[[nodiscard]] Lists members_of(const std::vector<int>& group_of_item, int groups);

/// The lists of all pieces, concatenated.
[[nodiscard]] Lists joined(const std::vector<Lists>& pieces);

/// Makes `count` lists in parallel on all cores: `writer()` returns a function with work space of its own, which is
/// called with ascending i and appends list i to the items.
template <class Writer>
[[nodiscard]] Lists make_lists(int count, const Writer& writer) {
    constexpr std::size_t most_pieces = 16;
    const auto all = static_cast<std::size_t>(count);
    const std::size_t grain = std::max<std::size_t>(1, (all + most_pieces - 1) / most_pieces);
    std::vector<Lists> pieces((all + grain - 1) / grain);
    parallel_for(all, grain, [&](std::size_t begin, std::size_t end) {
        Lists& piece = pieces[begin / grain];
        piece.start.reserve(end - begin + 1);
        auto write = writer();
        for (std::size_t i = begin; i < end; ++i) {
            write(static_cast<int>(i), piece.item);
            piece.start.push_back(static_cast<int>(piece.item.size()));
        }
    });
    return joined(pieces);
}

}  // namespace pliant::linalg
