#include "simulation/parts/description.hpp"

#include <cmath>

namespace pliant::sim {

Vec3 Support::position(const Vec3& rest, double share_now) const {
    // Rodrigues' formula.
    const Vec3 k = turn.axis / norm(turn.axis);
    const Vec3 arm = rest - turn.center_m;
    const double angle = share_now * turn.angle_rad;
    const Vec3 turned =
        std::cos(angle) * arm + std::sin(angle) * cross(k, arm) + (1 - std::cos(angle)) * dot(k, arm) * k;
    return (turn.angle_rad == 0 ? rest : turn.center_m + turned) + share_now * move_m;
}

Vec3 position(const Attachment& point, std::span<const double> x) {
    if (point.nodes.empty()) return point.fixed;
    Vec3 sum;
    for (std::size_t i = 0; i < point.nodes.size(); ++i) {
        const double* p = x.data() + 3 * static_cast<std::size_t>(point.nodes[i]);
        sum += point.weights[i] * Vec3{p[0], p[1], p[2]};
    }
    return sum;
}

}  // namespace pliant::sim
