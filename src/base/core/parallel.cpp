#include "base/core/parallel.hpp"

#include <algorithm>

#ifdef PLIANT_PLAIN_THREADS
#include <atomic>
#include <thread>
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

namespace pliant {
namespace {

/// Calls `work(p)` for every p below `pieces`, on all cores.
#ifdef PLIANT_PLAIN_THREADS
// For the thread sanitizer: TBB is built without it, so it does not see TBB's synchronisation and would report false
// races; suppressing TBB would also hide real races inside `work`.
template <class Work>
void on_all_cores(std::size_t pieces, const Work& work) {
    std::atomic<std::size_t> next = 0;
    const auto take = [&] {
        for (std::size_t p = next++; p < pieces; p = next++) work(p);
    };
    std::vector<std::jthread> helpers;
    for (std::size_t h = 1; h < std::min<std::size_t>(pieces, 4); ++h) helpers.emplace_back(take);
    take();
}
#else
template <class Work>
void on_all_cores(std::size_t pieces, const Work& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces, 1), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t p = range.begin(); p != range.end(); ++p) work(p);
    });
}
#endif

}  // namespace

void parallel_for(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
    const std::size_t pieces = (n + grain - 1) / grain;
    if (pieces <= 1) {
        if (n > 0) body(0, n);
        return;
    }
    on_all_cores(pieces, [&](std::size_t p) { body(p * grain, std::min(n, (p + 1) * grain)); });
}

void parallel_clear(std::span<double> numbers) {
    constexpr std::size_t grain = std::size_t{1} << 16;
    parallel_for(numbers.size(), grain, [&](std::size_t begin, std::size_t end) {
        std::fill(numbers.begin() + static_cast<std::ptrdiff_t>(begin),
                  numbers.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    });
}

double parallel_sum(std::size_t n, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& piece) {
    std::vector<double> sums((n + grain - 1) / grain, 0.0);
    parallel_for(n, grain, [&](std::size_t begin, std::size_t end) { sums[begin / grain] = piece(begin, end); });
    double total = 0;
    for (const double sum : sums) total += sum;
    return total;
}

}  // namespace pliant
