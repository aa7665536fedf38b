// A linearisation against differences of the equations, for everything that acts on a robot.
#include "simulation/linearisation/linearisation.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "base/core/near.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/test_differences.hpp"
#include "simulation/linearisation/test_robots.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

void check(Linearisation at, std::string_view what) {
    CAPTURE(what);
    const Measured e = errors_of(at, edge);
    MESSAGE(what, ": products ", e.product, ", transposed ", e.transpose, ", solutions ", e.solution, ", inputs ",
            e.input);
    CHECK(e.product < 1e-8);
    CHECK(e.transpose < 1e-13);
    CHECK(e.solution < 1e-12);
    CHECK(e.input < 1e-8);
}

}  // namespace

TEST_CASE("products and solutions for every law, both orders, with a cable and a chamber") {
    for (const int order : {1, 2}) {
        for (const auto& [name, law] : laws) {
            Description d = block(order, law);
            d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
            d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.1};
            const Case c(std::move(d));
            check(c.at(disturbed(c.system, 0.5, 2e3), c.system.controls(1)), fmt::format("{}, order {}", name, order));
        }
    }
}

TEST_CASE("solutions for a cable by length, slack, by tension, with friction") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    {
        const Case c(d);
        const Linearisation at = c.at(disturbed(c.system, 0, 0), c.system.controls(1));
        CHECK(at.is_slack(0));
        check(at, "slack");
    }
    d.cables[0].target = {CableTarget::Kind::tension_N, 2};
    {
        const Case c(d);
        const Linearisation at = c.at(disturbed(c.system, 0, 0), c.system.controls(1));
        CHECK(at.solved().empty());
        check(at, "by tension");
    }
    for (const auto& target :
         {CableTarget{CableTarget::Kind::length_ratio, 0.9}, CableTarget{CableTarget::Kind::tension_N, 2}}) {
        d.cables[0].target = target;
        d.cables[0].friction = 0.4;
        const Case c(d);
        const State state = disturbed(c.system, 1, 0);
        Controls controls = c.system.controls(1);
        const std::vector<Drive> wanted = controls.drives, before = c.system.controls(0).drives;
        c.system.freeze_cable_friction(state.x, wanted, before, controls);
        REQUIRE(controls.shares[0].back() < 1);
        check(c.at(state, controls), "with friction");
    }
}

TEST_CASE("a linearisation whose slack cables are tightened has the same bits as one in which they are taut") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    for (const double height : {0.1, 0.5}) {
        d.cables.push_back(
            cable_through(d.mesh, {{0.2 * edge, 0.3 * edge, height * edge}, {2.8 * edge, 0.4 * edge, height * edge}},
                          {CableTarget::Kind::length_ratio, 0.95}));
    }
    const Case c(std::move(d));
    for (const double residual : {best_residual, gradient_residual}) {
        CAPTURE(residual);
        State state = c.system.rest();
        state.multiplier << 0.5, 0, 0;
        const auto made = [&] {
            auto at = Linearisation::create(c.system, state, c.system.controls(1), {}, residual);
            REQUIRE(at);
            return std::move(*at);
        };
        Linearisation tightened = made();
        REQUIRE(tightened.is_slack(1));
        Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(tightened.size(), -1, 2);
        const auto before = tightened.solve(b);
        Linearisation copy = tightened;
        tightened.tighten({1});  // shares its solver with the copy
        CHECK_FALSE(tightened.is_slack(1));
        CHECK(tightened.is_slack(2));
        CHECK(*copy.solve(b) == *before);
        Linearisation alone = made();
        REQUIRE(alone.solve(b));
        alone.tighten({1});  // takes its solver along
        state.multiplier[1] = std::numeric_limits<double>::min();
        Linearisation taut = made();
        CHECK(*taut.solve(b) != *before);
        for (Linearisation* at : {&tightened, &alone}) {
            CHECK(at->multiply(b) == taut.multiply(b));
            CHECK(*at->solve(b) == *taut.solve(b));
            CHECK(*at->solve_transposed(b) == *taut.solve_transposed(b));
        }
    }
}

TEST_CASE("a taut cable that is taken for slack keeps its tension's stiffness, and nothing holds its length") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    d.cables.push_back(cable_through(d.mesh,
                                     {{0.2 * edge, 0.3 * edge, 0.1 * edge}, {2.8 * edge, 0.4 * edge, 0.1 * edge}},
                                     {CableTarget::Kind::length_ratio, 0.95}));
    const Case c(std::move(d));
    State state = c.system.rest();
    state.multiplier << 0.5, 0.3;
    auto made = Linearisation::create(c.system, state, c.system.controls(1));
    REQUIRE(made);
    Linearisation& at = *made;
    const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(at.size(), -1, 2);
    const Eigen::VectorXd taut = at.multiply(v);
    at.slacken({0});
    CHECK(at.is_slack(0));
    CHECK_FALSE(at.is_slack(1));
    const Eigen::VectorXd loose = at.multiply(v);
    const Eigen::Index first = at.size() - 2;
    CHECK(loose.head(first) == taut.head(first));
    CHECK(loose[first] == v[first]);
    CHECK(loose[first + 1] == taut[first + 1]);
    for (const bool before : {false, true}) {  // with a solver of its own, and with that of the taut one
        Linearisation other = *Linearisation::create(c.system, state, c.system.controls(1));
        if (before) REQUIRE(other.solve(v));
        other.slacken({0});
        const auto solved = other.solve(v);
        REQUIRE(solved);
        CHECK((other.multiply(*solved) - v).norm() < 1e-10 * v.norm());
        // A change of the tension alone, as the cable lets go.
        const Eigen::VectorXd tension = Eigen::VectorXd::Unit(at.size(), first);
        const auto released = other.solve(tension);
        REQUIRE(released);
        CHECK((*released)[first] == near(1, {.relative = 1e-12}));
        CHECK((other.multiply(*released) - tension).norm() < 1e-10);
    }
}

TEST_CASE("the derivative by the length of a cable with friction is by its true length") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    d.cables[0].friction = 0.4;
    const Case c(d);
    const State state = disturbed(c.system, 1, 0);
    const std::vector<Drive> before = c.system.controls(0).drives;
    const auto weighted = [&](double change) {
        Controls controls = c.system.controls(1);
        std::vector<Drive> wanted = controls.drives;
        wanted[0].value =
            c.system.actuators()[0].measure({state.x.data(), static_cast<std::size_t>(state.x.size())}) + change;
        c.system.freeze_cable_friction(state.x, wanted, before, controls);
        return controls;
    };
    Linearisation at = c.at(state, weighted(0));
    const Parameter length = inputs(at)[0];
    CHECK(length.value ==
          near(weighted(0).drives[0].value / at.equations(state, weighted(0)).size(), {.relative = 1e9}));
    const double h = 1e-6;
    const double by_hand = (weighted(h).drives[0].value - weighted(-h).drives[0].value) / (2 * h);
    CHECK(-derivative(at, length).equations.tail(1)[0] == near(by_hand, {.relative = 1e-9}));
    CHECK(by_hand < 0.99);
}

TEST_CASE("solutions for a chamber by volume, by pressure, with sealed gas") {
    for (const int order : {1, 2}) {
        Description d = block(order, material::neo_hookean(1e6, 0.4));
        for (const auto& [kind, value] :
             {std::pair{ChamberTarget::Kind::volume_ratio, 1.2}, std::pair{ChamberTarget::Kind::pressure_Pa, 3e3},
              std::pair{ChamberTarget::Kind::gas_ratio, 1.2}}) {
            d.chambers[0].target = {kind, value};
            const Case c(d);
            check(c.at(disturbed(c.system, 0, 3e3), c.system.controls(1)),
                  fmt::format("chamber kind {}, order {}", static_cast<int>(kind), order));
        }
    }
}

TEST_CASE("solutions for pressure on a patch with a free rim, and with a held rim") {
    for (const int order : {1, 2}) {
        Description d = plain(order);
        d.pressures = {patch(d.mesh, -1)};
        d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
        const Case c(d);
        REQUIRE(c.system.has_skew());
        check(c.at(disturbed(c.system, 0.5, 0), c.system.controls(1)), fmt::format("free rim, order {}", order));
        // Held all around, but the supports move.
        const auto rim = reference::nodes_where(d.mesh, [](Vec3 p) {
            const auto outer = [](double v, double end) { return v < 1e-9 || v > end - 1e-9; };
            return p.z > edge - 1e-9 && p.x > 1e-9 && (outer(p.x, 3 * edge) || outer(p.y, edge));
        });
        d.supports.push_back({"rim", rim, {0.1 * edge, 0, 0.2 * edge}});
        d.supports.back().turn = {0.3, {1, 2, 3}, {edge, 0, 0}};
        const Case held(d);
        REQUIRE_FALSE(held.system.has_skew());
        State state = disturbed(held.system, 0.5, 0);
        const Controls controls = held.system.controls(0.1);
        held.system.place_supports(controls, state.x);
        check(held.at(state, controls), fmt::format("held rim, order {}", order));
    }
}

TEST_CASE("solutions for rollers, moving ones and ones shared by two supports") {
    Description d = plain();
    d.supports.push_back(
        {"roller", end_of(d.mesh), {0.02 * edge, 0, 0.01 * edge}, ramp(0, 1), {0.1, {1, 1, 0}, {}}, {{0, 1, 1}}});
    d.supports.push_back({"symmetry",
                          reference::nodes_where(d.mesh, [](Vec3 p) { return p.y < 1e-9 && p.x > 1e-9; }),
                          {},
                          ramp(0, 1),
                          {},
                          {{1, 0, 0}}});
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    d.pressures = {patch(d.mesh, -1)};
    const Case c(std::move(d));
    REQUIRE_FALSE(c.system.rollers().empty());
    State state = disturbed(c.system, 0.5, 0);
    const Controls controls = c.system.controls(1);
    c.system.place_supports(controls, state.x);
    check(c.at(state, controls), "rollers");
}

TEST_CASE("solutions for springs, plates, loads and gravity") {
    Description d = plain();
    const Cable path = flexor(d.mesh, {});
    d.springs = {{"coil", path.points, 300, 0.8 * 3 * edge},
                 {"pressed", path.points, 30, 5 * edge},
                 {"band", path.points, 100, 0.5 * edge, true},
                 {"loose", path.points, 1000, 9 * edge, true}};
    d.plates = {{"plate", end_of(d.mesh)}};
    const std::vector<int> end = end_of(d.mesh);
    d.loads = {{"hook", end, std::vector<double>(end.size(), 1.0 / static_cast<double>(end.size())), {0.1, 0, -0.3}}};
    d.gravity_m_s2 = {0, 0, -9.81};
    const Case c(std::move(d));
    check(c.at(disturbed(c.system, 0, 0), c.system.controls(0.7)), "springs, plates, loads");
}

TEST_CASE("solutions for gap elements, whose force is not the gradient of the length") {
    for (const int order : {1, 2}) {
        const auto region = [](Vec3 c) { return c.z > edge / 2 && c.x > edge && c.x < 2 * edge ? 1 : 0; };
        Description d;
        d.mesh = reference::kuhn_box({3 * edge, edge, edge}, 6, 2, 4, region);
        d.mesh.region_names = {"solid", "gap"};
        if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
        d.materials = {{"A", material::neo_hookean(1e6, 0.4), 1000}, {"gap", gap_law(1e6), 0}};
        d.material_of_region = {0, 1};
        d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
        d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
        d.growths = {{1, {1, 0, 0}, 0, 1e5, edge, {1.5 * edge, 0.5 * edge, 0.9 * edge}}};
        const Case c(std::move(d));
        REQUIRE(c.system.actuators()[0].gaps() != nullptr);
        check(c.at(disturbed(c.system, -0.4, 0), c.system.controls(1)), fmt::format("gap elements, order {}", order));
    }
}

TEST_CASE("solutions for a step in time") {
    Description d = block(1, material::neo_hookean(1e6, 0.4));
    d.supports.push_back({"grip", end_of(d.mesh), {0.1 * edge, 0, 0.2 * edge}});
    const Case c(std::move(d));
    State state = disturbed(c.system, 0, 2e3);
    const State before = disturbed(c.system, 0, 0, 4), rest = c.system.rest();
    const TangentLayout layout = c.system.lay_out_tangent({}, TangentNodes::all);
    auto stiffness = std::make_shared<StiffnessMatrix>();
    stiffness->pattern = std::make_shared<const linalg::SymmetricPattern>(layout.pattern);
    stiffness->values.assign(layout.pattern.entries(), 0.0);
    c.model.elements().add_tangent({rest.x.data(), static_cast<std::size_t>(rest.x.size())}, layout.element_sums,
                                   stiffness->values, true);
    const History history{before.x, before.x - rest.x, rest.x, before.x, 0};
    Controls controls = c.system.controls(1);
    c.system.place_supports(controls, state.x);
    controls.inertia = std::make_shared<const Inertia>(c.model.elements(), c.model.free_index(), history, 1e-3,
                                                       Damping{2, 1e-3}, stiffness);
    check(c.at(state, controls), "inertia");
}

TEST_CASE("solutions for contact with a moving obstacle and self-contact, with lagged friction") {
    Case c(touching_blocks());
    const auto [state, controls, settled] = pressed(c.system);
    REQUIRE(controls.friction->pairs().size() > 5);
    const contact::Forces forces = c.system.contact_forces(state, controls);
    REQUIRE(forces.self_N > 0);
    REQUIRE(norm(forces.on_robot_N[0]) > 0);
    check(c.at(state, controls), "contact");
}

TEST_CASE("solutions exist where the equilibrium is unstable") {
    // Past the largest pressure of a chamber the tangent is indefinite; and a column that is pressed far beyond
    // buckling.
    Description d = block(1, material::neo_hookean(1e6, 0.4));
    d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, 1e3};
    const Case c(std::move(d));
    for (const double shortened : {0.7, 0.5}) {
        CAPTURE(shortened);
        State state = c.system.rest();
        for (Eigen::Index i = 0; i < state.x.size(); i += 3) state.x[i] *= shortened;
        Linearisation at = c.at(state, c.system.controls(1));
        Noise noise(7);
        const Eigen::VectorXd b = at.multiply(noise.vector(at.size()));
        const auto x = at.solve(b);
        REQUIRE_MESSAGE(x, x.error().message);
        CHECK((b - at.multiply(*x)).norm() < 1e-12 * b.norm());
        // Indefinite: some motion has a negative stiffness.
        Eigen::VectorXd v = noise.vector(at.size());
        for (int k = 0; k < 30; ++k) v = at.solve(v.normalized()).value();
        CHECK(v.dot(at.multiply(v)) < 0);
    }
}

TEST_CASE("redundant cables share their load; conflicting targets are an error") {
    Description d = plain();
    d.cables = {flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9}),
                flexor(d.mesh, {CableTarget::Kind::length_ratio, 0.9})};
    d.cables[0].name = "left";
    d.cables[1].name = "right";
    d.gravity_m_s2 = {0, 0, -9.81};
    const Case c(d);
    d.cables.pop_back();
    const Case single(std::move(d));
    Linearisation at = c.at(disturbed(c.system, 0.5, 0), c.system.controls(1));
    Linearisation one = single.at(disturbed(single.system, 1, 0), single.system.controls(1));
    const auto by_gravity = [](Linearisation& of) { return of.response(derivative(of, inputs(of).back())).value(); };
    const Change both = by_gravity(at), alone = by_gravity(one);
    CHECK((both.positions - alone.positions).norm() < 1e-9 * alone.positions.norm());
    CHECK(both.multipliers[0] == near(0.5 * alone.multipliers[0], {.relative = 1e-8}));
    CHECK(both.multipliers[1] == near(0.5 * alone.multipliers[0], {.relative = 1e-8}));
    const auto differ = at.response(derivative(at, inputs(at)[0]));
    REQUIRE_FALSE(differ);
    CHECK(differ.error().message ==
          "cable \"left\", cable \"right\" have the same effect but different targets, which cannot be met at once");
}

TEST_CASE("a cable between held points has no effect") {
    Description d = plain();
    const std::vector<int> clamp = d.supports[0].nodes;
    d.cables = {{"idle", {{{clamp[0]}, {1.0}, {}}, {{clamp[1]}, {1.0}, {}}}, {CableTarget::Kind::length_ratio, 1}}};
    d.gravity_m_s2 = {0, 0, -9.81};
    const Case c(std::move(d));
    Linearisation at = c.at(disturbed(c.system, 0.5, 0), c.system.controls(1));
    CHECK(at.response(derivative(at, inputs(at).back())));
    const auto length = at.response(derivative(at, inputs(at)[0]));
    REQUIRE_FALSE(length);
    CHECK(length.error().message == "cable \"idle\" moves nothing and cannot be given another length or volume");
}

TEST_CASE("a singular tangent is an error") {
    // Held along x alone at one end: nothing keeps the block from sliding along y and z and from rolling.
    Description d = plain();
    d.supports[0].directions = {{1, 0, 0}};
    const Case c(std::move(d));
    Linearisation at = c.at(c.system.rest(), c.system.controls(0));
    Noise noise(7);
    const auto x = at.solve(noise.vector(at.size()));
    REQUIRE_FALSE(x);
    CHECK(x.error().message.starts_with("the tangent of this state is singular: "));
}

TEST_CASE("a physically impossible state is an error") {
    const Case c(plain());
    State state = c.system.rest();
    state.x *= -1;
    const auto at = Linearisation::create(c.system, state, c.system.controls(0));
    REQUIRE_FALSE(at);
    CHECK(at.error().message == "a state that turns a tetrahedron inside out has no linearisation");
}
