// The free rotation of four nodes against closed forms, conservation laws, a finer integration and differences.
#include "simulation/elements/free_rotation.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim;
using Eigen::Vector3d;
using Nodes = FreeRotation::Nodes;

namespace {

/// Corners of a tetrahedron with three different moments of inertia about the axes.
Nodes some_nodes() {
    Nodes x;
    x << 1, -1, -1, 1, 2, 2, -2, -2, 0.5, -0.5, 0.5, -0.5;
    return x.colwise() + Vector3d(3, -4, 5);
}

Nodes spinning(const Nodes& x, const Vector3d& omega) {
    Nodes v;
    const Vector3d centre = x.rowwise().mean();
    for (int a = 0; a < 4; ++a) v.col(a) = omega.cross(x.col(a) - centre) + Vector3d(7, -8, 9);
    return v;
}

Nodes random_nodes(std::mt19937& engine) {
    std::normal_distribution<double> random;
    return Nodes::NullaryExpr([&] { return random(engine); });
}

Vector3d momentum(const FreeRotation::Motion& m) {
    Vector3d sum = Vector3d::Zero();
    for (int a = 0; a < 4; ++a) sum += m.x.col(a).cross(m.v.col(a));
    return sum;
}

}  // namespace

TEST_CASE("a free spin about a principal axis is a uniform rotation") {
    const Nodes x = some_nodes(), arms = x.colwise() - Vector3d(x.rowwise().mean());
    for (int axis = 0; axis < 3; ++axis) {
        const FreeRotation free(x, spinning(x, 3 * Vector3d::Unit(axis)));
        for (const double time : {-0.4, 0.0, 1e-4, 0.7}) {
            const FreeRotation::Motion m = free.at(time);
            const Nodes wanted = Eigen::AngleAxisd(3 * time, Vector3d::Unit(axis)).toRotationMatrix() * arms;
            CHECK((m.x - wanted).norm() < 1e-14 * arms.norm());
            Nodes inwards = -9 * wanted;
            inwards.row(axis).setZero();
            CHECK((m.a - inwards).norm() < 1e-13 * inwards.norm());
        }
    }
}

TEST_CASE("a body that tumbles freely keeps its angular momentum and energy and comes back the same way") {
    const Nodes x = some_nodes();
    const Vector3d omega(0.3, 2.9, -0.2);  // near the middle axis, which is unstable
    const FreeRotation free(x, spinning(x, omega));
    const auto start = free.at(0);
    for (const double time : {0.1, 2.0, -5.0}) {
        const auto end = free.at(time);
        CHECK((momentum(end) - momentum(start)).norm() < 1e-13 * momentum(start).norm());
        CHECK(end.v.squaredNorm() == near(start.v.squaredNorm(), {.relative = 1e-9}));
        CHECK((FreeRotation(end.x, end.v).at(-time).x - start.x).norm() < 1e-8 * start.x.norm());
    }
    // Euler's equations: the derivative of each is the next.
    const double h = 1e-3, time = 0.3;
    const auto before = free.at(time - h), now = free.at(time), after = free.at(time + h);
    CHECK(((after.x - before.x) / (2 * h) - now.v).norm() < 1e-5 * now.v.norm());
    CHECK(((after.v - before.v) / (2 * h) - now.a).norm() < 1e-5 * now.a.norm());
}

TEST_CASE("a long free rotation is that of many short ones") {
    const Nodes x = some_nodes();
    const FreeRotation free(x, spinning(x, {1, 2, -0.7}));
    const double time = 0.3;
    FreeRotation::Motion piece = free.at(0);
    constexpr int pieces = 512;
    for (int k = 0; k < pieces; ++k) piece = FreeRotation(piece.x, piece.v).at(time / pieces);
    CHECK((free.at(time).x - piece.x).norm() < 1e-10 * piece.x.norm());
}

TEST_CASE("changes of a free rotation are its differences") {
    std::mt19937 engine(1);
    for (const double speed : {0.0, 1e-3, 2.0}) {
        const Nodes x = random_nodes(engine), v = speed * random_nodes(engine);
        const Nodes dx = random_nodes(engine), dv = random_nodes(engine);
        for (const double time : {-0.2, 0.0, 0.3}) {
            const double h = 1e-4;
            const auto at = [&](double share) { return FreeRotation(x + share * h * dx, v + share * h * dv).at(time); };
            const auto one = at(1), other = at(-1), two = at(2), far = at(-2);
            const auto slope = [&](const Nodes FreeRotation::Motion::*part) -> Nodes {
                return (8 * (one.*part - other.*part) - (two.*part - far.*part)) / (12 * h);
            };
            const auto told = FreeRotation(x, v).change(time, dx, dv);
            CHECK((told.x - slope(&FreeRotation::Motion::x)).norm() < 1e-9 * (1 + told.x.norm()));
            CHECK((told.v - slope(&FreeRotation::Motion::v)).norm() < 1e-9 * (1 + told.v.norm()));
            CHECK((told.a - slope(&FreeRotation::Motion::a)).norm() < 1e-9 * (1 + told.a.norm()));
        }
    }
}
