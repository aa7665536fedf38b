#include "simulation/actuators/wet_part.hpp"

#include <algorithm>

namespace pliant::sim {
namespace {

/// Of the whole triangle, whatever the signs of the depths.
MeanSquare whole(const Depths& d) {
    const double sum = d[0] + d[1] + d[2];
    MeanSquare mean;
    for (Eigen::Index i = 0; i < 3; ++i) {
        const double depth = d[static_cast<std::size_t>(i)];
        mean.value += depth * (depth + sum) / 24;
        mean.first[i] = (depth + sum) / 12;
        for (Eigen::Index j = 0; j < 3; ++j) mean.second(i, j) = (i == j ? 2.0 : 1.0) / 12;
    }
    return mean;
}

/// How far the level cuts the two edges that leave `corner`, as shares of their lengths.
struct Cuts {
    std::size_t corner, next, last;
    double to_next, to_last;
};

/// `corner`: the only one on its side of the level.
Cuts cuts_at(const Depths& d, std::size_t corner) {
    const std::size_t next = (corner + 1) % 3, last = (corner + 2) % 3;
    return {corner, next, last, d[corner] / (d[corner] - d[next]), d[corner] / (d[corner] - d[last])};
}

/// Of the part that the level cuts off around one corner: d0^4 / (12 (d0 - d1) (d0 - d2)).
MeanSquare around(const Depths& d, const Cuts& cuts) {
    const auto c = static_cast<Eigen::Index>(cuts.corner);
    const auto n = static_cast<Eigen::Index>(cuts.next), l = static_cast<Eigen::Index>(cuts.last);
    const double p = cuts.to_next, q = cuts.to_last, depth = d[cuts.corner], slope = 4 - p - q;
    const double share = p * q / 12;
    MeanSquare mean;
    mean.value = share * depth * depth;
    mean.first[c] = share * depth * slope;
    mean.first[n] = share * depth * p;
    mean.first[l] = share * depth * q;
    mean.second(c, c) = share * (slope * slope - 4 + p * p + q * q);
    mean.second(c, n) = mean.second(n, c) = share * p * (slope - p);
    mean.second(c, l) = mean.second(l, c) = share * q * (slope - q);
    mean.second(n, n) = share * 2 * p * p;
    mean.second(n, l) = mean.second(l, n) = share * p * q;
    mean.second(l, l) = share * 2 * q * q;
    return mean;
}

std::size_t count_wet(const Depths& d) {
    return static_cast<std::size_t>(std::ranges::count_if(d, [](double depth) { return depth > 0; }));
}

/// The corner that is wet, or dry, while the two others are not.
Cuts cuts_of(const Depths& d, bool wet) {
    const auto found = std::ranges::find_if(d, [&](double depth) { return (depth > 0) == wet; });
    return cuts_at(d, static_cast<std::size_t>(found - d.begin()));
}

}  // namespace

MeanSquare mean_square(const Depths& depths, bool is_cut) {
    const std::size_t wet = is_cut ? count_wet(depths) : 3;
    if (wet == 0) return {};
    if (wet == 1) return around(depths, cuts_of(depths, true));
    MeanSquare mean = whole(depths);
    if (wet == 3) return mean;
    const MeanSquare dry = around(depths, cuts_of(depths, false));
    mean.value -= dry.value;
    mean.first -= dry.first;
    mean.second -= dry.second;
    return mean;
}

double wet_share(const Depths& depths) {
    const std::size_t wet = count_wet(depths);
    if (wet == 0 || wet == 3) return wet == 0 ? 0 : 1;
    const Cuts cuts = cuts_of(depths, wet == 1);
    const double around = cuts.to_next * cuts.to_last;
    return wet == 1 ? around : 1 - around;
}

}  // namespace pliant::sim
