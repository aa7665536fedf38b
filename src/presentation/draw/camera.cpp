#include "presentation/draw/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/boxes.hpp"

namespace pliant::report {
namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double half_field = 0.22;  // tangent of half the vertical field of view: a mild perspective

/// The axis along which the view shows most: least motion, then least extent. A tie goes to Y, then X, then Z.
std::size_t view_axis(std::span<const Vec3> rest, std::span<const std::span<const Vec3>> others) {
    const Box3 box = bounds_of(rest);
    Vec3 motion;
    for (const auto& positions : others) {
        for (std::size_t i = 0; i < rest.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                motion[k] = std::max(motion[k], std::abs(positions[i][k] - rest[i][k]));
            }
        }
    }
    std::size_t best = 1;
    const auto score = [&](std::size_t k) { return motion[k] + 0.05 * box.size()[k]; };
    for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
        if (score(k) < 0.8 * score(best)) best = k;
    }
    return best;
}

Camera looking_from(const Vec3& towards_eye, const Vec3& up) {
    Camera camera;
    camera.forward = -unit(towards_eye);
    camera.right = unit(cross(camera.forward, up));
    camera.up = cross(camera.right, camera.forward);
    return camera;
}

}  // namespace

std::array<double, 3> Camera::project(const Vec3& point) const {
    const Vec3 d = point - eye;
    const double depth = dot(d, forward);
    return {dot(d, right) / (depth * half_width), dot(d, up) / (depth * half_height), depth};
}

Camera choose_view(std::span<const Vec3> rest, std::span<const std::span<const Vec3>> others) {
    const double side = 24 * degree, raise = 20 * degree, tilt = 30 * degree;
    switch (view_axis(rest, others)) {
        case 0:
            return looking_from({std::cos(side) * std::cos(raise), -std::sin(side) * std::cos(raise), std::sin(raise)},
                                {0, 0, 1});
        case 1:
            return looking_from({std::sin(side) * std::cos(raise), -std::cos(side) * std::cos(raise), std::sin(raise)},
                                {0, 0, 1});
        default:
            return looking_from({std::sin(tilt) * 0.3, -std::sin(tilt), std::cos(tilt)}, {0, 1, 0});
    }
}

Camera view_from(const Vec3& towards_eye) {
    const Vec3 u = unit(towards_eye);
    return looking_from(u, std::abs(u.z) > 0.99 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
}

Camera fitted(Camera camera, std::span<const Vec3> points, double aspect, const std::array<double, 4>& margins) {
    camera.half_height = half_field * std::min(1.0, 1.6 / aspect);
    camera.half_width = camera.half_height * aspect;
    // A point fits if |offset| <= tangent * (depth + distance) on every side; the most demanding point of each side
    // decides. Margins reduce the tangent on their side.
    const std::array<double, 4> tangents = {
        camera.half_width * (1 - 2 * margins[0]), camera.half_width * (1 - 2 * margins[1]),
        camera.half_height * (1 - 2 * margins[2]), camera.half_height * (1 - 2 * margins[3])};
    std::array<double, 4> need = {-1e300, -1e300, -1e300, -1e300};
    for (const Vec3& p : points) {
        const double x = dot(p, camera.right), y = dot(p, camera.up), z = dot(p, camera.forward);
        const std::array<double, 4> outward = {-x, x, -y, y};
        for (std::size_t k = 0; k < 4; ++k) need[k] = std::max(need[k], outward[k] - tangents[k] * z);
    }
    const double across = (need[0] + need[1]) / (tangents[0] + tangents[1]);
    const double along = (need[2] + need[3]) / (tangents[2] + tangents[3]);
    const double distance = std::max({across, along, 1e-6});
    const auto centre = [&](std::size_t low, std::size_t high) {
        return 0.5 * ((need[high] - tangents[high] * distance) - (need[low] - tangents[low] * distance));
    };
    camera.eye = centre(0, 1) * camera.right + centre(2, 3) * camera.up - distance * camera.forward;
    return camera;
}

}  // namespace pliant::report
