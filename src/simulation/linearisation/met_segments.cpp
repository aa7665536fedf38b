#include "simulation/linearisation/met_segments.hpp"

#include <algorithm>

namespace pliant::sim {

MetSegments::MetSegments(const CablePath& path, std::span<const double> x, std::span<const double> shares)
    : path_(path), x_(x), rates_(path.segment_count(), 0.0) {
    const double met = path.met_length_m();
    for (std::size_t k = 0; k < rates_.size(); ++k) {
        const double l = norm(path.segment_vector(k, x));
        if (l >= met) continue;
        const double share = shares.empty() ? 1 : shares[k];
        any_ = true;
        rates_[k] = -share / met;  // of share d / met
        length_rate_ += 0.5 * share * (1 - l * l / (met * met));
    }
}

void MetSegments::add_gradient_rate(double factor, std::span<double> forces) const {
    if (any_) path_.add_gradient(x_, factor, forces, rates_);
}

std::vector<double> met_length_rates(const CablePath& path, std::span<const double> rest) {
    constexpr double of_path = 1e-3, of_segment = 0.25;  // as in CablePath
    std::size_t shortest = 0;
    double total = 0, least = 0;
    for (std::size_t k = 0; k < path.segment_count(); ++k) {
        const double l = norm(path.segment_vector(k, rest));
        if (k == 0 || l < least) {
            shortest = k;
            least = l;
        }
        total += l;
    }
    std::vector<double> rates(path.segment_count(), 0.0);
    const double floor = 1e-9;
    if (of_path * total <= of_segment * least)
        std::ranges::fill(rates, of_path);
    else if (floor * total < of_segment * least)
        rates[shortest] = of_segment;
    else
        std::ranges::fill(rates, floor);
    return rates;
}

void add_met_length_gradient(const CablePath& path, std::span<const double> rest, double factor,
                             std::span<double> by_rest) {
    path.add_gradient(rest, factor, by_rest, met_length_rates(path, rest));
}

}  // namespace pliant::sim
