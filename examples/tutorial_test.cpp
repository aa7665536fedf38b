// examples/tutorial: the robot that docs/tutorial.md ends with, with expected numbers (this program's own, to notice
// changes).
#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

sim::Trajectory run(const std::vector<std::string>& assignments) {
    return robot::testing::run_file("examples/tutorial/finger.toml", assignments);
}

}  // namespace

TEST_CASE("the tutorial's finger has the expected tension and tip, linear and quadratic") {
    const sim::Step linear = run({"mesh.order=1"}).steps.back();
    CHECK(linear.cables[0].tension_N == near(29.30, {.relative = 5e-3}));
    CHECK(linear.markers[0].position_m.x == near(55.40e-3, {.relative = 5e-3}));
    CHECK(linear.markers[0].position_m.z == near(38.22e-3, {.relative = 5e-3}));
    const sim::Step quadratic = run({}).steps.back();
    CHECK(quadratic.cables[0].tension_N == near(12.14, {.relative = 5e-3}));
    CHECK(quadratic.markers[0].position_m.x == near(54.26e-3, {.relative = 5e-3}));
    CHECK(quadratic.markers[0].position_m.z == near(38.82e-3, {.relative = 5e-3}));
}
