// The tangent of a bent body, solved by both methods.
#include "simulation/solver/tangent_inverse.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/linalg/cholesky.hpp"
#include "base/linalg/two_level.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/solver/corner_nesting.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/solver/test_arc.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Clamped at x = 0 and pushed sideways at the other end.
Description pushed(Vec3 size, int along, int across, int order, double force_N) {
    Description d;
    d.mesh = reference::kuhn_box(size, along, across, across, [&](Vec3 c) { return c.x < size.x / 2 ? 0 : 1; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"hard", material::neo_hookean(3e6, 0.45), 0}, {"soft", material::neo_hookean(1e6, 0.45), 0}};
    d.material_of_region = {0, 1};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    const auto tip = reference::nodes_where(d.mesh, [&](Vec3 p) { return p.x > size.x - 1e-9; });
    d.loads = {{"tip", tip, std::vector<double>(tip.size(), 1.0 / static_cast<double>(tip.size())), {0, 0, force_N}}};
    d.markers = {{"tip", reference::mean_of(tip)}};
    return d;
}

/// A pushed body bent to an arc: its tangent and out-of-balance force there.
struct Bent {
    Model model;
    Equilibrium system{model};
    TangentLayout layout = system.lay_out_tangent();
    std::vector<double> values = std::vector<double>(layout.pattern.entries(), 0.0);
    Eigen::VectorXd positions, out_of_balance;

    Bent(const Description& d, double radius_m, bool project) : model(Model::create(d).value()) {
        State state = system.rest();
        state.x = testing::bent(system.rest().x, radius_m);
        const Controls controls = system.controls(1);
        system.add_tangent(state, controls, layout, values, project);
        positions = system.restrict_to_free(state.x);
        out_of_balance = system.restrict_to_free(system.evaluate(state, controls).out_of_balance);
    }
    Bent(const Bent&) = delete;
    Bent& operator=(const Bent&) = delete;
};

}  // namespace

TEST_CASE("two levels and the factor give the same solutions for a bent body, linear and quadratic") {
    for (const int order : {1, 2}) {
        const Bent b(pushed({0.06, 0.01, 0.01}, order == 1 ? 24 : 12, order == 1 ? 4 : 2, order, 1), 0.05, true);
        Eigen::MatrixXd columns(b.positions.size(), 2);
        columns.col(0) = b.out_of_balance;
        columns.col(1) = b.positions.array().sin();

        Eigen::MatrixXd direct = columns, levels = columns;
        const auto factor = make_direct_inverse(linalg::analyse(b.layout.pattern), true);
        REQUIRE(factor->set(b.values, b.positions, TangentInverse::Effort::usual));
        REQUIRE(factor->solve(direct, 1e-3) == TangentInverse::Outcome::solved);
        const auto two = make_levels_inverse(b.layout.pattern, {});
        REQUIRE(two->set(b.values, b.positions, TangentInverse::Effort::usual));
        REQUIRE(two->solve(levels, 1e-3) == TangentInverse::Outcome::solved);
        for (const Eigen::Index k : {0, 1}) {
            const double energy = direct.col(k).dot(columns.col(k));
            CHECK(std::fabs(levels.col(k).dot(columns.col(k)) - energy) < 1e-3 * energy);
            CHECK((levels.col(k) - direct.col(k)).norm() < 1e-2 * direct.col(k).norm());
        }
    }
}

TEST_CASE("the corners of quadratic tets as second level give the factor's solutions, in few iterations") {
    const Bent b(pushed({0.06, 0.01, 0.01}, 18, 3, 2, 1), 0.05, true);
    Eigen::MatrixXd columns(b.positions.size(), 3);
    columns.col(0) = b.out_of_balance;
    columns.col(1) = b.positions.array().sin();
    columns.col(2) = b.positions.array().cos();
    Eigen::MatrixXd direct = columns;
    const auto factor = make_direct_inverse(linalg::analyse(b.layout.pattern), true);
    REQUIRE(factor->set(b.values, b.positions, TangentInverse::Effort::usual));
    REQUIRE(factor->solve(direct, 1e-3) == TangentInverse::Outcome::solved);
    struct Case {
        int most_factored, most_iterations;
    };
    for (const auto& [most_factored, most] : {Case{linalg::most_factored_corners, 24}, {0, 32}}) {
        CAPTURE(most_factored);
        Eigen::MatrixXd nested = columns;
        linalg::TwoLevel levels(b.layout.pattern, *nest_in_corners(b.model), most_factored);
        REQUIRE(levels.set(b.values, linalg::view(b.positions)));
        REQUIRE(levels.solve(linalg::view(nested), 3, 1e-3, most) == linalg::TwoLevel::Outcome::solved);
        CHECK(levels.iterations() <= most);
        for (const Eigen::Index k : {0, 1, 2}) {
            const double energy = direct.col(k).dot(columns.col(k));
            CHECK(std::fabs(nested.col(k).dot(columns.col(k)) - energy) < 1e-3 * energy);
            CHECK((nested.col(k) - direct.col(k)).norm() < 1e-2 * direct.col(k).norm());
        }
    }
}

TEST_CASE("levels on the corners follow a matrix that changes") {
    const Bent b(pushed({0.06, 0.01, 0.01}, 18, 3, 2, 1), 0.05, true);
    linalg::TwoLevel levels(b.layout.pattern, *nest_in_corners(b.model), 0);
    constexpr int most = 60;
    const auto solved = [&](const std::vector<double>& values) {
        Eigen::VectorXd x = b.out_of_balance;
        REQUIRE(levels.set(values, linalg::view(b.positions)));
        REQUIRE(levels.solve(linalg::view(x), 1, 1e-3, most) == linalg::TwoLevel::Outcome::solved);
        return x;
    };
    const Eigen::VectorXd soft = solved(b.values);
    const int usual = levels.iterations();
    CHECK((solved(b.values) - soft).norm() < 1e-2 * soft.norm());  // with the groups turned
    std::vector<double> stiffer = b.values;
    for (double& value : stiffer) value *= 30;
    const Eigen::VectorXd stiff = solved(stiffer);
    CHECK((30 * stiff - soft).norm() < 1e-2 * soft.norm());
    CHECK(levels.iterations() <= usual + 12);  // until the groups, which were turned, are made anew
    CHECK((solved(stiffer) - stiff).norm() < 1e-2 * stiff.norm());
    CHECK(levels.iterations() <= usual + 2);
}

TEST_CASE("a matrix in two parts is solved as in one") {
    const Bent b(pushed({0.06, 0.01, 0.01}, 18, 3, 2, 1), 0.05, true);
    std::vector<double> other = b.values, between = b.values;
    constexpr double share = 0.25;
    for (std::size_t k = 0; k < other.size(); ++k) {
        other[k] *= k % 9 % 4 == 0 ? 1.5 : 1;
        between[k] += share * (other[k] - b.values[k]);
    }
    const auto levels = make_levels_inverse(b.layout.pattern, nest_in_corners(b.model));
    REQUIRE(levels->keeps_matrix());
    Eigen::MatrixXd whole = b.out_of_balance, parts = whole;
    REQUIRE(levels->set(between, b.positions, TangentInverse::Effort::usual));
    REQUIRE(levels->solve(whole, 1e-3) == TangentInverse::Outcome::solved);
    levels->take(b.values, b.positions);
    levels->move_towards(other, share);
    REQUIRE(levels->prepare(linalg::Reuse::turned));
    REQUIRE(levels->solve(parts, 1e-3) == TangentInverse::Outcome::solved);
    CHECK((parts - whole).norm() < 1e-5 * whole.norm());
}

TEST_CASE("a tangent with negative directions is refused or found by factor and two levels") {
    const Bent b(pushed({0.06, 0.01, 0.01}, 24, 4, 1, 1), 0.02, false);
    const auto factor = make_direct_inverse(linalg::analyse(b.layout.pattern), true);
    REQUIRE_FALSE(factor->set(b.values, b.positions, TangentInverse::Effort::all));
    const auto two = make_levels_inverse(b.layout.pattern, {});
    Eigen::MatrixXd column = b.out_of_balance;
    if (two->set(b.values, b.positions, TangentInverse::Effort::usual))
        CHECK(two->solve(column, 1e-3) == TangentInverse::Outcome::indefinite);
}

TEST_CASE("a column beyond its buckling load is solved where constraints hold it upright") {
    // Clamped at one end and shortened by 0.8 %: it buckles from 0.6 % on (Euler), the linear tets on its corners
    // later.
    Description d = pushed({0.06, 0.01, 0.01}, 6, 2, 2, 0);
    Bent b(d, 1e9, false);
    State state = b.system.rest();
    constexpr double shortening = 0.014;
    for (Eigen::Index i = 0; i < state.x.size(); ++i) state.x[i] *= i % 3 == 0 ? 1 - shortening : 1 + 0.45 * shortening;
    const Controls controls = b.system.controls(1);
    std::fill(b.values.begin(), b.values.end(), 0.0);
    b.system.add_tangent(state, controls, b.layout, b.values, false);
    const Eigen::Index size = b.positions.size();
    Eigen::MatrixXd sideways = Eigen::MatrixXd::Zero(size, 2);  // the tip's mean motion
    for (Eigen::Index i = 0; i < size; i += 3) {
        if (b.positions[i] > 0.06 - 1e-5) sideways(i + 1, 0) = sideways(i + 2, 1) = 1;
    }
    const Eigen::VectorXd force = b.positions.array().sin();
    const Eigen::Vector2d wanted(1e-4, -2e-4);

    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(size + 2, size + 2);
    Eigen::VectorXd column(size);
    for (Eigen::Index k = 0; k < size; ++k) {
        const Eigen::VectorXd unit = Eigen::VectorXd::Unit(size, k);
        column.setZero();
        linalg::add_product(b.layout.pattern, b.values, linalg::view(unit), 1, linalg::view(column));
        whole.col(k).head(size) = column;
    }
    const auto two = make_levels_inverse(b.layout.pattern, nest_in_corners(b.model));
    REQUIRE(two->set(b.values, b.positions, TangentInverse::Effort::usual));
    Eigen::MatrixXd free = force;
    CHECK(two->solve(free, 1e-3) == TangentInverse::Outcome::indefinite);
    Eigen::VectorXd held = force, multipliers;
    REQUIRE(two->takes_constraints());
    REQUIRE(two->solve_constrained(held, {sideways, wanted}, multipliers, 1e-3) == TangentInverse::Outcome::solved);
    CHECK((sideways.transpose() * held - wanted).norm() < 1e-9 * wanted.norm());

    whole.topRightCorner(size, 2) = sideways;
    whole.bottomLeftCorner(2, size) = sideways.transpose();
    Eigen::VectorXd right(size + 2);
    right << force, wanted;
    const Eigen::VectorXd exact = whole.partialPivLu().solve(right);
    CHECK((held - exact.head(size)).norm() < 1e-2 * exact.head(size).norm());
    CHECK((multipliers - exact.tail(2)).norm() < 1e-2 * exact.tail(2).norm());
}

TEST_CASE("a bulky body is solved on two levels, and converges to equilibrium") {
    Description d = pushed({0.02, 0.02, 0.02}, 18, 18, 1, 20);
    const auto model = Model::create(d);
    REQUIRE(model);
    const Equilibrium system(*model);
    const TangentLayout layout = system.lay_out_tangent();
    linalg::SymmetricPattern scalar = layout.pattern;
    scalar.block = 1;
    REQUIRE(levels_are_quicker(layout.pattern, false, linalg::Cholesky(scalar).factor_work()));
    Progress silent;
    const Trajectory result = run(*model, {.steps = 1, .tolerance = 1e-6}, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    CHECK(result.steps.back().residual < 1e-6);
    CHECK(result.iterations.size() < 12);

    // With a third of the nodes per side the factorisation is used; the coarse mesh makes it stiffer.
    const auto coarse = Model::create(pushed({0.02, 0.02, 0.02}, 6, 6, 1, 20));
    const Trajectory other = run(*coarse, {.steps = 1, .tolerance = 1e-6}, silent);
    REQUIRE_MESSAGE(other.converged, other.message);
    const double fine_m = result.steps.back().markers[0].position_m.z - 0.01;
    const double coarse_m = other.steps.back().markers[0].position_m.z - 0.01;
    CHECK(coarse_m < fine_m);
    CHECK(coarse_m > 0.8 * fine_m);
}
