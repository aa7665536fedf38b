// Gradients of a state and of a program through the public interface.
#include "pliant/gradient.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/core/near.hpp"
#include "library/simulation/test_bar.hpp"
#include "pliant/program.hpp"

using namespace pliant;
using test::bar;

namespace {

const char* const four_steps = "program = { steps = 4, tolerance = 1e-10 }\n";

std::size_t index_with(const std::vector<Parameter>& all, const std::string& name) {
    for (std::size_t k = 0; k < all.size(); ++k)
        if (all[k].name.find(name) != std::string::npos) return k;
    FAIL("there is no parameter " << name);
    return 0;
}

/// Height of the tip and tension at the end, both squared.
Objective at_end() {
    Objective objective;
    objective.measures = {{Measure::Of::marker, "tip", {0, 0, 1}}, {Measure::Of::tension, "flexor", {}}};
    objective.judge = [](int step, std::span<const double> at) {
        return step < 4 ? Judgement{} : Judgement{1e4 * at[0] * at[0] + at[1] * at[1], {2e4 * at[0], 2 * at[1]}};
    };
    return objective;
}

double value_with(const std::string& change) {
    const Robot given = bar(four_steps);
    return gradient(Model(change.empty() ? given : Robot::parse(test::bar_text(four_steps), {}, {change})), at_end())
        .value;
}

}  // namespace

TEST_CASE("a gradient names its stage from the first call of the watch, and a measure of no kind is refused") {
    const Model model(bar(four_steps));
    double last = 0;
    const Watch watch = [&](std::string_view stage, double share) {
        CHECK(stage == "gradient");
        last = share;
        return true;
    };
    (void)gradient(model, at_end(), {}, watch);
    CHECK(last == 1);
    Objective wrong = at_end();
    wrong.measures[0].of = static_cast<Measure::Of>(99);
    CHECK_THROWS_WITH_AS((void)gradient(model, wrong), "there is no measure of kind 99; take one of Measure::Of",
                         Failure);
}

TEST_CASE("the gradient of a program agrees with finite differences") {
    const ProgramGradient of = gradient(Model(bar(four_steps)), at_end(), {.rest_positions = true, .tets = true});
    REQUIRE(of.values.size() == 4);
    CHECK(of.value == near(value_with(""), {.relative = 1e-12}));
    const std::size_t E = index_with(of.parameters, "youngs_modulus");
    const double by_E =
        (value_with("material.soft.youngs_modulus=1.001MPa") - value_with("material.soft.youngs_modulus=0.999MPa")) /
        2e3;
    CHECK(of.by_parameters[E] == near(by_E, {.relative = 1e-5}));
    double sum = 0;
    for (const TetGradient& one : of.by_tets)
        if (one.name == "youngs_modulus")
            for (const double by_tet : one.values) sum += by_tet;
    CHECK(sum == near(of.by_parameters[E], {.relative = 1e-9}));
    REQUIRE(of.instants.size() >= 4);
    const std::size_t length = index_with(of.inputs, "length");
    const double by_length =
        (value_with("cable.flexor.target.shortening=4.002mm") - value_with("cable.flexor.target.shortening=3.998mm")) /
        -4e-6;
    CHECK(of.instants.back().by_inputs[length] == near(by_length, {.relative = 1e-5}));
    CHECK(of.by_rest_positions.size() == Model(bar(four_steps)).node_count());
}

TEST_CASE("a measure at a state has the observed value, and a gradient that agrees with finite differences") {
    const Model model(bar(four_steps));
    Stepper stepper(model, {.tolerance = 1e-11});
    State state = stepper.rest();
    Inputs inputs = stepper.program(1);
    REQUIRE(stepper.step(state, inputs).arrived);
    Linearisation at(state);
    const Measure tension{Measure::Of::tension, "flexor", {}};
    CHECK(at.value(tension) == near(stepper.observe(state).cables[0].tension_N, {.relative = 1e-12}));
    const std::vector<double> by = at.gradient(tension).inputs;
    const std::size_t length = index_with(at.inputs(), "length");
    const auto with = [&](double change) {
        State moved = state;
        Inputs other = inputs;
        other.cables[0].value += change;
        REQUIRE(stepper.step(moved, other).arrived);
        return stepper.observe(moved).cables[0].tension_N;
    };
    CHECK(by[length] == near((with(1e-6) - with(-1e-6)) / 2e-6, {.relative = 1e-6}));
    CHECK_THROWS_WITH_AS((void)at.value({Measure::Of::tension, "flexr", {}}),
                         "there is no cable \"flexr\"; did you mean \"flexor\"?", Failure);
    CHECK_THROWS_WITH_AS((void)at.value({Measure::Of::spring_force, "s", {}}),
                         "there is no spring \"s\": the robot has none", Failure);
    CHECK_THROWS_AS((void)at.value({Measure::Of::marker, "tip", {std::nan(""), 0, 0}}), Failure);
    CHECK_THROWS_WITH_AS((void)at.value({Measure::Of::marker, "tip", {}}),
                         "a measure of marker \"tip\" needs a direction, such as (0, 0, 1)", Failure);
    CHECK_THROWS_WITH_AS((void)at.gradient(Measure{Measure::Of::reaction, "clamp", {}}),
                         "a measure of support \"clamp\" needs a direction, such as (0, 0, 1)", Failure);
}

namespace {

/// Guide points of a cable that shortens by a share and of two springs, mm; the third starts in space.
using Places = std::vector<Point>;
const Places guide_places = {{1.3, 4.2, 8.1},  {30.7, 5.4, 8.3}, {58.2, 4.6, 8.4}, {31.7, 2.1, 1.4},
                             {56.4, 3.7, 1.2}, {80, 2, -30},     {50.6, 7.3, 1.7}};

Model guided(const Places& at) {
    const auto point = [&](std::size_t k) {
        std::string text = "[";
        for (const double c : at[k]) text += std::to_string(c) + ", ";
        return text + "]";
    };
    return Model(Robot::parse(R"(
        name = "guided"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.4 }
        mesh = { order = 1, size = "5 mm" }
        body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [60, 10, 10]] } }]
        fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
        marker = [{ name = "tip", point = [60, 5, 5] }]
        program = { steps = 4, tolerance = 1e-10 }
        cable = [{ name = "flexor", target.length_ratio = 0.94, points = [)" +
                              point(0) + ", " + point(1) + ", " + point(2) + R"(] }]
        spring = [{ name = "free", stiffness = "40 N/m", eyelet_radius = "6 mm", points = [)" +
                              point(3) + ", " + point(4) + R"(] },
                  { name = "held", stiffness = "20 N/m", free_length = "25 mm", anchor = "first", points = [)" +
                              point(5) + ", " + point(6) + "] }]"));
}

}  // namespace

TEST_CASE("derivatives by guide points of cables and springs agree with finite differences") {
    Objective objective = at_end();
    objective.measures.push_back({Measure::Of::spring_force, "free", {}});
    objective.measures.push_back({Measure::Of::length, "flexor", {}});
    objective.judge = [](int step, std::span<const double> at) {
        return Judgement{step * (1e2 * at[0] + at[1] + 7 * at[2] + 90 * at[3]),
                         {1e2 * step, 1.0 * step, 7.0 * step, 90.0 * step}};
    };
    const ProgramGradient of = gradient(guided(guide_places), objective, {.guide_points = true});
    REQUIRE(of.by_guide_points.size() == guide_places.size());
    CHECK(of.guide_points[1].name == "cable \"flexor\": point 2");
    CHECK(of.guide_points[5].name == "spring \"held\": point 1");
    double size = 0;
    for (const Point& by : of.by_guide_points)
        for (const double slope : by) size = std::max(size, std::fabs(slope));
    for (std::size_t k = 0; k < guide_places.size(); ++k) {
        CAPTURE(of.guide_points[k].name);
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(of.guide_points[k].place[c] == near(1e-3 * guide_places[k][c], {.absolute = 1e-12}));
            const auto with = [&](double change_mm) {
                Places moved = guide_places;
                moved[k][c] += change_mm;
                return gradient(guided(moved), objective).value;
            };
            const double by_others = (with(0.01) - with(-0.01)) / 2e-5;
            CHECK(of.by_guide_points[k][c] == near(by_others, {.relative = 1e-4, .absolute = 1e-5 * size}));
        }
    }
    CHECK(gradient(guided(guide_places), objective).by_guide_points.empty());
}

TEST_CASE("guide points at a state: cable length held in m, or as a share of its rest length") {
    const auto state_of = [](const Model& model, double length) {
        Stepper stepper(model, {.tolerance = 1e-11});
        State state = stepper.rest();
        Inputs inputs = stepper.program(1);
        if (length > 0) inputs.cables[0].value = length;
        REQUIRE(stepper.step(state, inputs).arrived);
        return state;
    };
    const State state = state_of(guided(guide_places), 0);
    Linearisation at(state);
    REQUIRE(at.guide_points().size() == guide_places.size());
    const Measure tension{Measure::Of::tension, "flexor", {}};
    Quantity as_such;
    as_such.by_tensions = {1};
    const auto by_length_as_such = at.gradient(as_such, {.guide_points = true}).guide_points;
    const auto by_share = at.gradient(tension, {.guide_points = true}).guide_points;
    CHECK(at.gradient(tension).guide_points.empty());
    for (const std::size_t k : {1, 4, 5}) {
        const auto with = [&](double change_mm, double length) {
            Places moved = guide_places;
            moved[k][2] += change_mm;
            return Linearisation(state_of(guided(moved), length)).value(tension);
        };
        const double length = state.inputs().cables[0].value;
        CHECK(by_length_as_such[k][2] == near((with(0.01, length) - with(-0.01, length)) / 2e-5, {.relative = 1e-4}));
        CHECK(by_share[k][2] == near((with(0.01, 0) - with(-0.01, 0)) / 2e-5, {.relative = 1e-4}));
    }
}

TEST_CASE("an objective without slopes has a gradient of zeros with the full sizes") {
    const Model model(bar(std::string("parameters = { height = 5 }\n") + four_steps));
    Objective objective = at_end();
    objective.judge = [](int, std::span<const double>) { return Judgement{1, {0, 0}}; };
    const ProgramGradient of =
        gradient(model, objective, {.rest_positions = true, .guide_points = true, .tets = true, .numbers = {"height"}});
    CHECK(of.value == 4);
    REQUIRE(!of.parameters.empty());
    CHECK(of.by_parameters == std::vector<double>(of.parameters.size(), 0.0));
    CHECK(of.by_numbers == std::vector<double>{0});
    CHECK(of.by_rest_positions == std::vector<Point>(model.node_count(), Point{}));
    CHECK(of.by_guide_points == std::vector<Point>(3, Point{}));
    std::vector<std::string> names;
    for (const TetGradient& one : of.by_tets) {
        names.push_back(one.name);
        CHECK(one.values == std::vector<double>(model.tet_count(), 0.0));
    }
    const ProgramGradient other = gradient(model, at_end(), {.tets = true});
    REQUIRE(names.size() == other.by_tets.size());
    for (std::size_t k = 0; k < names.size(); ++k) CHECK(names[k] == other.by_tets[k].name);
}

TEST_CASE("an exception of the objective is passed on, and gradients of the wrong size are refused") {
    const Model model(bar(four_steps));
    Objective objective = at_end();
    objective.judge = [](int, std::span<const double>) -> Judgement { throw std::out_of_range("mine"); };
    CHECK_THROWS_WITH_AS((void)gradient(model, objective), "mine", std::out_of_range);
    objective.judge = [](int, std::span<const double>) { return Judgement{1, {1}}; };
    CHECK_THROWS_WITH_AS((void)gradient(model, objective), "the objective gives 1 slopes of 2 measures", Failure);
    objective.judge = [](int, std::span<const double>) { return Judgement{1, {0, std::nan("")}}; };
    CHECK_THROWS_WITH_AS((void)gradient(model, objective), "the objective gives a number that is not finite", Failure);
    objective.judge = nullptr;
    CHECK_THROWS_AS((void)gradient(model, objective), Failure);
    CHECK_THROWS_AS((void)gradient(model, at_end(), {}, [](std::string_view, double) { return false; }), Failure);
}

namespace {

/// A bar whose height, guide line, material, pull and marker follow parameters.
const char* const drawn = R"(
    name = "drawn"
    length_unit = "mm"
    parameters = { height = 10, poisson = 0.4, ratio = 0.93, twice = "= 2 * height" }
    material.soft = { youngs_modulus = "1 MPa", poisson_ratio = "= poisson" }
    mesh = { order = 1, size = "5 mm" }
    body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [60, 10, "= height"]] } }]
    fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, "= height"]] }]
    marker = [{ name = "tip", point = [60, 5, "= height / 2"] }]
    program = { steps = 4, tolerance = 1e-10 }
    cable = [{ name = "flexor", points = [[0, 5, "= height - 1"], [30, 5, "= height - 1"], [60, 5, "= height - 1"]], )"
                          R"(target.length_ratio = "= ratio" }]
)";

}  // namespace

TEST_CASE("parameters of the drawing have derivatives through everything that follows from them") {
    const std::string text = drawn;
    const auto with = [&](const std::string& name, double value) {
        return Model(Robot::parse(text, {}, {"parameters." + name + "=" + std::to_string(value)}));
    };
    const ProgramGradient of =
        gradient(Model(Robot::parse(text)), at_end(), {.numbers = {"height", "poisson", "ratio"}});
    REQUIRE(of.by_numbers.size() == 3);
    // Changes of material and pull keep the mesh.
    const auto by = [&](const std::string& name, double value, double h) {
        return (gradient(with(name, value + h), at_end()).value - gradient(with(name, value - h), at_end()).value) /
               (2 * h);
    };
    CHECK(of.by_numbers[1] == near(by("poisson", 0.4, 1e-4), {.relative = 1e-5}));
    CHECK(of.by_numbers[2] == near(by("ratio", 0.93, 1e-4), {.relative = 1e-5}));
    CHECK_THROWS_WITH_AS((void)gradient(Model(Robot::parse(text)), at_end(), {.numbers = {"hight"}}),
                         "[parameters] has no number \"hight\"; did you mean \"height\"?", Failure);
    CHECK_THROWS_AS((void)gradient(Model(Robot::parse(text)), at_end(), {.numbers = {"twice"}}), Failure);
    CHECK_THROWS_WITH_AS((void)gradient(Model(bar(four_steps)), at_end(), {.numbers = {"height"}}),
                         "the robot file has no [parameters] that are numbers", Failure);
}

TEST_CASE("an exception of the Watch reaches the caller, also while the robot is meshed for derivatives by numbers") {
    const Model model(Robot::parse(drawn));
    const Watch thrower = [](std::string_view, double) -> bool { throw std::out_of_range("of the caller"); };
    CHECK_THROWS_WITH_AS((void)gradient(model, at_end(), {.numbers = {"height"}}, thrower), "of the caller",
                         std::out_of_range);
}

TEST_CASE("the derivative of the tension by a bar's height agrees with bars of other heights") {
    Objective tension;
    tension.measures = {{Measure::Of::tension, "flexor", {}}};
    tension.judge = [](int step, std::span<const double> at) { return step < 4 ? Judgement{} : Judgement{at[0], {1}}; };
    const auto of = [&](double height, const GradientOptions& options) {
        return gradient(Model(Robot::parse(drawn, {},
                                           {"parameters.height=" + std::to_string(height), "mesh.order=2",
                                            "mesh.size=3 mm", "program.tolerance=1e-7"})),
                        tension, options);
    };
    // Each variant is meshed anew, which alone changes the tension by a percent or so.
    const double by_others = (of(11.5, {}).value - of(8.5, {}).value) / 3;
    CHECK(of(10, {.numbers = {"height"}}).by_numbers[0] == near(by_others, {.relative = 0.05}));
}
