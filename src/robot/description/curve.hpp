// A quantity over the time of a program: piecewise linear between keys.
#pragma once

#include <algorithm>
#include <vector>

namespace pliant::robot {

struct Curve {
    std::vector<double> time;   ///< ascending; at least one
    std::vector<double> value;  ///< as many

    /// Constant before the first and after the last key.
    [[nodiscard]] double at(double t) const {
        const auto after = std::upper_bound(time.begin(), time.end(), t);
        if (after == time.begin()) return value.front();
        if (after == time.end()) return value.back();
        const auto k = static_cast<std::size_t>(after - time.begin());
        const double share = (t - time[k - 1]) / (time[k] - time[k - 1]);
        return value[k - 1] + share * (value[k] - value[k - 1]);
    }
};

/// From `from` at time 0 to `to` at time 1.
[[nodiscard]] inline Curve ramp(double from, double to) {
    return {{0, 1}, {from, to}};
}

}  // namespace pliant::robot
