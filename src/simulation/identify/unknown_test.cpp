// Names, bounds and coordinates of unknowns.
#include "simulation/identify/unknown.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "simulation/identify/test_bars.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using namespace pliant::sim::identify::testing;

namespace {

const std::string many_parameters = R"(
    cable = [{ name = "flexor", points = [[0, 5, 9], [60, 5, 9]], target.length_ratio = 0.9 },
             { name = "rope", points = [[0, 5, 1], [60, 5, 1]], friction = 0.2, target.tension = "2 N" }]
    spring = [{ name = "band", points = [[0, 1, 9], [60, 1, 9]], stiffness = "10 N/m", free_length = "40 mm" },
              { name = "bow", points = [[0, 1, 9], [60, 1, 9], [60, 9, 3]], stiffness = "10 N/m" }]
    chamber = [{ name = "air", region = "air", target.volume_change = "1 ml" }]
    load = [{ name = "gust", box = [[0, 0, 10], [60, 10, 10]], pressure = "-1 kPa" },
            { name = "weight", box = [[60, 0, 0], [60, 10, 10]], force = ["0 N", "0 N", "-1 N"] }]
    obstacle = [{ name = "table", plane = { point = [0, 0, -1], normal = [0, 0, 1] }, friction = 0.3 }]
    contact = { stiffness = "50 kPa", friction = 0.1 }
    program = { duration = "100 ms", time_step = "10 ms", mass_damping = 2, stiffness_damping = 0.01 }
)";

std::string unknown_problem(const Bar& bar, const std::string& text) {
    const auto found = find_unknown(bar.robot(), text);
    return found ? "" : found.error().message;
}

}  // namespace

TEST_CASE("every number that a robot offers as unknown can be set with --set") {
    const Bar bar(many_parameters);
    const auto all = possible_unknowns(bar.robot());
    CHECK(all.size() == 27);
    for (const Unknown& unknown : all) {
        CAPTURE(unknown.key);
        const double value = unknown.value_at(unknown.coordinate(unknown.value > 0 ? unknown.value : 0.1) + 0.01);
        const auto read = robot::parse_robot(bar.text, "bar.toml", {unknown.assignment(value)});
        REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
        const auto again = possible_unknowns(*read);
        const auto found = std::ranges::find(again, unknown.key, &Unknown::key);
        REQUIRE(found != again.end());
        CHECK(found->value == near(value, {.relative = 1e-14}));
    }
}

TEST_CASE("of the bulk modulus and Poisson's ratio that one is offered which the file uses") {
    const std::string two_moduli = "youngs_modulus = \"0.7 MPa\", poisson_ratio = 0.42";
    const std::string constants = "law = \"yeoh\", c10 = \"0.2 MPa\", ";
    for (const std::string given : {"bulk_modulus = \"2 MPa\"", "poisson_ratio = 0.42"}) {
        Bar bar(many_parameters);
        bar.text.replace(bar.text.find(two_moduli), two_moduli.size(), constants + given);
        const auto robot = robot::parse_robot(bar.text, "bar.toml");
        REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
        std::vector<std::string> offered;
        for (const Unknown& unknown : possible_unknowns(*robot)) {
            if (!unknown.key.ends_with("soft.bulk_modulus") && !unknown.key.ends_with("soft.poisson_ratio")) continue;
            offered.push_back(unknown.key);
            CHECK(robot::parse_robot(bar.text, "bar.toml", {unknown.assignment(unknown.value)}));
        }
        CHECK(offered == std::vector<std::string>{"material.soft." + given.substr(0, given.find(' '))});
    }
}

TEST_CASE("the free length of a spring begins at its path as drawn where the file gives none") {
    const Bar bar(many_parameters);
    CHECK(find_unknown(bar.robot(), "spring.bow.free_length")->value == near(0.07, {.relative = 1e-12}));
    CHECK(find_unknown(bar.robot(), "spring.band.free_length")->value == near(0.04, {.relative = 1e-12}));
}

TEST_CASE("coordinates of unknowns and their derivatives") {
    for (const Scale scale : {Scale::linear, Scale::log, Scale::from_zero, Scale::poisson}) {
        const Unknown unknown{"k", "", 0.3, 0, 1, scale, 0.2};
        const double u = unknown.coordinate(0.3), h = 1e-5;
        CHECK(unknown.value_at(u) == near(0.3, {.relative = 1e-14}));
        CHECK(unknown.rate(0.3) ==
              near((unknown.value_at(u + h) - unknown.value_at(u - h)) / (2 * h), {.relative = 1e-9}));
    }
}

TEST_CASE("bounds are read, with units where the key has one") {
    const Bar bar(many_parameters);
    const auto E = *find_unknown(bar.robot(), "material.soft.youngs_modulus=0.5 MPa..900kPa");
    CHECK(E.low == near(0.5e6, {.relative = 1e-12}));
    CHECK(E.high == near(0.9e6, {.relative = 1e-12}));
    CHECK(E.value == near(0.7e6, {.relative = 1e-12}));
    CHECK(E.shown(E.low) == "500 kPa");
    const auto outside = *find_unknown(bar.robot(), "material.soft.youngs_modulus=1 MPa..4 MPa");
    CHECK(outside.value == near(2e6, {.relative = 1e-12}));
    const auto offset = *find_unknown(bar.robot(), "cable.flexor.target.offset=-1mm..1mm");
    CHECK(offset.low == near(-1e-3, {.relative = 1e-12}));
    const auto friction = *find_unknown(bar.robot(), "cable.flexor.friction=0.05..0.2");
    CHECK(friction.value == near(0.1, {.relative = 1e-12}));
}

TEST_CASE("a number that may be 0 is searched down to 0, in steps that do not shrink there") {
    const Bar bar(many_parameters);
    const auto damping = *find_unknown(bar.robot(), "program.mass_damping=0..10");
    CHECK(damping.low == 0);
    CHECK(damping.value == 2);
    CHECK(damping.coordinate(0) == 0);
    CHECK(damping.rate(0) == 2);
    CHECK(damping.value_at(0) == near(0, {.absolute = 1e-8}));
    CHECK(damping.value_at(0) > 0);
    CHECK(find_unknown(bar.robot(), "cable.rope.friction")->low == 0);
    const auto unset = *find_unknown(bar.robot(), "cable.flexor.friction=0..0.5");
    CHECK(unset.low == 0);
    CHECK(unset.value > 0.05);
    CHECK(unset.value < 0.25);
    CHECK(unknown_problem(bar, "program.mass_damping=-1..10") ==
          "program.mass_damping: -1 is not possible; it is zero or above");
}

TEST_CASE("an invalid unknown is reported in one line") {
    const Bar bar(many_parameters);
    CHECK(unknown_problem(bar, "material.sof.youngs_modulus") ==
          "material.sof.youngs_modulus: the robot has no such parameter to find; did you mean "
          "\"material.soft.youngs_modulus\"?");
    CHECK(unknown_problem(bar, "mesh.size").starts_with("mesh.size: the robot has no such parameter to find"));
    CHECK(unknown_problem(bar, "").starts_with("--unknown \"\": the robot has no such parameter to find; "));
    CHECK(unknown_problem(bar, "=1..2").starts_with("--unknown \"=1..2\": the robot has no such parameter"));
    CHECK(unknown_problem(bar, "material.soft.youngs_modulus=1 MPa") ==
          "material.soft.youngs_modulus: \"1 MPa\" is not a range; write LOW..HIGH, as in \"1 kPa..2 kPa\"");
    CHECK(unknown_problem(bar, "material.soft.youngs_modulus=1..2")
              .starts_with("material.soft.youngs_modulus: \"1\" has no unit"));
    CHECK(unknown_problem(bar, "material.soft.youngs_modulus=2 MPa..1 MPa") ==
          "material.soft.youngs_modulus: the range from 2 MPa to 1 MPa is empty; LOW must be below HIGH");
    CHECK(unknown_problem(bar, "material.soft.youngs_modulus=-2 MPa..1 MPa") ==
          "material.soft.youngs_modulus: -2 MPa is not possible; it is above zero");
    CHECK(unknown_problem(bar, "material.soft.poisson_ratio=0.4..0.5") ==
          "material.soft.poisson_ratio: Poisson's ratio is above -1 and below 0.5");
    CHECK(unknown_problem(bar, "cable.rope.friction=a..b") == "cable.rope.friction: \"a\" is not a number");
    CHECK(unknown_problem(bar, "cable.flexor.friction").starts_with("cable.flexor.friction: is 0 in the robot file"));
}
