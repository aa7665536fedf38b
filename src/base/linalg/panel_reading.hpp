// How the work of a solution with a panel is shared: it reads each number of the factor once.
#pragma once

#include <algorithm>
#include <cstddef>

#include "base/core/parallel.hpp"

namespace pliant::linalg {

/// Calls work(from, to) on ranges of items of `entries` numbers each, in parallel if there are enough.
template <class Work>
void share_reading(int begin, int end, int entries, const Work& work) {
    constexpr int enough = 50000;  // numbers of a factor, for another core
    if (end <= begin) return;
    const auto grain = static_cast<std::size_t>(std::max(enough / std::max(entries, 1), 4) / 4 * 4);
    parallel_for(static_cast<std::size_t>(end - begin), grain,
                 [&](std::size_t b, std::size_t e) { work(begin + static_cast<int>(b), begin + static_cast<int>(e)); });
}

}  // namespace pliant::linalg
