// Sobol indices: how much of a result's variance comes from each key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pliant::study {

/// An index and the interval that holds it with a confidence of 95 %.
struct Index {
    double value = 0, low = 0, high = 0;
};

/// Of one key.
struct KeyIndices {
    Index first;  ///< share of the variance that the key explains alone
    Index total;  ///< share that is left when all other keys are known: alone and together with others
};

struct Sensitivity {
    std::vector<KeyIndices> keys;  ///< (keys); empty where the result does not vary, or too few rows are there
    std::size_t samples = 0;       ///< base points all of whose rows are there
    double variance = 0;
};

/// `values` (samples (keys + 2)): of the rows of saltelli_points(), NaN where a row failed; base points with one are
/// left out. First-order indices by Saltelli (2010), total ones by Jansen (1999), both as table 2 of A. Saltelli et
/// al., Comput. Phys. Commun. 181 (2010) has them; intervals from `resamples` bootstrap samples of base points, by
/// percentiles. The same numbers for the same seed. Cost: resamples x samples x keys.
[[nodiscard]] Sensitivity sobol_indices(std::span<const double> values, std::size_t keys, std::size_t resamples = 1000,
                                        std::uint64_t seed = 1);

}  // namespace pliant::study
