// Obstacles act where they are drawn, whatever the contact distance: against prescribed motions and against Hertz.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::mm;
using testing::solve;

namespace {

mesh::TriMesh box(const Vec3& low, const Vec3& high) {
    mesh::TriMesh m;
    for (int k = 0; k < 8; ++k)
        m.points.push_back({k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z});
    m.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return m;
}

/// An octahedron, its triangles divided and thrown onto the sphere.
mesh::TriMesh ball(const Vec3& centre, double radius, int divisions) {
    mesh::TriMesh m{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                    {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
    for (int d = 0; d < divisions; ++d) {
        std::vector<std::array<int, 3>> finer;
        std::map<std::pair<int, int>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(m.points.size()));
            if (fresh) {
                const Vec3 p = m.points[static_cast<std::size_t>(a)] + m.points[static_cast<std::size_t>(b)];
                m.points.push_back(p / norm(p));
            }
            return at->second;
        };
        for (const auto& t : m.triangles) {
            const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
            finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
        }
        m.triangles = std::move(finer);
    }
    for (Vec3& p : m.points) p = centre + radius * p;
    return m;
}

/// A block on the ground, [-half, half]² x [-depth, 0], finest at the origin, where the ball comes down; its bottom is
/// held.
Description block(double half, double depth, int cells, int layers, double nu, int order = 1) {
    Description d;
    d.mesh = reference::kuhn_box({2, 2, 1}, 2 * cells, 2 * cells, layers, [](Vec3) { return 0; });
    for (Vec3& p : d.mesh.points) {
        const auto graded = [](double s) { return std::copysign(std::pow(std::fabs(s), 2.0), s); };
        p = {half * graded(p.x - 1), half * graded(p.y - 1), -depth * graded(1 - p.z)};
    }
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"rubber", material::neo_hookean(1e6, nu), 1000}};
    d.material_of_region = {0};
    const double bottom = -depth + 1e-9;
    d.supports = {{"ground", reference::nodes_where(d.mesh, [&](Vec3 p) { return p.z < bottom; }), {}}};
    return d;
}

void press(Description& d, contact::Obstacle obstacle, double distance_m, double down_m) {
    d.contact = ContactRules{contact::robot_surface(d.mesh), {.distance_m = distance_m, .stiffness_Pa = 1e5}, {}};
    d.contact->obstacles.push_back({std::move(obstacle), {0, 0, -down_m}});
}

}  // namespace

TEST_CASE("a body pressed by a plane or a block resists as if its face were moved there") {
    // 10 mm high, without sideways strain, pressed down by 0.3 mm; the distance of contact is a third of that.
    const auto bare = [] {
        Description d = block(5 * mm, 10 * mm, 2, 4, 0.0);
        return d;
    };
    Description moved = bare();
    moved.supports.push_back(
        {"top", reference::nodes_where(moved.mesh, [](Vec3 p) { return p.z > -1e-9; }), {0, 0, -0.3 * mm}});
    const Trajectory truth = solve(moved, {.steps = 1});
    REQUIRE(truth.converged);
    const double wanted = -truth.steps.back().supports[1].force_N.z;
    const contact::HalfSpace plane{{0, 0, 0.2 * mm}, {0, 0, -1}};
    const mesh::TriMesh slab = box({-8 * mm, -8 * mm, 0.2 * mm}, {8 * mm, 8 * mm, 4 * mm});
    for (const contact::Obstacle& obstacle : {contact::Obstacle{"plane", plane}, contact::Obstacle{"slab", slab}}) {
        CAPTURE(obstacle.name);
        Description d = bare();
        press(d, obstacle, 0.1 * mm, 0.5 * mm);
        const Trajectory result = solve(d, {.steps = 5});
        REQUIRE_MESSAGE(result.converged, result.message);
        const double force = -result.steps.back().contacts[0].force_N.z;
        // Without insets it would be too stiff by 0.85 of the distance: 28 %.
        CHECK(force == near(wanted, {.relative = 0.03}));
    }
}

TEST_CASE("a rigid ball on an elastic block presses as Hertz says, whatever the contact reach") {
    // Hertz for a half-space; for a layer of finite depth h on which it is bonded to the ground, the first terms of
    // Dimitriadis et al. 2002 in chi = sqrt(R delta)/h.
    constexpr double radius = 10 * mm, pressed = 0.4 * mm, gap = 0.3 * mm, nu = 0.3, depth = 30 * mm;
    const double hertz = 4.0 / 3 * 1e6 / (1 - nu * nu) * std::sqrt(radius) * std::pow(pressed, 1.5);
    const double chi = std::sqrt(radius * pressed) / depth;
    const double alpha = (1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1 - nu), term = 2 * alpha * chi / M_PI;
    const double wanted = hertz * (1 + term + term * term);
    std::vector<double> forces;
    for (const double reach : {0.12 * mm, 0.06 * mm}) {
        for (const bool exact : {false, true}) {
            Description d = block(30 * mm, depth, 9, 9, nu, 2);
            const Vec3 centre{0, 0, radius + gap};
            contact::Obstacle obstacle{"ball", contact::Sphere{centre, radius}};
            if (!exact) obstacle.shape = ball(centre, radius, 5);
            press(d, obstacle, reach, gap + pressed);
            const Trajectory result = solve(d, {.steps = 2});
            REQUIRE_MESSAGE(result.converged, result.message);
            forces.push_back(-result.steps.back().contacts[0].force_N.z);
            CHECK(forces.back() == near(wanted, {.relative = 0.05}));
        }
    }
    // Without insets those of one reach would differ by a sixth from those of the other.
    for (const double force : forces) CHECK(force == near(forces[0], {.relative = 0.03}));
}

TEST_CASE("a contact reach much smaller than an obstacle's step does not slow the step") {
    Description d = block(5 * mm, 10 * mm, 3, 4, 0.3);
    press(d, {"ball", ball({0, 0, 6 * mm + 0.2 * mm}, 6 * mm, 4)}, 0.002 * mm, 1.2 * mm);
    const Trajectory result = solve(d, {.steps = 3});
    REQUIRE_MESSAGE(result.converged, result.message);
    // 500 times the reach in 3 steps: with pieces no longer than the gap, hundreds of them.
    CHECK(result.iterations.size() < 150);
}
