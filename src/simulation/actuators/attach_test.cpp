#include "simulation/actuators/attach.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "base/core/near.hpp"
#include "simulation/actuators/cable_path.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Position of the attachment if every node follows an affine map.
Vec3 mapped(const Attachment& point, const mesh::TetMesh& mesh) {
    const auto map = [](const Vec3& p) {
        return Vec3{1.1 * p.x - 0.3 * p.y + 2, 0.2 * p.x + 0.9 * p.y - 0.1 * p.z, p.z + 0.5 * p.y - 1};
    };
    Vec3 sum;
    for (std::size_t i = 0; i < point.nodes.size(); ++i)
        sum += point.weights[i] * map(mesh.points[static_cast<std::size_t>(point.nodes[i])]);
    return sum;
}

Vec3 expected(const Vec3& p) {
    return {1.1 * p.x - 0.3 * p.y + 2, 0.2 * p.x + 0.9 * p.y - 0.1 * p.z, p.z + 0.5 * p.y - 1};
}

}  // namespace

TEST_CASE("points and eyelets of any size follow affine motions exactly") {
    for (const int order : {1, 2}) {
        mesh::TetMesh mesh = reference::kuhn_box({10, 4, 4}, 10, 4, 4, [](Vec3) { return 0; });
        if (order == 2) mesh = mesh::to_quadratic(mesh);
        const Attacher attacher(mesh);
        for (const double radius : {0.0, 0.3, 1.5, 6.0}) {
            for (const Vec3& p : {Vec3{5.2, 1.7, 2.9}, Vec3{0, 0, 0}, Vec3{10, 2, 4}, Vec3{3, 2, 2}}) {
                const auto point = attacher.spread(p, radius, 1e-6);
                REQUIRE(point);
                CHECK(norm(mapped(*point, mesh) - expected(p)) < 1e-9);
                CHECK(point->nodes.size() <= 64);
            }
        }
        CHECK(attacher.spread({5, 2, 2}, 1.5, 1e-6)->nodes.size() > attacher.spread({5, 2, 2}, 0, 1e-6)->nodes.size());
    }
}

TEST_CASE("an eyelet does not reach across a gap") {
    // Two blocks side by side, joined by a bridge far from the point.
    mesh::TetMesh box =
        reference::kuhn_box({9, 2, 6}, 9, 2, 6, [](Vec3 c) { return c.x > 4 && c.x < 5 && c.z > 1 ? 1 : 0; });
    mesh::TetMesh mesh = box;
    mesh.nodes.clear();
    mesh.region.clear();
    for (std::size_t t = 0; t < box.tet_count(); ++t) {
        if (box.region[t] == 1) continue;
        mesh.nodes.insert(mesh.nodes.end(), box.tet(t).begin(), box.tet(t).end());
        mesh.region.push_back(0);
    }
    const Attacher attacher(mesh);
    const auto point = attacher.spread({3.9, 1, 5}, 2.5, 1e-6);
    REQUIRE(point);
    for (const int node : point->nodes) CHECK(mesh.points[static_cast<std::size_t>(node)].x <= 4);
}

TEST_CASE("a point outside is refused; one within the tolerance is carried by the nearest tet") {
    const mesh::TetMesh mesh = reference::kuhn_box({1, 1, 1}, 2, 2, 2, [](Vec3) { return 0; });
    const Attacher attacher(mesh);
    CHECK_FALSE(attacher.carried_by_tet({1.5, 0.5, 0.5}, 1e-3));
    CHECK(attacher.carried_by_tet({1.0005, 0.5, 0.5}, 1e-3));
}

namespace {

/// Half a ring of inner radius 8 and outer radius 10 in few quadratic tets, their nodes on circles.
mesh::TetMesh half_ring() {
    mesh::TetMesh mesh =
        mesh::to_quadratic(reference::kuhn_box({std::numbers::pi, 2, 2}, 5, 1, 1, [](Vec3) { return 0; }));
    for (Vec3& p : mesh.points) p = (8 + p.y) * Vec3{std::cos(p.x), std::sin(p.x), 0} + Vec3{0, 0, p.z};
    return mesh;
}

}  // namespace

TEST_CASE("points in curved tets keep their place, and a cable round a bollard loses tension as Euler says") {
    const mesh::TetMesh mesh = half_ring();
    std::vector<double> rest;
    for (const Vec3& p : mesh.points) rest.insert(rest.end(), {p.x, p.y, p.z});
    const Attacher attacher(mesh);
    // Just under the outer surface, where chords would cut off 0.38 of the bulge.
    constexpr int guides = 41;
    constexpr double radius = 9.95, turn = 0.98 * std::numbers::pi, friction = 0.3;
    Cable cable{"belt", {}, {CableTarget::Kind::tension_N, 1}, friction};
    double farthest = 0;
    for (int k = 0; k < guides; ++k) {
        const double angle = 0.01 * std::numbers::pi + turn * k / (guides - 1);
        const Vec3 p{radius * std::cos(angle), radius * std::sin(angle), 1};
        const auto point = attacher.carried_by_tet(p, 1e-2);
        REQUIRE(point);
        farthest = std::max(farthest, norm(position(*point, rest) - p));
        cable.points.push_back(*point);
    }
    CHECK(farthest < 1e-9);
    // The directions of the first and the last segment differ by one step less than the number of guides.
    const CablePath path(cable.points, rest);
    const double left = path.tension_shares(rest, friction, true).back();
    CHECK(left == near(std::exp(-friction * turn * (guides - 2) / (guides - 1)), {.relative = 1e-12}));
}

TEST_CASE("a point just outside keeps its place, and moves as if on a rigid arm on the nearest face") {
    for (const int order : {1, 2}) {
        mesh::TetMesh mesh = reference::kuhn_box({10, 4, 4}, 10, 4, 4, [](Vec3) { return 0; });
        if (order == 2) mesh = mesh::to_quadratic(mesh);
        const Attacher attacher(mesh);
        for (const Vec3& p : {Vec3{10.3, 2.2, 2.1}, Vec3{5.1, -0.4, 1.2}, Vec3{-0.2, -0.2, 4.3}}) {
            CHECK_FALSE(attacher.carried_by_tet(p, 0.1));
            const auto point = attacher.carried_by_tet(p, 0.5);
            REQUIRE(point);
            CHECK(norm(mapped(*point, mesh) - expected(p)) < 1e-9);
        }
        CHECK(attacher.distance_outside({10.3, 2.2, 2.1}) == near(0.3, {.relative = 1e-12}));
    }
}
