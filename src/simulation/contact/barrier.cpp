#include "simulation/contact/barrier.hpp"

#include <cmath>
#include <limits>

namespace pliant::sim::contact {

Curve barrier(double squared, double squared_reach) {
    if (squared >= squared_reach) return {};
    if (!(squared > 0)) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        return {infinity, -infinity, infinity};
    }
    const double z = squared / squared_reach, y = z - 1, log = std::log(z);
    const double slope = -2 * y * log - y * y / z;
    const double curvature = -2 * log - 4 * y / z + y * y / (z * z);
    return {-y * y * log, slope / squared_reach, curvature / (squared_reach * squared_reach)};
}

Curve mollifier(double squared_cross, double threshold) {
    if (squared_cross >= threshold) return {1, 0, 0};
    const double z = squared_cross / threshold;
    return {z * (2 - z), 2 * (1 - z) / threshold, -2 / (threshold * threshold)};
}

}  // namespace pliant::sim::contact
