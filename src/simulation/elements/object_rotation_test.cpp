// The rotation of four nodes against closed forms, conservation laws, a finer integration and differences.
#include "simulation/elements/object_rotation.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim;
using Eigen::Vector3d;
using Nodes = ObjectRotation::Nodes;

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

Vector3d momentum(const ObjectRotation::Motion& m) {
    Vector3d sum = Vector3d::Zero();
    for (int a = 0; a < 4; ++a) sum += m.x.col(a).cross(m.v.col(a));
    return sum;
}

}  // namespace

TEST_CASE("a free spin about a principal axis is a uniform rotation") {
    const Nodes x = some_nodes(), arms = x.colwise() - Vector3d(x.rowwise().mean());
    for (int axis = 0; axis < 3; ++axis) {
        const ObjectRotation free(x, spinning(x, 3 * Vector3d::Unit(axis)));
        for (const double time : {-0.4, 0.0, 1e-4, 0.7}) {
            const ObjectRotation::Motion m = free.at(time);
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
    const ObjectRotation free(x, spinning(x, omega));
    const auto start = free.at(0);
    for (const double time : {0.1, 2.0, -5.0}) {
        const auto end = free.at(time);
        CHECK((momentum(end) - momentum(start)).norm() < 1e-13 * momentum(start).norm());
        CHECK(end.v.squaredNorm() == near(start.v.squaredNorm(), {.relative = 1e-9}));
        CHECK((ObjectRotation(end.x, end.v).at(-time).x - start.x).norm() < 1e-8 * start.x.norm());
    }
    // Euler's equations: the derivative of each is the next.
    const double h = 1e-3, time = 0.3;
    const auto before = free.at(time - h), now = free.at(time), after = free.at(time + h);
    CHECK(((after.x - before.x) / (2 * h) - now.v).norm() < 1e-5 * now.v.norm());
    CHECK(((after.v - before.v) / (2 * h) - now.a).norm() < 1e-5 * now.a.norm());
}

TEST_CASE("a long free rotation is that of many short ones") {
    const Nodes x = some_nodes();
    const ObjectRotation free(x, spinning(x, {1, 2, -0.7}));
    const double time = 0.3;
    ObjectRotation::Motion piece = free.at(0);
    constexpr int pieces = 512;
    for (int k = 0; k < pieces; ++k) piece = ObjectRotation(piece.x, piece.v).at(time / pieces);
    CHECK((free.at(time).x - piece.x).norm() < 1e-10 * piece.x.norm());
}

TEST_CASE("a torque about a principal axis gives a uniform angular acceleration") {
    const Nodes x = some_nodes(), arms = x.colwise() - Vector3d(x.rowwise().mean());
    const Vector3d axis = Vector3d::Unit(1);
    const double inertia = arms.squaredNorm() - arms.row(1).squaredNorm(), start = 3, rate = 0.8;
    const ObjectRotation driven(x, spinning(x, start * axis), inertia * rate * axis);
    for (const double time : {-0.4, 0.0, 0.7}) {
        const ObjectRotation::Motion m = driven.at(time);
        const double angle = start * time + 0.5 * rate * time * time, speed = start + rate * time;
        const Nodes wanted = Eigen::AngleAxisd(angle, axis).toRotationMatrix() * arms;
        CHECK((m.x - wanted).norm() < 1e-12 * arms.norm());
        CHECK((m.v - Eigen::AngleAxisd(0.5 * M_PI, axis).toRotationMatrix() * speed *
                         (wanted - axis * axis.transpose() * wanted))
                  .norm() < 1e-12 * m.v.norm());
        CHECK((m.a - (spinning(wanted, rate * axis).colwise() - Vector3d(7, -8, 9)) +
               speed * speed * (wanted - axis * axis.transpose() * wanted))
                  .norm() < 1e-12 * m.a.norm());
    }
}

TEST_CASE("a torque about any axis changes the angular momentum at its rate, and the motion at its derivatives") {
    const Nodes x = some_nodes();
    const Vector3d torque(20, -30, 10);
    const ObjectRotation driven(x, spinning(x, {0.3, 2.9, -0.2}), torque);
    for (const double time : {0.1, 1.0, -0.5})
        CHECK((momentum(driven.at(time)) - momentum(driven.at(0)) - time * torque).norm() < 1e-12 * torque.norm());
    const double h = 1e-3, time = 0.3;
    const auto before = driven.at(time - h), now = driven.at(time), after = driven.at(time + h);
    CHECK(((after.x - before.x) / (2 * h) - now.v).norm() < 1e-5 * now.v.norm());
    CHECK(((after.v - before.v) / (2 * h) - now.a).norm() < 1e-5 * now.a.norm());
}

TEST_CASE("changes of a rotation are its differences") {
    std::mt19937 engine(1);
    for (const double speed : {0.0, 1e-3, 2.0}) {
        const Nodes x = random_nodes(engine), v = speed * random_nodes(engine);
        const Nodes dx = random_nodes(engine), dv = random_nodes(engine);
        const Vector3d torque = speed * Vector3d(0.4, -0.7, 0.2), dtorque(0.3, 0.1, -0.5);
        for (const double time : {-0.2, 0.0, 0.3}) {
            const double h = 1e-4;
            const auto at = [&](double share) {
                return ObjectRotation(x + share * h * dx, v + share * h * dv, torque + share * h * dtorque).at(time);
            };
            const auto one = at(1), other = at(-1), two = at(2), far = at(-2);
            const auto slope = [&](const Nodes ObjectRotation::Motion::*part) -> Nodes {
                return (8 * (one.*part - other.*part) - (two.*part - far.*part)) / (12 * h);
            };
            const auto told = ObjectRotation(x, v, torque).change(time, dx, dv, dtorque);
            CHECK((told.x - slope(&ObjectRotation::Motion::x)).norm() < 1e-9 * (1 + told.x.norm()));
            CHECK((told.v - slope(&ObjectRotation::Motion::v)).norm() < 1e-9 * (1 + told.v.norm()));
            CHECK((told.a - slope(&ObjectRotation::Motion::a)).norm() < 1e-9 * (1 + told.a.norm()));
        }
    }
}
