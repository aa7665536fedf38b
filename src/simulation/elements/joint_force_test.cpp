// Joint forces against differences of their energy, and against equilibrium.
#include "simulation/elements/joint_force.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "base/core/near.hpp"
#include "base/linalg/vectors.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// The four points of one thing that four nodes carry, numbered from `first`, at a tetrahedron's corners; any weights
/// that are affine will do.
std::array<Attachment, 4> carried(int first) {
    std::array<Attachment, 4> points;
    const std::array<std::array<double, 4>, 4> weights = {
        {{0.1, 0.2, 0.3, 0.4}, {0.5, 0.1, 0.2, 0.2}, {0.1, 0.6, 0.2, 0.1}, {-0.2, 0.3, 0.8, 0.1}}};
    for (std::size_t p = 0; p < 4; ++p)
        points[p] = {{first, first + 1, first + 2, first + 3}, {weights[p].begin(), weights[p].end()}, {}};
    return points;
}

Joint some_joint(Joint::Kind kind, bool to_world) {
    Joint joint;
    joint.kind = kind;
    joint.first = carried(0);
    joint.second = carried(4);
    const std::array<Vec3, 4> places = {{{0.3, 0.1, 0.2}, {1.2, 0.1, 0.3}, {0.2, 1.1, 0}, {0.1, 0.2, 1}}};
    for (std::size_t p = 0; to_world && p < 4; ++p) joint.second[p] = {{}, {}, places[p]};
    joint.arm_m = 0.7;
    joint.stiffness_N_m = 30;
    joint.law = {2, 0.1, 0.5, -0.2, 0.15, JointLaw::Drive::place, ramp(0, 1)};
    return joint;
}

Eigen::VectorXd some_place(unsigned seed) {
    std::mt19937 engine(seed);
    Eigen::VectorXd x(24);
    for (double& entry : x) entry = static_cast<double>(engine()) / 4294967296.0;
    return x;
}

Eigen::VectorXd gradient(const JointForce& joint, const Eigen::VectorXd& x, const JointDrive& drive) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(x.size());
    joint.add_gradient(linalg::view(x), drive, linalg::view(sum));
    return sum;
}

constexpr std::array kinds = {Joint::Kind::ball, Joint::Kind::hinge, Joint::Kind::glue, Joint::Kind::slider};

}  // namespace

TEST_CASE("joint forces are the gradient of the energy, and the Hessian is that of the forces") {
    const JointDrive drive{0.3, 0.05, 0.01};
    std::vector<int> index(8);
    for (int k = 0; k < 8; ++k) index[static_cast<std::size_t>(k)] = k;
    for (const Joint::Kind kind : kinds) {
        for (const bool to_world : {false, true}) {
            CAPTURE(static_cast<int>(kind));
            CAPTURE(to_world);
            const JointForce joint(some_joint(kind, to_world));
            const Eigen::VectorXd x = some_place(3), v = some_place(4) - some_place(5);
            constexpr double h = 1e-6;
            const Eigen::VectorXd ahead = x + h * v, behind = x - h * v;
            const double slope =
                (joint.energy(linalg::view(ahead), drive) - joint.energy(linalg::view(behind), drive)) / (2 * h);
            CHECK(gradient(joint, x, drive).dot(v) == near(slope, {.relative = 1e-7}));
            linalg::Lists cliques;
            joint.append_clique(index, cliques);
            const linalg::SymmetricPattern pattern = linalg::make_pattern(8, 3, cliques);
            std::vector<double> values(pattern.entries(), 0.0);
            joint.add_hessian(linalg::view(x), drive, index, pattern, values, false);
            Eigen::VectorXd product = Eigen::VectorXd::Zero(24);
            linalg::add_product(pattern, values, linalg::view(v), 1, linalg::view(product));
            const Eigen::VectorXd change = (gradient(joint, ahead, drive) - gradient(joint, behind, drive)) / (2 * h);
            CHECK((product - change).norm() < 1e-6 * change.norm());
            if (!joint.has_coordinate()) continue;
            Eigen::VectorXd along = Eigen::VectorXd::Zero(24);
            joint.add_coordinate_gradient(linalg::view(x), 1, linalg::view(along));
            const double rate =
                (joint.coordinate(linalg::view(ahead), 0) - joint.coordinate(linalg::view(behind), 0)) / (2 * h);
            CHECK(along.dot(v) == near(rate, {.relative = 1e-7}));
        }
    }
}

TEST_CASE("reported force and torque act on the second body, and their work is the energy lost") {
    const JointDrive drive{0.3, 0.05, 0};
    for (const Joint::Kind kind : kinds) {
        CAPTURE(static_cast<int>(kind));
        const JointForce joint(some_joint(kind, false));
        const Eigen::VectorXd x = some_place(7);
        const JointForce::Load load = joint.load(linalg::view(x), drive);
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        const Attachment at = carried(4)[0];
        for (std::size_t k = 0; k < 4; ++k) place += at.weights[k] * x.segment<3>(3 * at.nodes[k]);
        // The second thing moves by a, and rotates by b about the joint's point.
        const Eigen::Vector3d a(0.3, -0.2, 0.5), b(-0.4, 0.6, 0.1);
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(24);
        for (int node = 4; node < 8; ++node) motion.segment<3>(3 * node) = a + b.cross(x.segment<3>(3 * node) - place);
        CHECK(load.force.dot(a) + load.torque.dot(b) ==
              near(-gradient(joint, x, drive).dot(motion), {.relative = 1e-12}));
    }
}

TEST_CASE("a rigid motion of both ends causes no joint force") {
    for (const Joint::Kind kind : kinds) {
        Joint joint = some_joint(kind, false);
        joint.law = {};
        for (std::size_t p = 0; p < 4; ++p) joint.second[p].weights = joint.first[p].weights;
        Eigen::VectorXd x = some_place(9);
        x.tail<12>() = x.head<12>();
        CHECK(gradient(JointForce(joint), x, {}).norm() < 1e-12);
    }
}

namespace {

/// The joint with other arms: column k of `turn` has the parts of the given ones in arm k.
Joint with_arms(const Joint& joint, const Eigen::Matrix3d& turn) {
    Joint turned = joint;
    for (auto* end : {&turned.first, &turned.second}) {
        const std::array<Attachment, 4> points = *end;
        for (int arm = 0; arm < 3; ++arm) {
            for (std::size_t k = 0; k < 4; ++k) {
                double& weight = (*end)[static_cast<std::size_t>(arm) + 1].weights[k];
                weight = points[0].weights[k];
                for (int by = 0; by < 3; ++by)
                    weight +=
                        turn(by, arm) * (points[static_cast<std::size_t>(by) + 1].weights[k] - points[0].weights[k]);
            }
        }
    }
    return turned;
}

}  // namespace

TEST_CASE("a joint does not depend on the directions that its arms are given in") {
    // On nodes that deform, as those of soft material. A hinge and a slider keep their axis.
    const Eigen::Matrix3d about_axis = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX()).matrix();
    const Eigen::Matrix3d any = Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).matrix();
    for (const Joint::Kind kind : kinds) {
        CAPTURE(static_cast<int>(kind));
        const Joint joint = some_joint(kind, false);
        const JointForce force(joint);
        const JointForce other(with_arms(joint, force.has_coordinate() ? about_axis : any));
        const JointDrive drive{0.3, 0.1, 0.05};
        for (unsigned seed = 1; seed < 6; ++seed) {
            const Eigen::VectorXd x = some_place(seed);
            CHECK(other.coordinate(linalg::view(x), 0.1) ==
                  near(force.coordinate(linalg::view(x), 0.1), {.absolute = 1e-12}));
            CHECK((gradient(other, x, drive) - gradient(force, x, drive)).norm() < 1e-10);
        }
    }
}

TEST_CASE("the joint angle counts whole turns from the start of the step") {
    Joint joint = some_joint(Joint::Kind::hinge, true);
    joint.law = {};
    // The first thing has its own axes at the origin; the second, which is fixed, is rotated by q about the first axis.
    for (std::size_t p = 0; p < 4; ++p)
        joint.first[p] = {{0, 1, 2, 3}, {p == 0 ? 1.0 : 0, p == 1 ? 1.0 : 0, p == 2 ? 1.0 : 0, p == 3 ? 1.0 : 0}, {}};
    Eigen::VectorXd x = Eigen::VectorXd::Zero(24);
    for (int k = 0; k < 3; ++k) x[3 * (k + 1) + k] = joint.arm_m;
    for (const double q : {0.5, 3.0, 4.0, 12.0, -9.0}) {
        const auto turned = [&](double a) { return Vec3{0, joint.arm_m * std::cos(a), joint.arm_m * std::sin(a)}; };
        const std::array<Vec3, 4> places = {{{}, {joint.arm_m, 0, 0}, turned(q), turned(q + std::numbers::pi / 2)}};
        for (std::size_t p = 0; p < 4; ++p) joint.second[p] = {{}, {}, places[p]};
        CHECK(JointForce(joint).coordinate(linalg::view(x), q + 0.2) == near(q, {.absolute = 1e-12}));
    }
}
