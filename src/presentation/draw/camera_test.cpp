#include "presentation/draw/camera.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "base/core/near.hpp"
#include "presentation/draw/stage_layout.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

std::vector<Vec3> box_corners(const Vec3& size) {
    std::vector<Vec3> points;
    for (int i = 0; i < 8; ++i) {
        points.push_back({(i & 1) != 0 ? size.x : 0, (i & 2) != 0 ? size.y : 0, (i & 4) != 0 ? size.z : 0});
    }
    return points;
}

Camera view_of_motion(const Vec3& motion) {
    const auto rest = box_corners({1, 1, 1});
    std::vector<Vec3> moved = rest;
    for (Vec3& p : moved) p += motion;
    const std::vector<std::span<const Vec3>> others = {moved};
    return choose_view(rest, others);
}

}  // namespace

TEST_CASE("the camera looks along the axis of least motion") {
    CHECK(view_of_motion({1, 0, 1}).forward.y > 0.8);
    CHECK(view_of_motion({0, 1, 1}).forward.x < -0.8);
    CHECK(view_of_motion({1, 1, 0}).forward.z < -0.8);
    CHECK(view_of_motion({1, 1, 0}).up.y > 0.8);
    CHECK(view_of_motion({1, 0, 1}).up.z > 0.8);
    CHECK(view_of_motion({1, 0, 1}).right.x > 0.8);
    CHECK(view_of_motion({0, 0, 0}).forward.y > 0.8);
}

TEST_CASE("the axes of a view are orthonormal and right-handed") {
    for (const Vec3& motion : {Vec3{1, 0, 1}, Vec3{0, 1, 1}, Vec3{1, 1, 0}}) {
        const Camera c = view_of_motion(motion);
        CHECK(norm(c.forward) == near(1, {.relative = 1e-12}));
        CHECK(norm(cross(c.right, c.up) + c.forward) < 1e-12);
    }
}

TEST_CASE("the direction of view can be given") {
    const Camera front = view_from({0, -2, 0});
    CHECK(norm(front.forward - Vec3{0, 1, 0}) < 1e-12);
    CHECK(norm(front.up - Vec3{0, 0, 1}) < 1e-12);
    const Camera top = view_from({0, 0, 5});
    CHECK(norm(top.forward - Vec3{0, 0, -1}) < 1e-12);
    CHECK(norm(top.up - Vec3{0, 1, 0}) < 1e-12);
    CHECK(norm(view_from({1, -1, 1}).forward - unit(Vec3{-1, 1, -1})) < 1e-12);
}

TEST_CASE("a fitted camera shows every point and fills the picture up to its margins") {
    const auto points = box_corners({0.1, 0.02, 0.3});
    for (const double aspect : {0.5, 1.0, 1.6, 4.0}) {
        const std::array<double, 4> margins = {0.05, 0.10, 0.15, 0.20};
        const Camera camera = fitted(view_of_motion({1, 0, 1}), points, aspect, margins);
        double left = 1, right = -1, bottom = 1, top = -1;
        for (const Vec3& p : points) {
            const auto [u, v, depth] = camera.project(p);
            CHECK(depth > 0);
            left = std::min(left, u);
            right = std::max(right, u);
            bottom = std::min(bottom, v);
            top = std::max(top, v);
        }
        CHECK(left >= -0.90 - 1e-9);
        CHECK(right <= 0.80 + 1e-9);
        CHECK(bottom >= -0.70 - 1e-9);
        CHECK(top <= 0.60 + 1e-9);
        const bool wide = std::abs(left + 0.90) < 1e-9 && std::abs(right - 0.80) < 1e-9;
        const bool high = std::abs(bottom + 0.70) < 1e-9 && std::abs(top - 0.60) < 1e-9;
        CHECK((wide || high));
    }
}

TEST_CASE("projection and ray agree") {
    const Camera camera = fitted(view_of_motion({1, 0, 1}), box_corners({1, 2, 3}), 1.6, {0, 0, 0, 0});
    const Vec3 point = camera.eye + 7 * camera.direction(0.25, -0.5);
    const auto [u, v, depth] = camera.project(point);
    CHECK(u == near(0.25, {.relative = 1e-12}));
    CHECK(v == near(-0.5, {.relative = 1e-12}));
    CHECK(depth == near(7, {.relative = 1e-12}));
}

TEST_CASE("stages are rest, end and evenly spaced steps between") {
    const auto points = box_corners({0.1, 0.02, 0.06});
    const StageLayout layout = lay_out_stages(view_of_motion({1, 0, 1}), points, 31, 1600, 880);
    CHECK(layout.columns == 2);
    CHECK(layout.rows == 2);
    CHECK(layout.panel_width_px == 800);
    CHECK(layout.panel_height_px == 440);
    CHECK(layout.steps == std::vector<std::size_t>{0, 10, 20, 30});
    CHECK(lay_out_stages(view_of_motion({1, 0, 1}), points, 1, 1600, 880).steps == std::vector<std::size_t>{0});
    CHECK(lay_out_stages(view_of_motion({1, 0, 1}), points, 2, 1600, 880).steps == std::vector<std::size_t>{0, 1});
    const StageLayout tall = lay_out_stages(view_of_motion({1, 0, 1}), box_corners({0.01, 0.01, 0.2}), 31, 1600, 880);
    CHECK(tall.columns > tall.rows);
}
