// Parallel loops whose results never depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace pliant {

/// Calls `body(begin, end)` on disjoint pieces of [0, n), each of at most `grain` items, on all cores; returns when all
/// are done. Piece boundaries depend only on n and grain. `body` must not throw.
void parallel_for(std::size_t n, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

/// Sets all numbers to 0, on all cores; for a large new array this also maps its pages in parallel.
void parallel_clear(std::span<double> numbers);

/// Sum of `piece(begin, end)` over the same pieces, added in order: bit-identical on any number of threads.
[[nodiscard]] double parallel_sum(std::size_t n, std::size_t grain,
                                  const std::function<double(std::size_t, std::size_t)>& piece);

}  // namespace pliant
