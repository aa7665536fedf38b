#include "simulation/contact/intersection.hpp"

#include <algorithm>

namespace pliant::sim::contact {

bool segment_crosses_triangle(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2, Rim rim) {
    const Vec3 normal = cross(t1 - t0, t2 - t0);
    // In a coplanar face rounding puts the ends on either side: both must be clearly off the plane.
    constexpr double clear_share = 1e-9;
    const double from = dot(a - t0, normal), to = dot(b - t0, normal), least = clear_share * norm(normal) * norm(b - a);
    if (!(std::min(from, to) < -least && std::max(from, to) > least)) return false;
    // Seen along the segment, all three sides must wind around it in the same sense.
    const Vec3 d = b - a;
    const double s0 = dot(d, cross(t0 - a, t1 - a));
    const double s1 = dot(d, cross(t1 - a, t2 - a));
    const double s2 = dot(d, cross(t2 - a, t0 - a));
    if (rim == Rim::counts) return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
    return (s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0);
}

Vec3 point_in_plane(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2) {
    const Vec3 normal = cross(t1 - t0, t2 - t0);
    const double from = dot(a - t0, normal), to = dot(b - t0, normal);
    return a + from / (from - to) * (b - a);
}

}  // namespace pliant::sim::contact
