#include "loop/study/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/parallel.hpp"
#include "loop/study/random.hpp"

namespace pliant::study {
namespace {

/// Rows A, B and, for each k, A with the k-th number of B, of one base point.
using Base = std::span<const double>;

struct Pair {
    double first = 0, total = 0;
};

/// Both indices of every key, from the base points `chosen`. Subtracting the mean `centre` keeps the products small.
std::vector<Pair> indices_of(std::span<const Base> bases, std::span<const std::size_t> chosen, std::size_t keys,
                             double centre, double* variance) {
    double sum = 0, squares = 0;
    std::vector<Pair> pairs(keys);
    for (const std::size_t i : chosen) {
        const double a = bases[i][0] - centre, b = bases[i][1] - centre;
        sum += a + b;
        squares += a * a + b * b;
        for (std::size_t k = 0; k < keys; ++k) {
            const double mixed = bases[i][2 + k] - centre;
            pairs[k].first += b * (mixed - a);
            pairs[k].total += 0.5 * (a - mixed) * (a - mixed);
        }
    }
    const auto n = static_cast<double>(chosen.size());
    const double mean = sum / (2 * n);
    const double spread = squares / (2 * n) - mean * mean;
    if (variance != nullptr) *variance = spread;
    for (Pair& pair : pairs) {
        pair.first = spread > 0 ? pair.first / n / spread : 0;
        pair.total = spread > 0 ? pair.total / n / spread : 0;
    }
    return pairs;
}

/// The interval between two percentiles of the bootstrap samples.
Index interval(double value, std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    const auto at = [&samples](double share) {
        return samples[static_cast<std::size_t>(share * static_cast<double>(samples.size() - 1) + 0.5)];
    };
    return {value, at(0.025), at(0.975)};
}

std::vector<Base> whole_bases(std::span<const double> values, std::size_t keys) {
    const std::size_t rows = keys + 2;
    std::vector<Base> bases;
    for (std::size_t i = 0; i + rows <= values.size(); i += rows) {
        const Base base = values.subspan(i, rows);
        if (std::all_of(base.begin(), base.end(), [](double v) { return std::isfinite(v); })) bases.push_back(base);
    }
    return bases;
}

}  // namespace

Sensitivity sobol_indices(std::span<const double> values, std::size_t keys, std::size_t resamples, std::uint64_t seed) {
    const std::vector<Base> bases = whole_bases(values, keys);
    Sensitivity found{{}, bases.size(), 0};
    if (bases.size() < 2) return found;
    std::vector<std::size_t> all(bases.size());
    double centre = 0, largest = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = i;
        centre += bases[i][0] / static_cast<double>(all.size());
        largest = std::max(largest, std::abs(bases[i][0]));
    }
    const std::vector<Pair> pairs = indices_of(bases, all, keys, centre, &found.variance);
    constexpr double rounding = 1e-12;
    if (!(found.variance > rounding * rounding * largest * largest)) return found;
    std::vector<std::vector<Pair>> again(resamples);
    parallel_for(resamples, 16, [&](std::size_t begin, std::size_t end) {
        std::vector<std::size_t> chosen(bases.size());
        for (std::size_t r = begin; r < end; ++r) {
            Random random(seed * 0x9e3779b97f4a7c15ULL + r);
            for (std::size_t& i : chosen) i = random.below(bases.size());
            again[r] = indices_of(bases, chosen, keys, centre, nullptr);
        }
    });
    for (std::size_t k = 0; k < keys; ++k) {
        std::vector<double> first, total;
        for (const auto& one : again) {
            first.push_back(one[k].first);
            total.push_back(one[k].total);
        }
        found.keys.push_back({interval(pairs[k].first, std::move(first)), interval(pairs[k].total, std::move(total))});
    }
    return found;
}

}  // namespace pliant::study
