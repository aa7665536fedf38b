// Derivatives of states, compared with steps that were solved again.
#include "pliant/linearisation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "base/core/near.hpp"
#include "library/simulation/test_bar.hpp"

using namespace pliant;
using test::bar;

namespace {

struct Pulled {
    Model model;
    Stepper stepper;
    State state;
    explicit Pulled(const Robot& robot, double shortening_m = 0.004)
        : model(robot), stepper(model, {.tolerance = 1e-12}), state(stepper.rest()) {
        Inputs inputs = state.inputs();
        inputs.cables[0].value -= shortening_m;
        REQUIRE(stepper.step(state, inputs).arrived);
    }
    [[nodiscard]] double height_m() const { return stepper.observe(state).markers[0].position_m[2]; }
    [[nodiscard]] double tension_N() const { return stepper.observe(state).cables[0].tension_N; }
};

std::size_t index_of(const std::vector<Parameter>& all, const std::string& name) {
    const auto found = std::ranges::find(all, name, &Parameter::name);
    REQUIRE_MESSAGE(found != all.end(), name);
    return static_cast<std::size_t>(found - all.begin());
}

Robot soft_bar(const std::string& modulus) {
    return Robot::parse(R"(
        name = "bar"
        length_unit = "mm"
        material.soft = { youngs_modulus = ")" +
                        modulus + R"(", poisson_ratio = 0.45 }
        mesh = { order = 1, size = "5 mm" }
        body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [60, 10, 10]] } }]
        fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
        marker = [{ name = "tip", point = [60, 5, 5] }]
        cable = [{ name = "flexor", points = [[0, 5, 9], [30, 5, 9], [60, 5, 9]], target.shortening = "4 mm" }]
    )");
}

}  // namespace

TEST_CASE("products and solutions agree with their transposes and with each other") {
    const Pulled bent{bar()};
    Linearisation at(bent.state);
    std::vector<double> v(at.size()), w(at.size());
    for (std::size_t k = 0; k < v.size(); ++k) {
        v[k] = std::sin(1.0 + static_cast<double>(k));
        w[k] = std::cos(2.0 + 3 * static_cast<double>(k));
    }
    const auto dot = [](const std::vector<double>& a, const std::vector<double>& b) {
        double sum = 0;
        for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
        return sum;
    };
    CHECK(dot(w, at.multiply(v)) == near(dot(at.multiply_transposed(w), v), {.relative = 1e-10}));
    const std::vector<double> again = at.solve(at.multiply(v)), transposed = at.solve_transposed(w);
    for (std::size_t k = 0; k < v.size(); k += 17) CHECK(again[k] == near(v[k], {.relative = 1e-7, .absolute = 1e-9}));
    CHECK(dot(transposed, at.multiply(v)) == near(dot(w, v), {.relative = 1e-8}));
    CHECK_THROWS_WITH_AS((void)at.solve(std::vector<double>(3)), doctest::Contains("the vector has 3 entries"),
                         Failure);
}

TEST_CASE("the gradient of a tip by cable length, modulus and rest shape agrees with finite differences") {
    const Pulled bent{bar()};
    Linearisation at(bent.state);
    const Linearisation::Gradient gradient = at.gradient(at.marker_coordinate(0, {0, 0, 1}));
    const std::size_t length = index_of(at.inputs(), "cable \"flexor\": length");
    const double h = 1e-6;
    const double difference = (Pulled(bar(), 0.004 - h).height_m() - Pulled(bar(), 0.004 + h).height_m()) / (2 * h);
    CHECK(gradient.inputs[length] == near(difference, {.relative = 1e-6}));
    CHECK(at.response_to_input(length).positions.size() == bent.model.node_count());

    // With a prescribed length the shape does not depend on the modulus; the tension does.
    const std::size_t modulus = index_of(at.parameters(), "material \"soft\": youngs_modulus");
    CHECK(gradient.parameters[modulus] == near(0, {.absolute = 1e-12}));
    Quantity tension;
    tension.by_tensions = {1};
    const double by_modulus = at.gradient(tension).parameters[modulus];
    const double tensions = Pulled(soft_bar("1.001 MPa")).tension_N() - Pulled(soft_bar("0.999 MPa")).tension_N();
    CHECK(by_modulus == near(tensions / 2000, {.relative = 1e-6}));
    CHECK(at.response_to_parameter(modulus).tensions_N[0] == near(by_modulus, {.relative = 1e-8}));

    // Moving the whole robot, with its clamp and its cable, moves its tip by the same amount.
    double moved = 0;
    REQUIRE(gradient.rest_positions.size() == bent.model.node_count());
    for (const Point& p : gradient.rest_positions) moved += p[2];
    CHECK(moved == near(1, {.relative = 1e-8}));
}

TEST_CASE("the inputs begin with one for each cable, then one for each chamber") {
    const Model model(Robot::parse(R"(
        name = "both"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
        mesh = { order = 1, size = "5 mm" }
        body = [{ name = "bar", material = "soft", geometry = { difference = [
            { box = [[0, 0, 0], [30, 10, 10]] }, { box = [[5, 3, 3], [25, 7, 7]] }] } }]
        fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
        chamber = [{ name = "air", inside = [15, 5, 5], target.volume_ratio = 1.1 }]
        cable = [{ name = "left", points = [[0, 5, 9], [30, 5, 9]], target.shortening = "1 mm" },
                 { name = "right", points = [[0, 5, 1], [30, 5, 1]], target.tension = "1 N" }]
    )"));
    const Linearisation at(Stepper(model).rest());
    REQUIRE(at.inputs().size() >= 3);
    CHECK(at.inputs()[0].name == "cable \"left\": length");
    CHECK(at.inputs()[1].name.starts_with("cable \"right\": "));
    CHECK(at.inputs()[2].name.starts_with("chamber \"air\": "));
}

TEST_CASE("wrong requests are refused with the reason") {
    const Pulled bent{bar()};
    Linearisation at(bent.state);
    CHECK_THROWS_WITH_AS((void)at.response_to_input(99), doctest::Contains("there is no input 99"), Failure);
    CHECK_THROWS_WITH_AS((void)at.marker_coordinate(1, {1, 0, 0}), "there is no marker 1; there are 1", Failure);
    Quantity wrong;
    wrong.by_pressures = {1, 2};
    CHECK_THROWS_WITH_AS((void)at.gradient(wrong), "by_pressures has 2 entries; it takes 0", Failure);
    std::vector<double> b(at.size());
    b[3] = NAN;
    CHECK_THROWS_WITH_AS((void)at.solve(b), "the vector has a number that is not finite", Failure);
    Quantity quantity;
    quantity.by_tensions = {INFINITY};
    CHECK_THROWS_WITH_AS((void)at.gradient(quantity), "by_tensions has a number that is not finite", Failure);
    CHECK_THROWS_AS((void)at.marker_coordinate(0, {0, NAN, 0}), Failure);
}

TEST_CASE("contact forces on the nodes add up to the force of the obstacle") {
    const Model model(
        bar("contact = { stiffness = \"0.2 MPa\", distance = \"0.5 mm\" }\n"
            "obstacle = [{ name = \"ceiling\", plane = { point = [60, 5, 16], normal = [0, 0, -1] } }]\n"));
    Stepper stepper(model);
    State state = stepper.rest();
    Inputs inputs = state.inputs();
    inputs.cables[0].value -= 0.004;
    REQUIRE(stepper.step(state, inputs).arrived);
    const Observation seen = stepper.observe(state);
    REQUIRE(seen.contacts.size() == 1);
    CHECK(seen.contacts[0].force_N[2] < -0.01);
    Point sum{};
    for (const Point& f : stepper.contact_forces(state))
        for (std::size_t k = 0; k < 3; ++k) sum[k] += f[k];
    for (std::size_t k = 0; k < 3; ++k)
        CHECK(sum[k] == near(seen.contacts[0].force_N[k], {.relative = 1e-9, .absolute = 1e-9}));
    for (const Point& f : stepper.contact_forces(stepper.rest())) CHECK(f == Point{0, 0, 0});
}
