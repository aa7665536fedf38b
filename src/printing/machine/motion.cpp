#include "printing/machine/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::machine {

double Profile::seconds() const {
    if (length_mm <= 0) return 0;
    const double j = jerk_mm_s;
    const double top = std::min(speed_mm_s, std::sqrt(length_mm * acceleration_mm_s2 + j * j));
    const double ramps_mm = (top * top - j * j) / acceleration_mm_s2;
    return 2 * (top - j) / acceleration_mm_s2 + std::max(0.0, length_mm - ramps_mm) / top;
}

double Profile::share_at(double t_s) const {
    const double total = seconds();
    if (t_s >= total) return 1;
    if (t_s <= 0) return 0;
    const double j = jerk_mm_s;
    const double top = std::min(speed_mm_s, std::sqrt(length_mm * acceleration_mm_s2 + j * j));
    const double ramp = (top - j) / acceleration_mm_s2;
    const auto ramped = [&](double t) { return j * t + acceleration_mm_s2 * t * t / 2; };
    double done = 0;
    if (t_s < ramp) {
        done = ramped(t_s);
    } else if (t_s <= total - ramp) {
        done = ramped(ramp) + top * (t_s - ramp);
    } else {
        done = length_mm - ramped(total - t_s);
    }
    return std::clamp(done / length_mm, 0.0, 1.0);
}

double Profile::seconds_to(double share) const {
    const double total = seconds();
    if (share <= 0 || total <= 0) return 0;
    if (share >= 1) return total;
    double low = 0, high = total;
    constexpr int halvings = 60;  // exact to the last bit for any duration of a move
    for (int i = 0; i < halvings; ++i) {
        const double middle = (low + high) / 2;
        (share_at(middle) < share ? low : high) = middle;
    }
    return high;
}

Profile profile(const Printer& printer, const Position& from, const Position& to, double feed_mm_s) {
    Profile p;
    for (const Axis axis : all_axes) {
        const double way = (to[axis] - from[axis]) / 1000.0;
        p.length_mm += way * way;
    }
    p.length_mm = std::sqrt(p.length_mm);
    p.speed_mm_s = feed_mm_s > 0 ? feed_mm_s : std::numeric_limits<double>::max();
    p.acceleration_mm_s2 = std::numeric_limits<double>::max();
    double jerk = std::numeric_limits<double>::max();
    for (const Axis axis : all_axes) {
        const double way = std::abs(to[axis] - from[axis]) / 1000.0;
        if (way == 0) continue;
        const double share = way / p.length_mm;
        p.speed_mm_s = std::min(p.speed_mm_s, printer.axis(axis).speed_mm_s / share);
        p.acceleration_mm_s2 = std::min(p.acceleration_mm_s2, printer.axis(axis).acceleration_mm_s2 / share);
        jerk = std::min(jerk, printer.axis(axis).jerk_mm_s / share);
    }
    p.jerk_mm_s = std::min(jerk, p.speed_mm_s);
    return p;
}

double move_seconds(const Printer& printer, const Position& from, const Position& to, double feed_mm_s) {
    return profile(printer, from, to, feed_mm_s).seconds();
}

Position position_at(const Profile& profile, const Position& from, const Position& to, double t_s) {
    const double share = profile.share_at(t_s);
    Position now;
    for (const Axis axis : all_axes) {
        now[axis] = from[axis] + static_cast<int>(std::lround(share * (to[axis] - from[axis])));
    }
    return now;
}

double home_seconds(const Printer& printer, Axis axis, int from_um) {
    const AxisSpec& spec = printer.axis(axis);
    if (spec.homes_by_hand) return 0;
    return std::abs(spec.home_um() - from_um) / 1000.0 / spec.homing_speed_mm_s;
}

}  // namespace pliant::machine
