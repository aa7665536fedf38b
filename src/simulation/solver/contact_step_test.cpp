#include "simulation/solver/contact_step.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "base/core/near.hpp"
#include "simulation/run/test_problems.hpp"
#include "simulation/solver/step_solver.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

constexpr double cube_side = 0.01, gap = 1e-4, slip = 1e-5, coefficient = 0.3;

struct Cube {
    double lift_N, push_N = 0, slip_m = slip;
    int across = 3;  ///< elements
};

/// A cube of rubber on a clamp below a plane with friction. At the time 0.5 its top is lifted against the plane, at 1
/// pushed sideways as well.
Model lifted_cube(const Cube& cube) {
    Description d;
    d.mesh =
        reference::kuhn_box({cube_side, cube_side, cube_side}, cube.across, cube.across, 3, [](Vec3) { return 0; });
    d.materials = {{"rubber", material::neo_hookean(1e5, 0.3), 1000}};
    d.material_of_region = {0};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.z < 1e-9; }), {}}};
    const std::vector<int> top = reference::nodes_where(d.mesh, [](Vec3 p) { return p.z > cube_side - 1e-9; });
    const std::vector<double> shares(top.size(), 1.0 / static_cast<double>(top.size()));
    d.loads = {{"lift", top, shares, {0, 0, cube.lift_N}, Curve{{0, 0.5, 1}, {0, 1, 1}}},
               {"push", top, shares, {cube.push_N, 0, 0}, Curve{{0, 0.5, 1}, {0, 0, 1}}}};
    d.contact = ContactRules{
        contact::robot_surface(d.mesh), {.distance_m = gap, .stiffness_Pa = 1e4, .slip_m = cube.slip_m}, {}};
    d.contact->obstacles.push_back(
        {{"plane", contact::HalfSpace{{0, 0, cube_side + gap}, {0, 0, -1}}, coefficient}, {}, Curve{{0, 1}, {0, 1}}});
    auto model = Model::create(std::move(d));
    REQUIRE(model);
    return std::move(*model);
}

/// Newton's method without the small problem of contact.
class Plain final : public Curvature {
public:
    Plain(const Equilibrium& system, const FactoredLaplacian& laplacian) : newton_(make_newton(system, laplacian)) {}
    [[nodiscard]] Solver solver() const override { return newton_->solver(); }
    [[nodiscard]] int default_iteration_limit() const override { return newton_->default_iteration_limit(); }
    [[nodiscard]] double smallest_share() const override { return newton_->smallest_share(); }
    [[nodiscard]] bool refresh(const State& state, const Controls& controls, TangentChoice choice,
                               Errors errors) override {
        return newton_->refresh(state, controls, choice, errors);
    }
    void solve(Eigen::MatrixXd& columns) override { newton_->solve(columns); }
    [[nodiscard]] Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) const override {
        return newton_->retract(x, motion);
    }
    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override { newton_->learn(step, change); }
    void update_convergence(double before, double after) override { newton_->update_convergence(before, after); }

private:
    std::unique_ptr<Curvature> newton_;
};

/// The cube on its way: lifted, then with friction pushed.
struct Pushed {
    explicit Pushed(const Model& cube) : model(cube), system(cube), laplacian(system), lifted(system.rest()) {
        const auto newton = make_newton(system, laplacian);
        const Controls start = system.controls(0.5);
        REQUIRE(solve_step(system, *newton, start, {.tolerance = 1e-8}, lifted, Progress()).converged);
        controls = system.controls(1);
        controls.friction = system.freeze_friction(lifted, lifted, start, start);
    }
    const Model& model;
    Equilibrium system;
    FactoredLaplacian laplacian;
    State lifted;
    Controls controls;
};

}  // namespace

TEST_CASE("the nodes that touch come to rest where compliance, contact and friction balance") {
    const Model cube = lifted_cube({.lift_N = 2});
    const Pushed at(cube);
    const ContactStep contact(at.system, at.lifted, at.controls, 0.5);
    REQUIRE(contact.nodes().size() == 16);
    constexpr double compliance = 1e-3;  // m/N
    const Eigen::MatrixXd S = compliance * Eigen::MatrixXd::Identity(contact.size(), contact.size());
    for (const double aside : {5e-6, 5e-4}) {  // a part of the slip, and many times that
        CAPTURE(aside);
        Eigen::VectorXd without(contact.size());
        for (Eigen::Index k = 0; k < contact.size(); k += 3) without.segment<3>(k) << aside, 0, 3 * gap;
        const auto forces = contact.solve(S, without);
        REQUIRE(forces);
        const std::vector<int> rows = contact.rows();
        const Eigen::VectorXd pressed = (*forces)(rows);
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(forces->size());
        motion(rows) = without - compliance * pressed;
        Eigen::VectorXd full = at.lifted.x;
        at.system.add_free(motion, 1, full);
        const std::vector<double> x = at.system.with_obstacles(full, at.controls.obstacles);
        const contact::Contact& all = *cube.contact(false);
        CHECK(all.smallest_distance(all.find(x), x) > -gap);  // measured from the plane as drawn
        const Eigen::VectorXd there = at.system.contact_gradient(all.find(x), x, at.controls);
        CHECK((there - *forces).norm() < 1e-3 * forces->norm());
        double along = 0, limit = 0;
        for (const contact::FrozenPair& pair : at.controls.friction->pairs()) limit += pair.limit_N;
        for (Eigen::Index k = 0; k < contact.size(); k += 3) along += pressed[k];
        CHECK(along <= (1 + 1e-9) * limit);
        if (aside > slip) CHECK(along == near(limit, {.relative = 1e-3}));
    }
}

TEST_CASE("nothing that is near is left out, and where something is met unseen there is no solution") {
    const Model cube = lifted_cube({.lift_N = 2});
    const Pushed at(cube);
    const State rest = at.system.rest();
    const Controls start = at.system.controls(0);
    CHECK(ContactStep(at.system, rest, start, 0.5).nodes().empty());
    CHECK(ContactStep(at.system, rest, start, 1).nodes().size() == 16);
}

TEST_CASE("a body that begins to slip takes a few iterations, and arrives where it would without") {
    const Model cube = lifted_cube({.lift_N = 2, .push_N = 1.5, .slip_m = 1e-6, .across = 5});
    const Pushed at(cube);
    const StepSettings settings{.tolerance = 1e-8};
    Plain plain(at.system, at.laplacian);
    State slow = at.lifted, quick = at.lifted;
    const StepOutcome without = solve_step(at.system, plain, at.controls, settings, slow, Progress());
    const auto newton = make_newton(at.system, at.laplacian);
    const StepOutcome with = solve_step(at.system, *newton, at.controls, settings, quick, Progress());
    REQUIRE(without.converged);
    REQUIRE(with.converged);
    MESSAGE(without.iterations, " iterations without the small problem, ", with.iterations, " with it");
    CHECK(4 * with.iterations <= 3 * without.iterations);
    CHECK((quick.x - slow.x).norm() < 1e-5 * (slow.x - at.lifted.x).norm());
    CHECK((slow.x - at.lifted.x).lpNorm<Eigen::Infinity>() > 10 * slip);
}
