// examples/cable_gripper with expected numbers. They are this program's own on this mesh (4 mm), to notice changes; how
// the same solver stands against CalculiX is in src/simulation/run/cable_reference_test.cpp.
#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;

namespace {

sim::Trajectory run(const std::vector<std::string>& assignments) {
    return robot::testing::run_file("examples/cable_gripper/gripper.toml", assignments);
}

}  // namespace

TEST_CASE("the gripper bends with the expected tension and markers") {
    const sim::Trajectory result = run({"mesh.size=\"4 mm\"", "program.steps=15"});
    CHECK(result.warnings.empty());
    const sim::Step& last = result.steps.back();
    CHECK(last.cables[0].length_ratio == near(0.7, {.relative = 1e-6}));
    CHECK(last.cables[0].tension_N == near(27.34, {.relative = 5e-3}));
    CHECK(last.markers[1].position_m.x == near(34.05e-3, {.relative = 5e-3}));
    CHECK(last.markers[1].position_m.z == near(45.40e-3, {.relative = 5e-3}));
    // The cable is pulled out at the clamp: the support carries its tension, along the bar.
    CHECK(last.supports[0].force_N.x == near(last.cables[0].tension_N, {.relative = 1e-2}));
    // The soft half bends more than the hard one: the middle marker hardly moves.
    CHECK(last.markers[0].position_m.z < 16e-3);
    for (const sim::Step& step : result.steps) CHECK(step.min_J > 0.5);
}

TEST_CASE("all solvers give the same tension of the gripper, within 0.2 %") {
    const std::vector<std::string> coarse = {"mesh.size=\"8 mm\"", "mesh.order=1", "program.steps=5",
                                             "cable.flexor.target.length_ratio=0.9"};
    std::vector<double> tension;
    for (const char* solver : {"newton", "quasi-newton", "anderson", "local-global"}) {
        auto assignments = coarse;
        assignments.push_back(std::string("program.solver=") + solver);
        tension.push_back(run(assignments).steps.back().cables[0].tension_N);
    }
    CHECK(tension[1] == near(tension[0], {.relative = 2e-3}));
    CHECK(tension[2] == near(tension[0], {.relative = 2e-3}));
    CHECK(tension[3] == near(tension[0], {.relative = 2e-3}));
}

TEST_CASE("a gripper with four gaps is built from one parameter, and solved") {
    const sim::Trajectory four = run({"parameters.gaps=4", "mesh.size=\"6 mm\"", "mesh.order=1", "program.steps=3",
                                      "cable.flexor.target.length_ratio=0.9"});
    CHECK(four.steps.back().cables[0].tension_N > 0);
}

TEST_CASE("pulled further than its gaps are wide, the gripper touches itself; without contact a warning says so") {
    const std::vector<std::string> far = {"mesh.size=\"8 mm\"", "mesh.order=1", "program.steps=50",
                                          "cable.flexor.target.length_ratio=0.6"};
    const sim::Trajectory touching = run(far);
    CHECK(touching.warnings.empty());
    CHECK(touching.steps.back().self_contact_N > 0);
    std::vector<std::string> through = far;
    through.emplace_back("contact.self=false");
    const sim::Trajectory result = run(through);
    REQUIRE(!result.warnings.empty());
    CHECK(result.warnings[0].find("have met") != std::string::npos);
}
