// Sobol's low-discrepancy sequence.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::study {

inline constexpr int most_sobol_dimensions = 64;

/// The first `count` points (count, dimensions) of Sobol's sequence in base 2, in [0, 1), in Gray code order. Any 2^k
/// points that begin at a multiple of 2^k are a digital net. `seed` applies a random digital shift of 32 bits per
/// dimension, which preserves the nets; 0: no shift, and the first point is the origin. `dimensions` from 1 to
/// most_sobol_dimensions.
/// I. M. Sobol, USSR Comput. Math. Math. Phys. 7 (1967); P. Bratley and B. L. Fox, ACM TOMS 14 (1988), algorithm 659.
[[nodiscard]] std::vector<double> sobol_points(std::size_t count, int dimensions, std::uint64_t seed);

}  // namespace pliant::study
