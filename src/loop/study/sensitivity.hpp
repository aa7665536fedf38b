// Sobol indices: the contribution of each key to a result's variance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pliant::study {

/// An index and its 95 % confidence interval.
struct Index {
    double value = 0, low = 0, high = 0;
};

/// Of one key.
struct KeyIndices {
    Index first;  ///< fraction of the variance explained by the key alone
    Index total;  ///< fraction that remains when all other keys are fixed: alone and in interaction with others
};

struct Sensitivity {
    std::vector<KeyIndices> keys;  ///< (keys); empty if the result does not vary, or there are too few rows
    std::size_t samples = 0;       ///< base points with all of their rows
    double variance = 0;
};

/// `values` (samples (keys + 2)): of the rows of saltelli_points(), NaN where a row failed; base points with a NaN are
/// left out. First-order indices by Saltelli (2010), total ones by Jansen (1999), both as in table 2 of A. Saltelli et
/// al., Comput. Phys. Commun. 181 (2010); percentile intervals from `resamples` bootstrap samples of base points.
/// Deterministic for a given seed. Cost: resamples x samples x keys.
[[nodiscard]] Sensitivity sobol_indices(std::span<const double> values, std::size_t keys, std::size_t resamples = 1000,
                                        std::uint64_t seed = 1);

}  // namespace pliant::study
