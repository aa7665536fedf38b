#include "simulation/solver/wetted_skin.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "base/linalg/small.hpp"
#include "base/linalg/vectors.hpp"

namespace pliant::sim {

std::vector<std::array<int, 3>> wetted(std::vector<std::array<int, 3>> skin, std::span<const double> rest,
                                       const HeldNodes& held) {
    using linalg::Vector3;
    constexpr double rounding = 1e-6;  // of a direction
    std::map<int, const HeldNodes::Roller*> rollers;
    for (const HeldNodes::Roller& roller : held.rollers()) rollers[roller.node] = &roller;
    const auto slides_on_support = [&](const std::array<int, 3>& t) {
        const Vector3 a = linalg::view(rest, t[0]);
        const Vector3 normal = (linalg::view(rest, t[1]) - a).cross(linalg::view(rest, t[2]) - a).normalized();
        const auto is_roller = [&](int node) { return rollers.contains(node); };
        const auto is_held = [&](int node) {
            return held.is_fixed(node) || (is_roller(node) && (rollers.at(node)->may_move * normal).norm() < rounding);
        };
        return std::ranges::all_of(t, is_held) && std::ranges::any_of(t, is_roller);
    };
    std::erase_if(skin, slides_on_support);
    return skin;
}

}  // namespace pliant::sim
