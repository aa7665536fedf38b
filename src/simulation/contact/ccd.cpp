#include "simulation/contact/ccd.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::sim::contact {

namespace {

double distance(Features features, const Stencil& x) {
    return std::sqrt(squared_distance(nearest(features, x), x));
}

/// An upper bound on the closing speed of the features, after removing their common motion.
double closing_speed(Features features, const Stencil& p) {
    const double a = norm(p[0]), b = norm(p[1]), c = norm(p[2]), d = norm(p[3]);
    return features == Features::point_triangle ? a + std::max({b, c, d}) : std::max(a, b) + std::max(c, d);
}

Stencil moved(const Stencil& x, const Stencil& p, double t) {
    return {x[0] + t * p[0], x[1] + t * p[1], x[2] + t * p[2], x[3] + t * p[3]};
}

}  // namespace

double largest_step(Features features, const Stencil& x, const Stencil& dx, double keep, double limit,
                    double radius_m) {
    constexpr int most_looks = 1000;
    return advance(features, x, dx, keep, limit, most_looks, radius_m).step;
}

Advance advance(Features features, const Stencil& x, const Stencil& dx, double keep, double limit, int most_looks,
                double radius_m) {
    Stencil p = dx;
    const Vec3 mean = 0.25 * (dx[0] + dx[1] + dx[2] + dx[3]);
    for (Vec3& v : p) v -= mean;
    const double speed = closing_speed(features, p);
    if (speed == 0) return {limit, true};
    // Most pairs are far apart compared with their motion.
    if (0.9 * (1 - keep) * (distance_bound(features, x) - radius_m) >= speed * limit) return {limit, true};
    const double start = distance(features, x) - radius_m, gap = keep * start;
    if (!(start > 0)) return {0, true};

    // The distance cannot fall to `gap` within this step; advance by nine tenths of it and check again.
    constexpr double near_enough = 0.01;
    double t = 0, ahead = 0.9 * (start - gap) / speed;
    for (int look = 0; look < most_looks; ++look) {
        if (t + ahead >= limit) return {limit, true};
        const double now = distance(features, moved(x, p, t + ahead)) - radius_m;
        if (now < gap) return {t, true};  // can only be due to rounding
        t += ahead;
        if (now - gap <= near_enough * gap) return {t, true};
        ahead = 0.9 * (now - gap) / speed;
    }
    return {t, false};
}

}  // namespace pliant::sim::contact
