// Half and quarter robots against the whole ones, to within what different meshes make; with the material of one side
// alone tensions were 20 to 24 % too low.
#include "simulation/scene/symmetry_planes.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>

#include "base/core/near.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::build_text;
using robot::testing::last_step;

namespace {

const std::string half_y =
    "[[fixed]]\nname = \"half\"\nplane = { point = [0, 0, 0], normal = [0, 1, 0] }\n"
    "directions = \"normal\"\n";
const std::string half_z =
    "[[fixed]]\nname = \"quarter\"\nplane = { point = [0, 0, 0], normal = [0, 0, 1] }\n"
    "directions = \"normal\"\n";

/// A bar of 40 mm along x, clamped at one end. `low`: where its section of up to 12 by 10 mm begins.
std::string part_of_bar(double low_y, double low_z, const std::string& more) {
    return fmt::format(R"(
name = "part"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
poisson_ratio = 0.45
[[body]]
name = "bar"
material = "rubber"
geometry = {{ box = [[0, {}, {}], [40, 6, 5]] }}
[mesh]
size = "2 mm"
order = 1
[[fixed]]
name = "clamp"
plane = {{ point = [0, 0, 0], normal = [1, 0, 0] }}
directions = ["x", "z"]
[[fixed]]
name = "pin"
nodes = [0]
directions = ["y"]
[[marker]]
name = "tip"
point = [40, 0, 5]
[program]
steps = 2
tolerance = 1e-6
{})",
                       low_y, low_z, more);
}

std::string cable_at(double z, const std::string& target) {
    return fmt::format(
        "[[cable]]\nname = \"c\"\npoints = [[0, 0, {0}], [10, 0, {0}], [20, 0, {0}], [30, 0, {0}], [39, 0, {0}]]\n"
        "eyelet_radius = \"3 mm\"\ntarget = {{ {1} }}\n",
        z, target);
}

}  // namespace

TEST_CASE("a cable on the plane of symmetry of half a bar has half the tension for a given length") {
    for (const char* target : {"length_ratio = 0.97", "tension = \"1 N\""}) {
        CAPTURE(std::string(target));
        const bool by_tension = std::string(target).starts_with("tension");
        const sim::Step whole = last_step(build_text(part_of_bar(-6, -5, cable_at(3, target))));
        const sim::Step half = last_step(
            build_text(part_of_bar(0, -5, half_y + cable_at(3, by_tension ? "tension = \"0.5 N\"" : target))));
        MESSAGE("tension ", half.cables[0].tension_N, " N of ", whole.cables[0].tension_N, " N; length ",
                half.cables[0].length_m, " and ", whole.cables[0].length_m);
        CHECK(2 * half.cables[0].tension_N == near(whole.cables[0].tension_N, {.relative = 0.06}));
        CHECK(half.markers[0].position_m.z - 5e-3 == near(whole.markers[0].position_m.z - 5e-3, {.relative = 0.06}));
    }
}

TEST_CASE("a cable on the edge of a quarter bar has a quarter of the tension") {
    const sim::Step whole = last_step(build_text(part_of_bar(-6, -5, cable_at(0, "length_ratio = 0.97"))));
    const sim::Step quarter =
        last_step(build_text(part_of_bar(0, 0, half_y + half_z + cable_at(0, "length_ratio = 0.97"))));
    MESSAGE("tension ", quarter.cables[0].tension_N, " N of ", whole.cables[0].tension_N, " N");
    CHECK(4 * quarter.cables[0].tension_N == near(whole.cables[0].tension_N, {.relative = 0.06}));
}

TEST_CASE("a load on the plane of symmetry is carried by both halves") {
    const auto load = [](double force_N) {
        return fmt::format(
            "[[load]]\nname = \"push\"\npoint = [30, 0, 5]\nradius = \"3 mm\"\nforce = [\"0 N\", \"0 N\", \"{} N\"]\n",
            force_N);
    };
    const sim::Step whole = last_step(build_text(part_of_bar(-6, -5, load(-0.04))));
    const sim::Step half = last_step(build_text(part_of_bar(0, -5, half_y + load(-0.02))));
    CHECK(half.markers[0].position_m.z - 5e-3 == near(whole.markers[0].position_m.z - 5e-3, {.relative = 0.06}));
}

TEST_CASE("only supports that hold one plane still along its normal make a plane of symmetry") {
    const auto planes = [](const std::string& more) {
        return robot::symmetry_planes(build_text(part_of_bar(0, -5, more)).model.description()).size();
    };
    CHECK(planes(half_y) == 1);
    CHECK(planes("") == 0);
    std::string moving = half_y;
    moving += "move = [0, 1, 0]\n";
    CHECK(planes(moving) == 0);
    CHECK(planes("[[fixed]]\nname = \"side\"\nplane = { point = [0, 0, 0], normal = [0, 1, 0] }\n"
                 "directions = [\"x\"]\n") == 0);
}
