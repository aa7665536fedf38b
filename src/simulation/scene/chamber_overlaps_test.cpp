// Two chambers in one cavity are refused, however each is given; two cavities side by side are not.
#include <doctest/doctest.h>

#include <string>

#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::problem;

namespace {

const std::string two_cavities = R"(name = "bar"
length_unit = "mm"
[material.rubber]
youngs_modulus = "1 MPa"
[[body]]
name = "bar"
material = "rubber"
geometry = { difference = [{ box = [[0, 0, 0], [30, 10, 10]] }, { box = [[3, 3, 3], [7, 7, 7]] }, { box = [[18, 3, 3], [22, 7, 7]] }] }
[mesh]
size = "4 mm"
order = 1
[[fixed]]
name = "base"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
)";

std::string chamber_of(const std::string& name, const std::string& air) {
    return "[[chamber]]\nname = \"" + name + "\"\n" + air + "\ntarget = { pressure = \"1 kPa\" }\n";
}

const std::string refused =
    "bar.toml:19: chamber \"b\": its air is that of chamber \"a\", at least in part: two chambers cannot hold the same "
    "air; draw them apart, or leave one out";

}  // namespace

TEST_CASE("two points in one cavity cannot be two chambers") {
    const std::string first = two_cavities + chamber_of("a", "inside = [6, 5, 5]");
    CHECK(problem(first + chamber_of("b", "inside = [5, 4, 5]")) == refused);
    CHECK(problem(first + chamber_of("b", "inside = [20, 5, 5]")) == "");
}

TEST_CASE("a chamber drawn in a cavity that another one names, whole or in part, is refused in one line") {
    const std::string first = two_cavities + chamber_of("a", "inside = [6, 5, 5]");
    CHECK(problem(first + chamber_of("b", "geometry = { box = [[3, 3, 3], [7, 7, 7]] }")) == refused);
    CHECK(problem(first + chamber_of("b", "geometry = { box = [[3, 3, 3], [5, 7, 7]] }")) == refused);
    CHECK(problem(first + chamber_of("b", "geometry = { box = [[18, 3, 3], [22, 7, 7]] }")) == "");
}

TEST_CASE("a surface from a file in a cavity that another chamber has is refused") {
    const test::Folder folder("overlap");
    const std::string file = folder / "air.stl";
    REQUIRE(mesh::write_stl(file, mesh::test::cube({3, 3, 3}, 4)));
    const std::string air = "surface = \"" + file + "\"";
    CHECK(problem(two_cavities + chamber_of("a", "inside = [6, 5, 5]") + chamber_of("b", air)) == refused);
    CHECK(problem(two_cavities + chamber_of("a", "inside = [20, 5, 5]") + chamber_of("b", air)) == "");
}
