// Reuse of a factor after a rotation of the body: a bar bent to an arc, and one rotated as a whole.
#include "simulation/solver/body_rotation.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <cmath>

#include "base/core/near.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/solver/test_arc.hpp"

using namespace pliant;
using namespace pliant::sim;
using linalg::Matrix3;
using testing::bent;

namespace {

/// 80 x 10 x 10 mm of two materials, clamped at x = 0.
Description bar(int order) {
    Description d;
    d.mesh = reference::kuhn_box({0.08, 0.01, 0.01}, order == 1 ? 24 : 12, order == 1 ? 3 : 2, order == 1 ? 3 : 2,
                                 [](Vec3 c) { return c.x < 0.04 ? 0 : 1; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"hard", material::neo_hookean(3e6, 0.45), 0}, {"soft", material::neo_hookean(1e6, 0.45), 0}};
    d.material_of_region = {0, 1};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    return d;
}

struct Bar {
    explicit Bar(int order) : model(Model::create(bar(order)).value()) {}
    Bar(const Bar&) = delete;
    Bar& operator=(const Bar&) = delete;

    Model model;
    Equilibrium system{model};
    FactoredLaplacian laplacian{system};
    Eigen::VectorXd rest = system.rest().x;
    BodyRotation turn{system, laplacian};
};

Eigen::VectorXd anything(Eigen::Index size, double seed) {
    return Eigen::VectorXd::NullaryExpr(size,
                                        [seed](Eigen::Index i) { return std::sin(seed * static_cast<double>(i)); });
}

/// The projected tangent at x, by Eigen.
struct Tangent {
    Eigen::SparseMatrix<double> matrix;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;

    Tangent(const Equilibrium& system, const Eigen::VectorXd& x) {
        const TangentLayout layout = system.lay_out_tangent();
        std::vector<double> values(layout.pattern.entries(), 0.0);
        State state = system.rest();
        state.x = x;
        system.add_tangent(state, system.controls(1), layout, values, true);
        std::vector<Eigen::Triplet<double>> triplets;
        const linalg::SymmetricPattern& p = layout.pattern;
        for (int j = 0; j < p.nodes; ++j) {
            for (int k = p.node_start[j]; k < p.node_start[j + 1]; ++k) {
                for (int e = 0; e < 9; ++e) {
                    const int row = 3 * p.node_row[k] + e % 3, column = 3 * j + e / 3;
                    if (row < column) continue;
                    triplets.emplace_back(row, column, values[9 * static_cast<std::size_t>(k) + e]);
                }
            }
        }
        matrix.resize(p.size(), p.size());
        matrix.setFromTriplets(triplets.begin(), triplets.end());
        factor.compute(matrix);
    }
    [[nodiscard]] double energy(const Eigen::VectorXd& u) const {
        return u.dot(matrix.selfadjointView<Eigen::Lower>() * u);
    }
};

}  // namespace

TEST_CASE("motions and forces rotate with a body rotated as a whole") {
    for (const int order : {1, 2}) {
        Bar body(order);
        const Eigen::VectorXd& rest = body.rest;
        BodyRotation& turn = body.turn;
        const Matrix3 Q = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
        Eigen::VectorXd now = rest;
        for (Eigen::Index i = 0; i < now.size(); i += 3) now.segment<3>(i) = Q * rest.segment<3>(i);
        turn.begin(rest);
        const Eigen::MatrixXd before = anything(body.system.restrict_to_free(rest).size(), 3.1);
        Eigen::MatrixXd motion = before, force = before;
        turn.push_forward_motions(motion);
        CHECK(motion == before);  // it has not turned yet
        turn.follow(now);
        turn.push_forward_motions(motion);
        turn.pull_back_forces(force);
        Eigen::VectorXd turned = before, turned_back = before;
        for (Eigen::Index i = 0; i < before.rows(); i += 3) {
            turned.segment<3>(i) = Q * before.col(0).segment<3>(i);
            turned_back.segment<3>(i) = Q.transpose() * before.col(0).segment<3>(i);
        }
        CHECK((motion - turned).norm() < 1e-5 * before.norm());
        CHECK((force - turned_back).norm() < 1e-5 * before.norm());
        Eigen::VectorXd step = motion, change = before;
        turn.pull_back_step(step, change);
        CHECK((step - before).norm() < 1e-5 * before.norm());
        CHECK((change - turned_back).norm() < 1e-5 * before.norm());
    }
}

TEST_CASE("an old stiffness rotated with a bent body replaces the new one; without rotation it does not") {
    for (const int order : {1, 2}) {
        Bar body(order);
        BodyRotation& turn = body.turn;
        const Eigen::VectorXd before = bent(body.rest, 0.2), now = bent(body.rest, 0.15);  // the end turns by 8 degrees
        const Tangent old(body.system, before), present(body.system, now);
        turn.begin(before);
        turn.follow(now);

        // A push at the end, and a force that is smooth nowhere.
        Eigen::MatrixXd forces(old.matrix.rows(), 2);
        forces.col(0).setZero();
        forces(forces.rows() - 1, 0) = 1;
        forces.col(1) = anything(forces.rows(), 7.7);
        Eigen::MatrixXd found = forces;
        turn.pull_back_forces(found);
        found = old.factor.solve(found).eval();
        turn.push_forward_motions(found);
        for (const Eigen::Index k : {0, 1}) {
            const Eigen::VectorXd exact = present.factor.solve(forces.col(k));
            const Eigen::VectorXd unturned = old.factor.solve(forces.col(k));
            const double whole = present.energy(exact);
            CHECK(present.energy(found.col(k) - exact) < 0.01 * whole);
            if (k == 0) CHECK(present.energy(unturned - exact) > 0.5 * whole);
        }

        // Forces transform with the transpose of motions: the inverse stays symmetric.
        Eigen::MatrixXd f = anything(forces.rows(), 1.3), u = anything(forces.rows(), 2.9);
        const Eigen::VectorXd f_now = f, u_before = u;
        turn.pull_back_forces(f);
        turn.push_forward_motions(u);
        CHECK(f.col(0).dot(u_before) == near(f_now.dot(u.col(0)), {.relative = 1e-4}));
    }
}

TEST_CASE("a Laplacian on several levels gives nearly the motions of its factor") {
    for (const int order : {1, 2}) {
        const Bar body(order);
        const FactoredLaplacian levels(body.system, 0);
        const Eigen::Index size = body.system.restrict_to_free(body.rest).size();
        Eigen::MatrixXd forces(size, 3);
        for (Eigen::Index k = 0; k < forces.cols(); ++k) forces.col(k) = anything(size, 0.3 + static_cast<double>(k));
        Eigen::MatrixXd expected = forces, found = forces;
        body.laplacian.solve(expected);
        levels.solve(found);
        CHECK(found != expected);
        CHECK((found - expected).norm() < 1e-4 * expected.norm());
        CHECK(levels.analysis()->pattern.node_row == body.laplacian.analysis()->pattern.node_row);
        CHECK(levels.work() == near(body.laplacian.work(), {.relative = 0.9}));
    }
}
