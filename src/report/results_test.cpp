#include "report/results.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/files.hpp"
#include "core/test_folder.hpp"
#include "report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

TEST_CASE("the folder holds every file that the design names") {
    const auto robot = report::test::bent_bar(3, 1);
    const pliant::test::Folder folder("results");
    Progress progress;
    const auto status = write_results(folder.path(), robot.simulation(), progress, {240, 150});
    REQUIRE_MESSAGE(status.has_value(), status.error().message);
    for (const char* name : {"summary.json", "steps.csv", "markers.csv", "iterations.csv", "frames.pvd",
                             "frames/frame_0000.vtu", "frames/frame_0003.vtu", "robot.glb", "pictures/rest.png",
                             "pictures/final.png", "pictures/stages.png", "pictures/von_mises.png", "report.html"}) {
        CHECK_MESSAGE(std::filesystem::file_size(folder.path() / name) > 100, name);
    }
}

TEST_CASE("a rest state alone, and robots without cables or markers, are reported too") {
    auto robot = report::test::bent_bar(1, 1);
    robot.result.steps.pop_back();
    robot.result.steps[0].cables.clear();
    robot.result.steps[0].markers.clear();
    robot.result.steps[0].supports.clear();
    robot.cable_points.clear();
    robot.result.converged = false;
    robot.result.message = "step 1: did not converge";
    const pliant::test::Folder folder("rest_only");
    Progress progress;
    CHECK(write_results(folder.path(), robot.simulation(), progress, {240, 150}).has_value());
    const auto html = read_file(folder.path() / "report.html");
    REQUIRE(html.has_value());
    CHECK(html->find("step 1: did not converge") != std::string::npos);
}

TEST_CASE("input that does not fit together is refused with the reason") {
    const auto refused = [](const report::test::Robot& robot, auto change) {
        Simulation s = robot.simulation();
        change(s);
        const auto status = check(s);
        return status ? std::string("accepted") : status.error().message;
    };
    const auto robot = report::test::bent_bar(2, 1);
    CHECK(refused(robot, [](Simulation&) {}) == "accepted");
    CHECK(refused(robot, [](Simulation& s) { s.region_material = {0}; }) ==
          "report: region_material has 1 entries, the mesh 2 regions");
    CHECK(refused(robot, [](Simulation& s) {
              s.region_material = {0, 2};
          }) == "report: region_material names material 2 of 2");
    CHECK(refused(robot, [](Simulation& s) { s.cable_points.pop_back(); }) == "report: cable_points has 2 steps of 3");
    CHECK(refused(robot, [](Simulation& s) { s.materials.clear(); }) == "report: at least one material is needed");
    CHECK(refused(robot, [](Simulation& s) { s.fields = nullptr; }) == "report: no function for the fields");

    auto broken = report::test::bent_bar(2, 1);
    broken.result.steps[1].positions.pop_back();
    CHECK(refused(broken, [](Simulation&) {}).starts_with("report: step 1 has "));
    broken = report::test::bent_bar(2, 1);
    broken.result.steps[2].positions[7].y = std::nan("");
    CHECK(refused(broken, [](Simulation&) {}) == "report: step 2 has positions that are not numbers");
    broken = report::test::bent_bar(2, 1);
    broken.result.steps[2].markers.clear();
    CHECK(refused(broken, [](Simulation&) {}).starts_with("report: step 2 has other cables"));
    broken = report::test::bent_bar(2, 1);
    broken.mesh.nodes[5] = 1 << 30;
    CHECK(refused(broken, [](Simulation&) {}).starts_with("report: a tet names node "));
}

TEST_CASE("a folder that cannot be written is an error") {
    const auto robot = report::test::bent_bar(1, 1);
    Progress progress;
    CHECK_FALSE(write_results("/proc/no_such_folder", robot.simulation(), progress, {240, 150}).has_value());
}
