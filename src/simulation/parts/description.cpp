#include "simulation/parts/description.hpp"

#include "base/core/rotation.hpp"

namespace pliant::sim {

Vec3 Support::position(const Vec3& rest, double share_now) const {
    const Vec3 shift = share_now * move_m;
    if (turn.angle_rad == 0) return rest + shift;
    return turn.center_m + turned(rest - turn.center_m, unit(turn.axis), share_now * turn.angle_rad) + shift;
}

Vec3 Support::turned_arm(const Vec3& arm, double share_now) const {
    return turned(arm, unit(turn.axis), share_now * turn.angle_rad);
}

Vec3 Support::arc(const Vec3& rest, double share_now) const {
    return share_now * cross(unit(turn.axis), turned_arm(rest - turn.center_m, share_now));
}

Vec3 Support::velocity(const Vec3& rest, double share_now) const {
    return move_m + turn.angle_rad * cross(unit(turn.axis), turned_arm(rest - turn.center_m, share_now));
}

Vec3 position(const Attachment& point, std::span<const double> x) {
    return point.fixed + motion(point, x);
}

Vec3 motion(const Attachment& point, std::span<const double> v) {
    Vec3 sum;
    for (std::size_t i = 0; i < point.nodes.size(); ++i) {
        const double* p = v.data() + 3 * static_cast<std::size_t>(point.nodes[i]);
        sum += point.weights[i] * Vec3{p[0], p[1], p[2]};
    }
    return sum;
}

Attachment AttachedFrame::at(const Vec3& arm) const {
    Attachment point{nodes, weights, {}};
    for (std::size_t i = 0; i < nodes.size(); ++i) point.weights[i] += dot(gradients[i], arm);
    return point;
}

}  // namespace pliant::sim
