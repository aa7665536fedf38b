#include "geometry/mesh/curved_point.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "base/core/near.hpp"
#include "geometry/mesh/curved_tets.hpp"
#include "geometry/mesh/test_tets.hpp"
#include "geometry/mesh/tet_locator.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

/// The straight tet of the unit axes with every mid-edge node moved by up to `bend`.
TetNodes bent_tet(std::mt19937& random, double bend) {
    TetNodes nodes = {Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::uniform_real_distribution<double> uniform(-bend, bend);
    for (std::size_t e = 0; e < 6; ++e) {
        const Vec3& a = nodes[static_cast<std::size_t>(edge_corners[e][0])];
        const Vec3& b = nodes[static_cast<std::size_t>(edge_corners[e][1])];
        nodes[4 + e] = 0.5 * (a + b) + Vec3{uniform(random), uniform(random), uniform(random)};
    }
    return nodes;
}

std::array<double, 4> random_inside(std::mt19937& random) {
    std::exponential_distribution<double> share(1);
    std::array<double, 4> b = {share(random), share(random), share(random), share(random)};
    const double sum = b[0] + b[1] + b[2] + b[3];
    for (double& value : b) value /= sum;
    return b;
}

/// An eighth of a spherical shell, radii 8 and 10, in quadratic tets whose nodes all lie on spheres.
TetMesh shell(int n) {
    TetMesh mesh;
    const auto at = [](double u, double v, double r) {
        const double a = 0.5 * 3.14159265358979323846 * u, c = 1.2 * v;
        return r * Vec3{std::cos(a) * std::cos(c), std::sin(a) * std::cos(c), std::sin(c)};
    };
    std::vector<Vec3> flat;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            for (int k = 0; k <= 1; ++k) mesh.points.push_back({1.0 * i / n, 1.0 * j / n, 8 + 2.0 * k});
        }
    }
    const auto node = [&](int i, int j, int k) { return (i * (n + 1) + j) * 2 + k; };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const int c[8] = {node(i, j, 0), node(i + 1, j, 0), node(i, j + 1, 0), node(i + 1, j + 1, 0),
                              node(i, j, 1), node(i + 1, j, 1), node(i, j + 1, 1), node(i + 1, j + 1, 1)};
            const int tets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
            for (const auto& t : tets) {
                for (const int corner : t) mesh.nodes.push_back(c[corner]);
                mesh.region.push_back(0);
            }
        }
    }
    mesh.region_names = {"shell"};
    mesh = to_quadratic(mesh);
    for (Vec3& p : mesh.points) p = at(p.x, p.y, p.z);
    return mesh;
}

}  // namespace

TEST_CASE("the inverse of the quadratic map gives points back") {
    std::mt19937 random(5);
    double worst = 0;
    for (int trial = 0; trial < 300; ++trial) {
        const TetNodes nodes = bent_tet(random, 0.06);
        for (int k = 0; k < 10; ++k) {
            const auto b = random_inside(random);
            const Vec3 p = curved_position(nodes, b);
            const CurvedPoint found = nearest_in_curved_tet(nodes, p);
            worst = std::max(worst, norm(curved_position(nodes, found.barycentric) - p));
            for (std::size_t i = 0; i < 4; ++i) CHECK(found.barycentric[i] == near(b[i], {.relative = 1e-9}));
        }
    }
    CHECK(worst < 1e-12);
}

TEST_CASE("degenerate and folded tets end with a point, not nearer than any other") {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform(-1, 2);
    for (int trial = 0; trial < 200; ++trial) {
        TetNodes nodes = bent_tet(random, trial % 2 == 0 ? 1.0 : 0.05);
        if (trial % 4 == 1)
            for (Vec3& p : nodes) p.z = 0;  // flat
        if (trial % 4 == 3)
            for (Vec3& p : nodes) p = nodes[0];  // a point
        const Vec3 p{uniform(random), uniform(random), uniform(random)};
        const CurvedPoint found = nearest_in_curved_tet(nodes, p);
        double sum = 0;
        for (const double b : found.barycentric) {
            CHECK(b >= 0);
            sum += b;
        }
        CHECK(sum == near(1, {.relative = 1e-12}));
        CHECK(norm(curved_position(nodes, found.barycentric) - p) ==
              near(found.distance, {.relative = 1e-12, .absolute = 1e-12}));
    }
}

TEST_CASE("the Bezier box contains its curved tet") {
    std::mt19937 random(7);
    for (int trial = 0; trial < 50; ++trial) {
        const TetNodes nodes = bent_tet(random, 0.3);
        const Box3 box = curved_bounds(nodes);
        for (int k = 0; k < 100; ++k) CHECK(box.contains(curved_position(nodes, random_inside(random)), 1e-12));
    }
}

TEST_CASE("a locator finds points of a curved mesh where they are") {
    const TetMesh mesh = shell(3);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) REQUIRE(worst_scaled_jacobian(mesh, t) > 0);
    const TetLocator locator(mesh);
    std::mt19937 random(8);
    std::uniform_int_distribution<std::size_t> any(0, mesh.tet_count() - 1);
    for (int trial = 0; trial < 400; ++trial) {
        const TetNodes nodes = nodes_of(mesh, any(random));
        const Vec3 p = curved_position(nodes, random_inside(random));
        const auto found = locator.locate(p);
        CHECK(found.distance == 0);
        const Vec3 back = curved_position(nodes_of(mesh, static_cast<std::size_t>(found.tet)), found.barycentric);
        CHECK(norm(back - p) < 1e-11);
    }
    // Just inside the bulge, outside every straight tet.
    const Vec3 p = 9.99 * Vec3{std::cos(0.26) * std::cos(0.2), std::sin(0.26) * std::cos(0.2), std::sin(0.2)};
    CHECK(locator.locate(p).distance < 1e-3);
    // Outside, the distance is that to the sphere, up to the error of the mesh.
    const Vec3 q = 1.1 * p;
    CHECK(locator.locate(q).distance == near(norm(q) - 10, {.relative = 5e-3}));
}
