// examples/tutorial: the robot that docs/tutorial.md ends with, with expected numbers (this program's own, to notice
// changes).
#include <doctest/doctest.h>

#include "robot/build.hpp"

using namespace pliant;

namespace {

sim::Trajectory run(const std::vector<std::string>& assignments) {
    const auto robot = robot::load_robot("examples/tutorial/finger.toml", assignments);
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    auto mesh = robot::build_mesh(*robot, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    const auto model = robot::build_model(*robot, std::move(*mesh));
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    sim::Trajectory result = sim::run(*model, robot->program, silent);
    REQUIRE_MESSAGE(result.converged, result.message);
    return result;
}

}  // namespace

TEST_CASE("the finger of the tutorial, linear and quadratic") {
    const sim::Step linear = run({"mesh.order=1"}).steps.back();
    CHECK(linear.cables[0].tension_N == doctest::Approx(29.30).scale(0).epsilon(5e-3));
    CHECK(linear.markers[0].position_m.x == doctest::Approx(55.40e-3).scale(0).epsilon(5e-3));
    CHECK(linear.markers[0].position_m.z == doctest::Approx(38.22e-3).scale(0).epsilon(5e-3));
    const sim::Step quadratic = run({}).steps.back();
    CHECK(quadratic.cables[0].tension_N == doctest::Approx(12.14).scale(0).epsilon(5e-3));
    CHECK(quadratic.markers[0].position_m.x == doctest::Approx(54.26e-3).scale(0).epsilon(5e-3));
    CHECK(quadratic.markers[0].position_m.z == doctest::Approx(38.82e-3).scale(0).epsilon(5e-3));
}
