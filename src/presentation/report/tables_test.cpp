#include "presentation/report/tables.hpp"

#include <doctest/doctest.h>

#include <clocale>
#include <sstream>
#include <vector>

#include "presentation/report/summary.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

}  // namespace

TEST_CASE("steps.csv has a row per step, the rest state included, in the units of its header") {
    const auto robot = report::test::bent_bar(10, 1);
    const auto lines = lines_of(steps_csv(robot.result));
    REQUIRE(lines.size() == 12);
    CHECK(lines[0] ==
          "index,time,converged,iterations,substeps,residual,wall_ms,min_J,solver,flexor_length_ratio,flexor_length_mm,"
          "flexor_tension_N,base_force_x_N,base_force_y_N,base_force_z_N");
    CHECK(lines[1] == "0,0,1,0,1,0,0,1,,1,120,0,-0,0,0.5");
    CHECK(lines[11].starts_with("10,1,1,6,1,3.5e-06,12,0.98,newton,0.9333"));
    CHECK(lines[11].ends_with(",71,-71,0,0.5"));
}

TEST_CASE("markers.csv gives millimetres") {
    const auto robot = report::test::bent_bar(10, 1);
    const auto lines = lines_of(markers_csv(robot.result));
    REQUIRE(lines.size() == 12);
    CHECK(lines[0] == "index,time,tip_x_mm,tip_y_mm,tip_z_mm,middle_x_mm,middle_y_mm,middle_z_mm");
    CHECK(lines[1] == "0,0,100,10,7.5,50,10,7.5");
    // A quarter circle of length 100 mm: radius 200 / pi.
    CHECK(lines[11].starts_with("10,1,63.66197724,10,71.16197724,"));
}

TEST_CASE("iterations.csv has a row per iteration") {
    sim::Trajectory result;
    result.iterations = {{1, 0.05, sim::Solver::anderson, 0, 1, 0.01, -0.5, 0, 0.9},
                         {1, 0.05, sim::Solver::quasi_newton, 1, 0.25, 0, -0.75, 0.5, 0.875}};
    const auto lines = lines_of(iterations_csv(result));
    REQUIRE(lines.size() == 3);
    CHECK(lines[0] == "step,time,solver,iteration,residual,violation,energy_J,alpha,min_J");
    CHECK(lines[1] == "1,0.05,anderson,0,1,0.01,-0.5,0,0.9");
    CHECK(lines[2] == "1,0.05,quasi-newton,1,0.25,0,-0.75,0.5,0.875");
}

TEST_CASE("contact forces of obstacles and self-contact have columns where there is contact") {
    auto robot = report::test::bent_bar(2, 1);
    for (auto& step : robot.result.steps) step.contacts = {{"ball", {0.5, 0, -2.0 * step.index}}};
    robot.result.steps[2].self_contact_N = 3.5;
    robot.result.steps[2].smallest_distance_m = 2e-5;
    const auto lines = lines_of(steps_csv(robot.result));
    CHECK(
        lines[0].ends_with(",base_force_z_N,ball_force_x_N,ball_force_y_N,ball_force_z_N,self_contact_N,"
                           "smallest_distance_mm"));
    CHECK(lines[1].ends_with(",0.5,0.5,0,-0,0,"));
    CHECK(lines[3].ends_with(",0.5,0.5,0,-4,3.5,0.02"));
}

TEST_CASE("sensor readings have columns with their unit, and keys in the summary") {
    auto robot = report::test::bent_bar(2, 1);
    for (auto& step : robot.result.steps)
        step.sensors = {
            {"gauge", {{"strain", sim::SensedQuantity::ratio, 0.25}, {"length", sim::SensedQuantity::length, 0.002}}},
            {"gyro", {{"acceleration_x", sim::SensedQuantity::acceleration, 9.5}}}};
    const auto lines = lines_of(steps_csv(robot.result));
    CHECK(lines[0].ends_with(",base_force_z_N,gauge_strain,gauge_length_mm,gyro_acceleration_x_m_per_s2"));
    CHECK(lines[1].ends_with(",0.5,0.25,2,9.5"));
    const std::string summary = summary_json(robot.simulation(), -1);
    CHECK(summary.find(R"("gauge":{"strain":0.25,"length_mm":2.0})") != std::string::npos);
    CHECK(summary.find(R"("gyro":{"acceleration_x_m_per_s2":9.5})") != std::string::npos);
}

TEST_CASE("the decimal point does not depend on the locale") {
    const auto robot = report::test::bent_bar(2, 1);
    const std::string plain = steps_csv(robot.result);
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"}) {
        if (std::setlocale(LC_ALL, name) != nullptr) CHECK(steps_csv(robot.result) == plain);
    }
    std::setlocale(LC_ALL, before.c_str());
}
