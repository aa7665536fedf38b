// Two things whose names would give a table two columns of one name are refused by both names.
#include <doctest/doctest.h>

#include <string>

#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::problem;

namespace {

const std::string cable_bar = R"(name = "bar"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
[[body]]
name = "bar"
material = "rubber"
geometry = { box = [[0, 0, 0], [30, 10, 10]] }
[mesh]
size = "10 mm"
order = 1
[[fixed]]
name = "base"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
[[cable]]
name = "flexor"
points = [[0, 5, 8], [30, 5, 8]]
target = { tension = "1 N" }
)";

std::string sensor(const std::string& name, const std::string& keys) {
    return cable_bar + "[[sensor]]\nname = \"" + name + "\"\n" + keys;
}
std::string clash(const std::string& thing, const std::string& column, const std::string& other) {
    return "bar.toml:19: " + thing + ": has the column \"" + column + "\" in the tables of results, and so has " +
           other + "; give one of the two another name";
}

}  // namespace

TEST_CASE("a sensor, a spring or an obstacle whose column another thing has is refused, by both names") {
    const std::string cable = "cable \"flexor\"", strain = "kind = \"strain\"\npoints = [[1, 5, 5], [29, 5, 5]]\n";
    CHECK(problem(sensor("flexor", "kind = \"tension\"\ncable = \"flexor\"\n")) ==
          clash("sensor \"flexor\"", "flexor_tension_N", cable));
    CHECK(problem(sensor("flexor", strain)) == clash("sensor \"flexor\"", "flexor_length_mm", cable));
    CHECK(problem(cable_bar +
                  "[[spring]]\nname = \"flexor\"\npoints = [[1, 5, 5], [29, 5, 5]]\nstiffness = \"1 N/m\"\n") ==
          clash("spring \"flexor\"", "flexor_length_mm", cable));
    CHECK(problem(cable_bar + "[[obstacle]]\nname = \"base\"\nplane = { point = [0, 0, -1], normal = [0, 0, 1] }\n") ==
          clash("obstacle \"base\"", "base_force_x_N", "fixed \"base\""));
}

TEST_CASE("a chamber named like a cable is refused: neither could be driven by its name") {
    std::string hollow = cable_bar;
    const std::string full = "{ box = [[0, 0, 0], [30, 10, 10]] }";
    hollow.replace(hollow.find(full), full.size(),
                   "{ difference = [" + full + ", { box = [[10, 3, 3], [20, 7, 7]] }] }");
    const auto with_chamber = [&](const std::string& name) {
        return problem(hollow + "[[chamber]]\nname = \"" + name +
                       "\"\ninside = [15, 5, 5]\ntarget = { pressure = \"1 kPa\" }\n");
    };
    CHECK(
        with_chamber("flexor") ==
        "bar.toml:19: chamber \"flexor\": is driven by the same name as cable \"flexor\"; give one of the two another "
        "name");
    CHECK(with_chamber("air") == "");
}

TEST_CASE("one name for two things is allowed where their columns differ") {
    CHECK(problem(sensor("flexor", "kind = \"distance\"\npoints = [[1, 5, 5], [29, 5, 5]]\n")) == "");
    CHECK(problem(sensor("pull", "kind = \"tension\"\ncable = \"flexor\"\n")) == "");
    CHECK(problem(cable_bar + "[[marker]]\nname = \"flexor\"\npoint = [29, 5, 5]\n") == "");
}
