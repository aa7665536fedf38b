#include "core/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace pliant {

void parallel_for(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
    const std::size_t pieces = (n + grain - 1) / grain;
    if (pieces <= 1) {
        if (n > 0) body(0, n);
        return;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces, 1), [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t p = range.begin(); p != range.end(); ++p) body(p * grain, std::min(n, (p + 1) * grain));
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
