#include "simulation/scene/symmetry_planes.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/boxes.hpp"

namespace pliant::robot {
namespace {

constexpr double flat = 1e-6;  // of the robot's diagonal, or of a force

double diagonal(const sim::Description& description) {
    return bounds_of(description.mesh.points).diagonal();
}

}  // namespace

std::vector<sim::SymmetryPlane> symmetry_planes(const sim::Description& description) {
    const std::vector<Vec3>& points = description.mesh.points;
    const double tolerance = flat * diagonal(description);
    std::vector<sim::SymmetryPlane> planes;
    for (const sim::Support& support : description.supports) {
        constexpr std::size_t least = 3;  // fewer nodes make no plane
        if (support.moves() || support.directions.size() != 1 || support.nodes.size() < least) continue;
        sim::SymmetryPlane plane{points[static_cast<std::size_t>(support.nodes[0])], unit(support.directions[0]),
                                 std::vector<bool>(points.size(), false)};
        const auto lies_in_it = [&](int node) {
            const Vec3& p = points[static_cast<std::size_t>(node)];
            return std::fabs(dot(plane.normal, p - plane.point)) <= tolerance;
        };
        if (!std::ranges::all_of(support.nodes, lies_in_it)) continue;
        for (const int node : support.nodes) plane.holds[static_cast<std::size_t>(node)] = true;
        planes.push_back(std::move(plane));
    }
    return planes;
}

std::vector<sim::SymmetryPlane> planes_of_path(const sim::Description& description, std::span<const Vec3> points) {
    const double tolerance = flat * diagonal(description);
    std::vector<sim::SymmetryPlane> planes = symmetry_planes(description);
    std::erase_if(planes, [&](const sim::SymmetryPlane& plane) {
        return std::ranges::any_of(
            points, [&](const Vec3& p) { return std::fabs(dot(plane.normal, p - plane.point)) > tolerance; });
    });
    return planes;
}

std::vector<sim::SymmetryPlane> planes_of_force(const sim::Description& description, const Vec3& point,
                                                const Vec3& force) {
    std::vector<sim::SymmetryPlane> planes = planes_of_path(description, {&point, 1});
    std::erase_if(planes, [&](const sim::SymmetryPlane& plane) {
        return std::fabs(dot(plane.normal, force)) > flat * norm(force);
    });
    return planes;
}

}  // namespace pliant::robot
