#include "base/linalg/lists.hpp"

#include <numeric>

namespace pliant::linalg {

Lists members_of(const std::vector<int>& group_of_item, int groups) {
    Lists result;
    result.start.assign(static_cast<std::size_t>(groups) + 1, 0);
    result.item.resize(group_of_item.size());
    for (const int g : group_of_item) ++result.start[g + 1];
    std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
    std::vector<int> next(result.start.begin(), result.start.end() - 1);
    for (std::size_t i = 0; i < group_of_item.size(); ++i) result.item[next[group_of_item[i]]++] = static_cast<int>(i);
    return result;
}

Lists joined(const std::vector<Lists>& pieces) {
    std::vector<std::size_t> first_item{0}, first_list{1};
    for (const Lists& piece : pieces) {
        first_item.push_back(first_item.back() + piece.item.size());
        first_list.push_back(first_list.back() + piece.start.size() - 1);
    }
    Lists result;
    result.item.resize(first_item.back());
    result.start.resize(first_list.back());
    parallel_for(pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            std::copy(pieces[p].item.begin(), pieces[p].item.end(),
                      result.item.begin() + static_cast<std::ptrdiff_t>(first_item[p]));
            for (std::size_t k = 1; k < pieces[p].start.size(); ++k)
                result.start[first_list[p] + k - 1] = static_cast<int>(first_item[p]) + pieces[p].start[k];
        }
    });
    return result;
}

}  // namespace pliant::linalg
