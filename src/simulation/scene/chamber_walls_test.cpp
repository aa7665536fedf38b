// Chambers whose wall comes from a file, against the same air drawn in the robot file.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

TEST_CASE("a chamber from a file of twelve triangles inflates as the same cavity of the bodies") {
    const test::Folder folder("chamber");
    const std::string file = folder / "air.stl";
    REQUIRE(mesh::write_stl(file, mesh::test::cube({4, 4, 4}, 12)));
    const auto inflated = [&](const std::string& air, const std::string& target, int order) {
        const std::string text = fmt::format(R"(
name = "cube"
length_unit = "mm"
[material.rubber]
youngs_modulus = "100 kPa"
poisson_ratio = 0.45
[[body]]
name = "cube"
material = "rubber"
geometry = {{ difference = [{{ box = [[0, 0, 0], [20, 20, 20]] }}, {{ box = [[4, 4, 4], [16, 16, 16]] }}] }}
[mesh]
size = "5 mm"
order = {}
[[fixed]]
name = "base"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[[chamber]]
name = "air"
{}
target = {{ {} }}
[program]
steps = 2
)",
                                             order, air, target);
        const auto built = robot::testing::build(robot::parse_robot(text, "cube.toml"));
        return robot::testing::run_to_the_end(built).steps.back().chambers.at(0);
    };
    const std::string inside = "inside = [10, 10, 10]", surface = fmt::format("surface = \"{}\"", file);
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const double error = order == 1 ? 0.15 : 0.01;  // with faces that stay flat, and with those that bend
        const auto drawn = inflated(inside, "pressure = \"10 kPa\"", order);
        const auto read = inflated(surface, "pressure = \"10 kPa\"", order);
        CHECK(drawn.volume_m3 > 1.05 * 1.728e-6);
        CHECK(read.volume_m3 / 1.728e-6 - 1 == near(drawn.volume_m3 / 1.728e-6 - 1, {.relative = error}));
        const auto held = inflated(inside, "volume_ratio = 1.2", order);
        CHECK(inflated(surface, "volume_ratio = 1.2", order).pressure_Pa ==
              near(held.pressure_Pa, {.relative = error}));
    }
}
