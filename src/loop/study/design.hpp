// Points of experimental designs in the unit cube.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::study {

/// (count, dimensions) in [0, 1): each dimension is divided into `count` equal strata with one random point in each,
/// and the strata are shuffled. M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979).
[[nodiscard]] std::vector<double> latin_hypercube(std::size_t count, int dimensions, std::uint64_t seed);

/// Saltelli's design, (count (dimensions + 2), dimensions): two samples A and B are the halves of Sobol's sequence in
/// twice the dimensions; each base point i gives the rows A_i and B_i and, for each k, A_i with its k-th number from
/// B_i. `dimensions`: at most most_sobol_dimensions / 2. A. Saltelli et al., Comput. Phys. Commun. 181 (2010).
[[nodiscard]] std::vector<double> saltelli_points(std::size_t count, int dimensions, std::uint64_t seed);

}  // namespace pliant::study
