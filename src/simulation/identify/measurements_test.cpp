// Tables of measurements, and what is wrong with them.
#include "simulation/identify/measurements.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "simulation/identify/test_bars.hpp"

using namespace pliant;
using namespace pliant::sim::identify;
using namespace pliant::sim::identify::testing;

namespace {

const std::string more = R"(
    cable = [{ name = "flexor", points = [[0, 5, 9], [60, 5, 9]], target.length_ratio = 0.9 }]
    program = { steps = 4, duration = "2 s" }
)";

std::string problem(const std::string& csv, JudgeOn judge = JudgeOn::nothing) {
    const Bar bar(more);
    const auto read = parse_measurements(csv, "m.csv", bar.variant()->model.description(), bar.robot().program, judge);
    return read ? "" : read.error().message;
}

void check_problem(const std::string& csv, const std::string& wanted) {
    CAPTURE(csv);
    const std::string found = problem(csv);
    CHECK_MESSAGE(found.find(wanted) == 0, "found \"", found, "\", wanted \"", wanted, "\"");
    CHECK(found.find('\n') == std::string::npos);
}

}  // namespace

TEST_CASE("rows are read by time or by step, with empty cells and scatters") {
    const Bar bar(more);
    const Measurements m = bar.read(
        "# from a video\ntime;tip_x_mm;tip_x_mm_scatter;flexor_tension_N\n0.5;59;0.2;\n1.25;;;3.5\n2;55;0.1;4\n");
    REQUIRE(m.channels.size() == 2);
    REQUIRE(m.values.size() == 4);
    CHECK(m.values[0].line == 3);
    CHECK(m.values[0].time == near(0.5, {.relative = 1e-12}));
    CHECK(m.values[0].scatter == near(0.2, {.relative = 1e-12}));
    CHECK(m.channels[m.values[1].channel].column == "flexor_tension_N");
    CHECK(m.values[1].value == near(3.5, {.relative = 1e-12}));
    CHECK(m.values[1].scatter == 0);
    const Measurements steps = bar.read("step,tip_x_mm\n1,59\n2.5,58\n");
    CHECK(steps.values[1].time == near(1.25, {.relative = 1e-12}));
    const Measurements either = bar.read("time,step,tip_x_mm\n0.5,,59\n,3,58,,\n1,1,57\n");
    REQUIRE(either.values.size() == 3);
    CHECK(either.values[0].time == near(0.5, {.relative = 1e-12}));
    CHECK(either.values[1].time == near(1.5, {.relative = 1e-12}));
    CHECK(either.values[2].time == near(1, {.relative = 1e-12}));
}

TEST_CASE("rows can be held out for validation") {
    const Bar bar(more);
    const std::string rows = "step,tip_x_mm\n0,60\n1,59\n2,58\n3,57\n4,56\n";
    const auto judged = [](const Measurements& m) {
        std::string text;
        for (const MeasuredValue& value : m.values) text += value.judged ? 'j' : 'f';
        return text;
    };
    CHECK(judged(bar.read(rows)) == "fffff");
    CHECK(judged(bar.read(rows, JudgeOn::every_second)) == "fjfjf");
    CHECK(judged(bar.read(rows, JudgeOn::second_half)) == "fffjj");
    CHECK(judged(bar.read("step,use,tip_x_mm\n1,fit,59\n2,judge,58\n")) == "fj");
}

TEST_CASE("a table that simulate has written can be read") {
    const Bar bar(more);
    const Measurements m = bar.read(
        "index,time,converged,iterations,substeps,residual,wall_ms,min_J,solver,"
        "flexor_length_ratio,flexor_length_mm,flexor_tension_N\n"
        "1,0.5,1,3,1,1e-6,4,0.9,newton,0.975,58.5,1.5\n");
    CHECK(m.values.size() == 3);
}

TEST_CASE("a name that simulate kept from being a formula is read back, and written so again") {
    const Bar bar(test::replaced(bar_text, "\"corner\"", "\"-corner\"") + more, bar_mesh(false));
    const Measurements m = bar.read("index,time,'-corner_x_mm,'-corner_x_mm_scatter\n1,0.5,59,0.1\n");
    REQUIRE(m.channels.size() == 1);
    CHECK(m.channels[0].column == "-corner_x_mm");
    CHECK(m.values[0].scatter == near(0.1, {.relative = 1e-12}));
    Identification result;
    result.channels = m.channels;
    result.channels[0].column = "-a,b_x_mm";
    result.values = {{m.values[0], 1, 2}};
    CHECK(comparison_csv(result).find("\n2,0.5,\"'-a,b_x_mm\",mm,fit,59,0.1,1,2\n") != std::string::npos);
}

TEST_CASE("columns of steps.csv that cannot be compared are passed over and named") {
    const Bar bar(more + "sensor = [{ name = \"gauge\", kind = \"tension\", cable = \"flexor\" }]\n");
    const Measurements m = bar.read("index,time,gauge_tension_N,tip_x_mm\n1,0.5,2,59\n");
    CHECK(m.values.size() == 1);
    CHECK(m.not_compared == std::vector<std::string>{"gauge_tension_N"});
    check_problem("time,gauge_tension_N,tip_x_mm\n1,2,59\n", "m.csv:1: the robot has nothing that column");
}

TEST_CASE("errors in measurements name file and line") {
    check_problem("", "m.csv: is empty; the first line names the columns: time,tip_x_mm");
    check_problem("tip_x_mm\n59\n", "m.csv:1: no column \"time\" or \"step\" says when each row was measured");
    check_problem("time\n1\n", "m.csv:1: no column holds a measured value; possible are middle_x_mm");
    check_problem("time,top_x_mm\n1,59\n",
                  "m.csv:1: the robot has nothing that column \"top_x_mm\" could be; did you mean \"tip_x_mm\"?");
    check_problem("time,tip_x_mm,tip_x_mm\n1,59,59\n", "m.csv:1: there are two columns \"tip_x_mm\"");
    check_problem(
        "time,tip_x_mm,tip_z_mm_scatter\n1,59,0.1\n",
        "m.csv:1: column \"tip_z_mm_scatter\" is the scatter of \"tip_z_mm\", which is not a column of the table");
    check_problem("time,tip_x_mm\n0.5,59\n,58\n", "m.csv:3: time is empty; every row needs one");
    check_problem("time,step,tip_x_mm\n0.5,,59\n,,58\n",
                  "m.csv:3: time and step are empty; every row needs one of them");
    check_problem("time,tip_x_mm\n3,59\n", "m.csv:2: time 3 is outside the program, which goes from 0 to 2");
    check_problem("step,tip_x_mm\n-1,59\n", "m.csv:2: step -1 is outside the program, which goes from 0 to 4");
    check_problem("time,tip_x_mm\n1,5 9\n", "m.csv:2: tip_x_mm \"5 9\" is not a number");
    check_problem("time,tip_x_mm\n1,-1e308\n", "m.csv:2: tip_x_mm \"-1e308\" is too large");
    check_problem("time,tip_x_mm\n1,nan\n", "m.csv:2: tip_x_mm \"nan\" is not a number");
    check_problem("time,tip_x_mm\n1\n", "m.csv:2: 1 columns, but the first line names more");
    check_problem("time,tip_x_mm\n1,2,3\n", "m.csv:2: 3 columns, the first line names 2");
    check_problem("time,tip_x_mm,tip_x_mm_scatter\n1,59,0\n",
                  "m.csv:2: tip_x_mm_scatter 0 is not possible; a scatter is above zero");
    check_problem("time,tip_x_mm,tip_x_mm_scatter\n1,59,\n",
                  "m.csv:2: tip_x_mm_scatter is empty, but tip_x_mm has a value; give both or none");
    check_problem("time,tip-middle-tip_angle_deg\n1,59\n", "m.csv:1: the robot has nothing that column");
    check_problem("time,use,tip_x_mm\n1,test,59\n", "m.csv:2: use \"test\" is neither fit nor judge");
    check_problem("time,tip_x_mm\n1,\n", "m.csv: no row has a value");
    check_problem("time,use,tip_x_mm\n1,judge,59\n", "m.csv: all rows are held out, none is left to fit");
    check_problem("time,middle-tap_angle_x_deg\n1,59\n", "m.csv:1: the robot has nothing that column");
}
