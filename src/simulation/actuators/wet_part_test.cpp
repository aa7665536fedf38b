// What lies below the level of a fluid: triangles against their division into many, a box against the polygon that its
// side has under water.
#include "simulation/actuators/wet_part.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/fluid_forces.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Sums over the middles of the n^2 triangles into which a triangle is divided.
struct Sums {
    double square = 0, wet = 0;
};
Sums sums_of(const Depths& d, int n) {
    Sums sums;
    const auto add = [&](double a, double b) {
        const double depth = d[0] + (d[1] - d[0]) * a / n + (d[2] - d[0]) * b / n;
        if (!(depth > 0)) return;
        sums.square += depth * depth / 2 / (n * n);
        sums.wet += 1.0 / (n * n);
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
            add(i + 1.0 / 3, j + 1.0 / 3);
            if (i + j + 1 < n) add(i + 2.0 / 3, j + 2.0 / 3);
        }
    }
    return sums;
}

/// Corners of a box around the origin, turned about the y axis.
std::vector<double> turned_box(double width, double length, double height, double angle) {
    const Eigen::AngleAxisd turn(angle, linalg::Vector3::UnitY());
    std::vector<double> x;
    for (int k = 0; k < 8; ++k) {
        const auto half = [&](int bit, double size) { return ((k >> bit) & 1) != 0 ? 0.5 * size : -0.5 * size; };
        const linalg::Vector3 at = turn * linalg::Vector3(half(0, width), half(1, length), half(2, height));
        x.insert(x.end(), at.data(), at.data() + 3);
    }
    return x;
}

const std::vector<std::array<int, 3>> box_skin = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                                  {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

struct Section {
    double area = 0, x = 0;  ///< and the x of its centroid
};
/// Of the polygon that a turned rectangle has below `level`, in the plane of x and z.
Section section_below(double width, double height, double angle, double level) {
    std::vector<Eigen::Vector2d> corners, below;
    for (const auto& [u, w] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
        const double a = u * width, b = w * height;
        corners.emplace_back(std::cos(angle) * a + std::sin(angle) * b, -std::sin(angle) * a + std::cos(angle) * b);
    }
    for (std::size_t k = 0; k < 4; ++k) {
        const Eigen::Vector2d &p = corners[k], &q = corners[(k + 1) % 4];
        if (p.y() < level) below.push_back(p);
        if ((p.y() < level) != (q.y() < level)) below.push_back(p + (level - p.y()) / (q.y() - p.y()) * (q - p));
    }
    Section section;
    double moment = 0;
    for (std::size_t k = 0; k < below.size(); ++k) {
        const Eigen::Vector2d &p = below[k], &q = below[(k + 1) % below.size()];
        const double twice = p.x() * q.y() - q.x() * p.y();
        section.area += twice / 2;
        moment += twice * (p.x() + q.x()) / 6;
    }
    section.x = section.area > 0 ? moment / section.area : 0;
    return section;
}

}  // namespace

TEST_CASE("the mean square of the depth and the wet share are those of many small triangles") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> depth(-1, 1);
    for (int k = 0; k < 30; ++k) {
        const Depths d{depth(random), depth(random), depth(random)};
        const Sums sums = sums_of(d, 300);
        CHECK(mean_square(d, true).value == near(sums.square, {.absolute = 1e-5}));
        CHECK(wet_share(d) == near(sums.wet, {.absolute = 5e-3}));
    }
}

TEST_CASE("derivatives of the mean square are those of its value, whatever the level cuts") {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> depth(-1, 1);
    for (int k = 0; k < 60; ++k) {
        const Depths d{depth(random), depth(random), depth(random)};
        for (const bool is_cut : {false, true}) {
            const MeanSquare mean = mean_square(d, is_cut);
            CHECK((mean.second - mean.second.transpose()).norm() == 0);
            for (std::size_t i = 0; i < 3; ++i) {
                constexpr double step = 1e-5;
                Depths up = d, down = d;
                up[i] += step;
                down[i] -= step;
                const MeanSquare above = mean_square(up, is_cut), below = mean_square(down, is_cut);
                const auto column = static_cast<Eigen::Index>(i);
                CHECK(mean.first[column] == near((above.value - below.value) / (2 * step), {.absolute = 1e-9}));
                CHECK((mean.second.col(column) - (above.first - below.first) / (2 * step)).norm() < 1e-6);
            }
        }
    }
}

TEST_CASE("a triangle that touches the level with a corner or an edge is wholly wet or dry") {
    CHECK(mean_square({0, 1, 2}, true).value == near(mean_square({0, 1, 2}, false).value, {.relative = 1e-14}));
    CHECK(mean_square({0, 0, 2}, true).value == near(mean_square({0, 0, 2}, false).value, {.relative = 1e-14}));
    CHECK(mean_square({0, -1, -2}, true).value == 0);
    CHECK(mean_square({0, 0, 0}, true).first.norm() == 0);
    CHECK(wet_share({0, 1, 2}) == 1);
    CHECK(wet_share({0, 0, -1}) == 0);
}

TEST_CASE("lift and torque of a box are those of the polygon below the level, at any angle and depth") {
    constexpr double length = 0.2;
    const FluidForces::Gravity gravity{{0, 0, -9.81}};
    for (const auto& [width, height] : {std::pair{0.04, 0.1}, {0.1, 0.004}, {0.02, 0.02}}) {
        for (const double degrees : {0.0, 3.0, 10.0, 30.0, 45.0, 80.0, 170.0}) {
            for (const double level : {-0.4, -0.1, 0.0, 0.2, 0.45}) {
                const double angle = degrees * std::acos(-1) / 180;
                Fluid fluid{1000, 0, 0, {}, {}, {}};
                fluid.level_m = level * height;
                const std::vector<double> x = turned_box(width, length, height, angle);
                std::vector<double> on(24, 0.0);
                FluidForces(fluid, box_skin).add_buoyancy(x, gravity, on);
                linalg::Vector3 force = linalg::Vector3::Zero(), torque = linalg::Vector3::Zero();
                for (std::size_t k = 0; k < 24; k += 3) {
                    const linalg::Vector3 f(-on[k], -on[k + 1], -on[k + 2]), at(x[k], x[k + 1], x[k + 2]);
                    force += f;
                    torque += at.cross(f);
                }
                const Section section = section_below(width, height, angle, *fluid.level_m);
                const double lift = 9810 * section.area * length, full = 9810 * width * height * length;
                CAPTURE(width);
                CAPTURE(degrees);
                CAPTURE(level);
                CHECK(force.z() == near(lift, {.absolute = 1e-12 * full}));
                CHECK(torque.y() == near(-lift * section.x, {.absolute = 1e-12 * full}));
                CHECK(force.head<2>().norm() < 1e-12 * full);
            }
        }
    }
}
