// The camera of the pictures: one view for the whole motion, chosen from the motion itself.
#pragma once

#include <array>
#include <span>

#include "base/core/vec3.hpp"

namespace pliant::report {

/// A pinhole camera. A pixel at (u, v) in [-1, 1]^2 (u to the right, v up) looks along
/// forward + u * half_width * right + v * half_height * up.
struct Camera {
    Vec3 eye, right, up, forward;  ///< metres; the directions are orthonormal
    double half_width = 0.2;       ///< tangent of half the horizontal field of view
    double half_height = 0.2;      ///< of half the vertical one

    [[nodiscard]] Vec3 direction(double u, double v) const {
        return forward + (u * half_width) * right + (v * half_height) * up;
    }
    /// (u, v) of a point in front of the camera, and its depth along `forward` in metres.
    [[nodiscard]] std::array<double, 3> project(const Vec3& point) const;
};

/// Looks along the axis of least motion (the front, -Y, if axes are about equal), a little from the side and from
/// above; Z is up in the picture unless it is the viewing axis, then Y. `rest` and each of `others` are positions of
/// the same points.
[[nodiscard]] Camera choose_view(std::span<const Vec3> rest, std::span<const std::span<const Vec3>> others);

/// A view requested by the user: `towards_eye` points from the robot to the camera. Z is up, or Y if the direction is
/// nearly along Z. Precondition: not zero.
[[nodiscard]] Camera view_from(const Vec3& towards_eye);

/// The same view moved so that all points just fit into a picture of `aspect` (width over height), keeping `margins`
/// (left, right, bottom, top, as shares of the picture) free.
[[nodiscard]] Camera fitted(Camera camera, std::span<const Vec3> points, double aspect,
                            const std::array<double, 4>& margins);

}  // namespace pliant::report
