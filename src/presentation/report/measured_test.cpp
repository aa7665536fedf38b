#include "presentation/report/measured.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "presentation/report/tables.hpp"
#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

/// Marker "tip" goes from (100, 0, 0) straight to (100, 0, 30) mm in three steps; "middle" stays at (50, 10, 0).
sim::Trajectory straight() {
    sim::Trajectory result;
    for (int i = 0; i < 4; ++i) {
        sim::Step step;
        step.index = i;
        step.markers = {{"tip", {0.1, 0, 0.01 * i}}, {"middle", {0.05, 0.01, 0}}};
        result.steps.push_back(step);
    }
    return result;
}

std::vector<MeasuredPath> read(const std::string& text) {
    auto paths = parse_measured(text, "m.csv", straight().steps.front());
    REQUIRE_MESSAGE(paths, (paths ? "" : paths.error().message));
    return *paths;
}

void check_problem(const std::string& text, const std::string& wanted) {
    const auto paths = parse_measured(text, "m.csv", straight().steps.front());
    REQUIRE_FALSE(paths);
    CHECK_MESSAGE(paths.error().message.find(wanted) != std::string::npos, "found \"", paths.error().message, "\"");
}

}  // namespace

TEST_CASE("the markers.csv of a run has no deviation from that run") {
    const report::test::Robot robot = report::test::bent_bar(4, 1);
    const auto paths = parse_measured(markers_csv(robot.result), "markers.csv", robot.result.steps.front());
    REQUIRE_MESSAGE(paths, (paths ? "" : paths.error().message));
    CHECK(paths->size() == 2);
    for (const Deviation& d : deviations(*paths, robot.result)) {
        CHECK(d.points == 5);
        CHECK(d.largest_m < 1e-9);
        CHECK(d.way_m > 0.01);
    }
}

TEST_CASE("deviations are distances to the path between the steps, or to its ends") {
    const auto paths = read("tip_x_mm,tip_y_mm,tip_z_mm\n100,0,5\n102,0,15\n100,0,34\n");
    const auto list = deviations(paths, straight());
    REQUIRE(list.size() == 1);
    CHECK(list[0].mean_m == near(0.002, {.relative = 1e-12}));
    CHECK(list[0].largest_m == near(0.004, {.relative = 1e-12}));
    CHECK(list[0].way_m == near(0.03, {.relative = 1e-12}));
    CHECK(deviation_line(list[0]) ==
          "marker tip: 3 measured points, 2 mm from the simulated way on average, 4 mm at most (13 % of the way)");
    const auto still = deviations(read("middle_x_mm\n51\n"), straight());
    CHECK(deviation_line(still[0]) ==
          "marker middle: 1 measured point, 1 mm from the simulated way on average, 1 mm at most");
}

TEST_CASE("measured markers may have two coordinates, and missing values") {
    const auto paths = read("time;middle_x_mm;middle_z_mm;tip_z_mm\n0;50;0;0\n1;49;;10\n2;;;20\n3;48;1;\n");
    REQUIRE(paths.size() == 2);
    CHECK(paths[0].marker == "middle");
    REQUIRE(paths[0].points.size() == 2);  // not that of which x alone was measured
    CHECK(norm(paths[0].points[1] - Vec3{0.048, 0.01, 0.001}) < 1e-12);
    REQUIRE(paths[1].points.size() == 3);
    CHECK(norm(paths[1].points[2] - Vec3{0.1, 0, 0.02}) < 1e-12);
}

TEST_CASE("a marker whose name begins like a formula is found as markers.csv names it, and as it is") {
    sim::Step rest;
    rest.markers = {{"-tip", {0.1, 0, 0}}};
    for (const char* const text : {"'-tip_x_mm\n100\n", "-tip_x_mm\n100\n"}) {
        const auto paths = parse_measured(text, "m.csv", rest);
        REQUIRE_MESSAGE(paths, (paths ? "" : paths.error().message));
        CHECK((*paths)[0].marker == "-tip");
    }
}

TEST_CASE("the plot looks along the axis of least motion, with a line and dots for each marker") {
    const Plot plot = measured_plot(read("tip_x_mm,tip_z_mm\n101,10\n99,20\n"), straight());
    CHECK(plot.x_label == "x (mm)");
    CHECK(plot.y_label == "z (mm)");
    REQUIRE(plot.series.size() == 2);
    CHECK(plot.series[0].points.size() == 4);
    CHECK(plot.series[1].dots);
    CHECK(plot.series[1].points[1].y == near(20, {.relative = 1e-12}));
    const Plot above = measured_plot(read("tip_x_mm,tip_y_mm,tip_z_mm\n150,90,0\n"), straight());
    CHECK(above.y_label == "y (mm)");
}

TEST_CASE("errors in a measured file name file and line") {
    check_problem("", "m.csv: is empty; the first line names the columns: tip_x_mm");
    check_problem("x,y\n1,2\n",
                  "m.csv:1: no column is named as in \"tip_x_mm\"; markers of the robot: \"tip\" and \"middle\"");
    check_problem("top_x_mm\n1\n", "m.csv:1: \"top\" is not a marker of the robot; it has \"tip\" and \"middle\"");
    check_problem("tip_x_mm\n1\nabc\n", "m.csv:3: tip_x_mm \"abc\" is not a number");
    check_problem("tip_x_mm\nnan\n", "m.csv:2: tip_x_mm \"nan\" is not a number");
    check_problem("tip_x_mm\n1e308\n", "m.csv:2: tip_x_mm \"1e308\" is too large");
    check_problem("tip_x_mm,tip_x_mm\n1,2\n", "m.csv:1: there are two columns \"tip_x_mm\"");
    check_problem("tip_x_mm\n1\n1,2\n", "m.csv:3: 2 columns, the first line names 1");
    check_problem("tip_x_mm,tip_y_mm\n1\n", "m.csv:2: 1 columns");
    check_problem("tip_x_mm,middle_x_mm\n1,\n", "m.csv: middle has no point");
}
