#include "presentation/report/summary.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/near.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;
using Json = nlohmann::json;

TEST_CASE("summary.json has the keys and values that the design promises") {
    auto robot = report::test::bent_bar(10, 2);
    robot.result.steps.back().chambers = {{"air", 1.25, 2e-6, 40e3}};
    Simulation s = robot.simulation();
    s.timing = {2, 0.125, 0.75, 1.5};
    const Json j = Json::parse(summary_json(s));
    CHECK(j["robot"] == "bent bar");
    CHECK(j["pliant"].get<std::string>().find('.') != std::string::npos);
    CHECK(j["nodes"] == robot.mesh.points.size());
    CHECK(j["tets"] == 1440);
    CHECK(j["order"] == 2);
    CHECK(j["solver"] == "newton");
    CHECK(j["converged"] == true);
    CHECK(j["message"] == "");
    CHECK(j["warnings"].empty());
    CHECK(j["peak_memory_MB"] == 123.5);
    CHECK(j["timing"]["mesh_ms"] == 2000);
    CHECK(j["timing"]["setup_ms"] == 250 + 125);
    CHECK(j["timing"]["solve_ms"] == 500);
    CHECK(j["timing"]["files_ms"] == 750);
    CHECK(j["timing"]["pictures_ms"] == 1500);
    CHECK(j["timing"]["frames_per_second"] == 20);
    REQUIRE(j["steps"].size() == 10);
    CHECK(j["rest"]["index"] == 0);
    CHECK(j["steps"][0]["index"] == 1);
    const Json& last = j["steps"][9];
    CHECK(last["index"] == 10);
    CHECK(last["iterations"] == 6);
    CHECK(last["residual"] == near(3.5e-6, {.relative = 1e-12}));
    CHECK(last["wall_ms"] == near(12, {.relative = 1e-12}));
    CHECK(last["min_J"] == near(0.98, {.relative = 1e-12}));
    CHECK(last["cables"]["flexor"]["tension_N"] == 71);
    CHECK(last["cables"]["flexor"]["length_mm"].get<double>() ==
          near(120 * last["cables"]["flexor"]["length_ratio"].get<double>(), {.relative = 1e-5}));
    CHECK(last["chambers"]["air"]["volume_mm3"] == near(2000, {.relative = 1e-12}));
    CHECK(last["chambers"]["air"]["pressure_kPa"] == near(40, {.relative = 1e-12}));
    CHECK(last["supports"]["base"]["force_N"] == Json({-71, 0, 0.5}));
    CHECK(last["markers"]["tip"][0].get<double>() == near(200 / 3.14159265358979, {.relative = 1e-12}));
    CHECK(j["steps"][3]["chambers"].empty());
}

TEST_CASE("contacts are listed at every step, or at none") {
    auto robot = report::test::bent_bar(2, 1);
    CHECK_FALSE(Json::parse(summary_json(robot.simulation()))["rest"].contains("contacts"));
    robot.result.steps[2].self_contact_N = 3.5;
    robot.result.steps[2].smallest_distance_m = 2e-5;
    const Json j = Json::parse(summary_json(robot.simulation()));
    CHECK(j["rest"]["self_contact_N"] == 0);
    CHECK(j["rest"]["smallest_distance_mm"].is_null());
    CHECK(j["steps"][1]["self_contact_N"] == 3.5);
    CHECK(j["steps"][1]["smallest_distance_mm"] == near(0.02, {.relative = 1e-12}));
}

TEST_CASE("NaN becomes null, and invalid UTF-8 is replaced") {
    auto robot = report::test::bent_bar(1, 1);
    robot.result.steps[1].residual = std::nan("");
    robot.result.message = "stopped \xff here";
    const Json j = Json::parse(summary_json(robot.simulation(), -1));
    CHECK(j["steps"][0]["residual"].is_null());
    CHECK(j["message"] == "stopped \xef\xbf\xbd here");
}

TEST_CASE("measured markers have their deviations in the summary") {
    auto robot = report::test::bent_bar(2, 1);
    Simulation s = robot.simulation();
    s.measured = {{"tip", {robot.result.steps.back().markers.front().position_m + Vec3{0, 0.003, 0}}}};
    const Json j = Json::parse(summary_json(s));
    CHECK(j["measured"]["tip"]["points"] == 1);
    CHECK(j["measured"]["tip"]["largest_mm"].get<double>() == near(3, {.relative = 1e-12}));
    s.measured.clear();
    CHECK_FALSE(Json::parse(summary_json(s)).contains("measured"));
}
