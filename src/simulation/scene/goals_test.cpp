// Goals and ranges of a robot file: how they are read, and typical errors.
#include <doctest/doctest.h>

#include <fstream>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "robot/file/program_writer.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/build_goals.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using namespace pliant::robot;
using pliant::test::holds;
using testing::check_problem;

namespace {

const std::string robot_with_cable = R"(name = "bar"
length_unit = "mm"
[material.soft]
youngs_modulus = "1 MPa"
poisson_ratio = 0.4
[[body]]
name = "bar"
material = "soft"
geometry = { box = [[0, 0, 0], [40, 10, 10]] }
[mesh]
size = "6 mm"
order = 1
[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, 10, 10]]
[[cable]]
name = "flexor"
points = [[0, 5, 8], [40, 5, 8]]
range = [0.8, 1.0]
rate = 0.05
price = { tension = 2 }
[[marker]]
name = "tip"
point = [40, 5, 5]
[[marker]]
name = "middle"
point = [20, 5, 5]
[program]
steps = 3
)";

const std::string reach = "[[goal]]\nname = \"reach\"\nmarker = \"tip\"\n";

}  // namespace

TEST_CASE("goals and ranges are converted to SI, and refer to markers and actuators") {
    const auto built = testing::build(
        parse_robot(robot_with_cable + reach +
                        "path = [[38, 5, 9], [37, 5, 11]]\ntolerance = \"0.2 mm\"\nweight = 3\ntimes = [0.5, 1]\n",
                    "bar.toml"));
    const auto task = build_goals(built.robot, built.model);
    REQUIRE_MESSAGE(task, (task ? "" : task.error().message));
    REQUIRE(task->goals.size() == 1);
    const sim::Goal& goal = task->goals[0];
    CHECK(goal.markers == std::vector<std::size_t>{0});
    REQUIRE(goal.wanted.size() == 2);
    CHECK(goal.wanted[1][0].z == near(0.011, {.relative = 1e-12}));
    CHECK(goal.tolerance == near(2e-4, {.relative = 1e-12}));
    CHECK(goal.weight == near(3, {.relative = 1e-12}));
    CHECK(task->times == std::vector<double>{0.5, 1});
    REQUIRE(task->inputs.size() == 1);
    CHECK(task->inputs[0].low == near(0.8, {.relative = 1e-12}));
    CHECK(*task->inputs[0].rate == near(0.05, {.relative = 1e-12}));
    CHECK(task->inputs[0].effort_price == near(2, {.relative = 1e-12}));
}

TEST_CASE("a goal that is too far away for its direction to be told is refused") {
    const auto problem = [](const std::string& x) {
        const auto built =
            testing::build(parse_robot(robot_with_cable + reach + "point = [" + x + ", 5, 9]\n", "bar.toml"));
        const auto task = build_goals(built.robot, built.model);
        return task ? "" : task.error().message;
    };
    CHECK(problem("1e6").empty());
    CHECK(holds(problem("1e30"), "bar.toml: goal \"reach\": its point [1e+30, 5, 9] is over a million times"));
}

TEST_CASE("directions of huge and of tiny numbers are what they say") {
    const std::string turn = "[[goal]]\nname = \"turn\"\nmarkers = [\"middle\", \"tip\"]\ndirection = ";
    for (const char* numbers : {"[3e300, 4e300, 0]", "[3e-200, 4e-200, 0]", "[3, 4, 0]"}) {
        CAPTURE(numbers);
        const auto aim = parse_robot(robot_with_cable + turn + numbers + "\n", "bar.toml");
        REQUIRE_MESSAGE(aim, (aim ? "" : aim.error().message));
        CHECK(norm(aim->goals[0].wanted[0][0] - Vec3{0.6, 0.8, 0}) < 1e-9);
        const auto flat = parse_robot(
            robot_with_cable + reach + "plane = { point = [0, 0, 8], normal = " + numbers + " }\n", "bar.toml");
        REQUIRE_MESSAGE(flat, (flat ? "" : flat.error().message));
        CHECK(norm(flat->goals[0].wanted[0][1] - Vec3{0.6, 0.8, 0}) < 1e-9);
    }
    CHECK_FALSE(parse_robot(robot_with_cable + turn + "[0, 0, 0]\n", "bar.toml"));
}

TEST_CASE("a note tells of a tolerance that the file does not give and that is large for the robot") {
    const std::string point = reach + "point = [38, 5, 9]\n";
    const auto notes = [](const std::string& text) {
        const auto built = testing::build(parse_robot(text, "bar.toml"));
        return built.model.description().notes;
    };
    CHECK(notes(robot_with_cable + point).empty());
    // The same bar drawn in metres.
    const std::string small = R"(name = "bar"
length_unit = "m"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.4 }
body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [0.04, 0.01, 0.01]] } }]
mesh = { size = "6 mm", order = 1 }
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 0.01, 0.01]] }]
cable = [{ name = "flexor", points = [[0, 0.005, 0.008], [0.04, 0.005, 0.008]], range = [0.8, 1.0] }]
marker = [{ name = "tip", point = [0.04, 0.005, 0.005] }]
)";
    const std::string wanted = "goal = [{ name = \"reach\", marker = \"tip\", point = [0.038, 0.005, 0.009]";
    const auto found = notes(small + wanted + " }]\n");
    REQUIRE(found.size() == 1);
    CHECK(found[0] ==
          "goal \"reach\" has no tolerance, and the default, 0.1 length_unit, is 100 mm: 236 % of the robot's size. "
          "Everything nearer counts as reached; give one, as tolerance = \"0.04 mm\"");
    CHECK(notes(small + wanted + ", tolerance = \"100 mm\" }]\n").empty());
}

TEST_CASE("an actuator that moves by a ratio does not have the name of a column of the tables of results") {
    const auto named = [](const std::string& name, bool need_goals) {
        std::string text = robot_with_cable;
        text.replace(text.find("\"flexor\""), 8, "\"" + name + "\"");
        const auto built = testing::build(parse_robot(text + reach + "point = [38, 5, 9]\n", "bar.toml"));
        const auto task = build_goals(built.robot, built.model, need_goals);
        return task ? "" : task.error().message;
    };
    CHECK(holds(named("reached", true),
                "cable \"reached\": waypoints.csv has a column of this name already; give the cable another name"));
    CHECK(named("reached", false).empty());
    CHECK(named("found", true).empty());
    CHECK(holds(named("found", false), "workspace.csv has a column of this name already"));
}

TEST_CASE("a goal for what the model does not have, or a direction of markers at one place, is refused") {
    auto built = testing::build(parse_robot(robot_with_cable + reach + "point = [38, 5, 9]\n", "bar.toml"));
    built.robot.goals[0].markers = {"none"};
    const auto task = build_goals(built.robot, built.model);
    REQUIRE_FALSE(task);
    CHECK(holds(task.error().message, "goal \"reach\": the robot has no \"none\" that it could be for"));
    // Two boxes of the same nodes.
    const std::string ends =
        "[[marker]]\nname = \"end\"\nbox = [[39, -1, -1], [41, 11, 11]]\n"
        "[[marker]]\nname = \"face\"\nbox = [[39, -2, -2], [41, 12, 12]]\n"
        "[[goal]]\nname = \"turn\"\nmarkers = [\"end\", \"face\"]\ndirection = [0, 0, 1]\n";
    const auto flat = testing::build(parse_robot(robot_with_cable + ends, "bar.toml"));
    const auto turn = build_goals(flat.robot, flat.model);
    REQUIRE_FALSE(turn);
    CHECK(holds(turn.error().message, "markers \"end\" and \"face\" are at one point, which has no direction"));
    CHECK(build_goals(flat.robot, flat.model, false));
}

TEST_CASE("a path is read from a table, in the unit that its columns name") {
    const test::Folder folder("goals");
    std::ofstream(folder.path() / "path.csv") << "# drawn\ntime,x (cm),y (mm),z\n0.5,3.8,5,9\n1,3.7,5,11\n";
    const auto robot = parse_robot(robot_with_cable + reach + "path = \"path.csv\"\n", folder.path() / "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    REQUIRE(robot->goals[0].wanted.size() == 2);
    CHECK(robot->goals[0].wanted[0][0].x == near(38, {.relative = 1e-12}));
    CHECK(robot->goals[0].wanted[1][0].z == near(11, {.relative = 1e-12}));
    CHECK(robot->goals[0].times == std::vector<double>{0.5, 1});
    std::ofstream(folder.path() / "path.csv") << "x,y,z\n38,5,9\n37,,11\n";
    const auto hole = parse_robot(robot_with_cable + reach + "path = \"path.csv\"\n", folder.path() / "bar.toml");
    REQUIRE_FALSE(hole);
    CHECK(test::holds(hole.error().message, "path.csv:3"));
    CHECK(test::holds(hole.error().message, "bar.toml:"));
    std::ofstream(folder.path() / "path.csv") << "x,y\n38,5\n";
    const auto flat = parse_robot(robot_with_cable + reach + "path = \"path.csv\"\n", folder.path() / "bar.toml");
    REQUIRE_FALSE(flat);
    CHECK(test::holds(flat.error().message, "there is no column \"z\""));
}

TEST_CASE("a path's times have units, and columns that nothing would read or that stand twice are refused") {
    const test::Folder folder("goals");
    const auto read = [&](const std::string& csv) {
        std::ofstream(folder.path() / "path.csv") << csv;
        return parse_robot(robot_with_cable + reach + "path = \"path.csv\"\n", folder.path() / "bar.toml");
    };
    const auto milliseconds = read("time (ms),x,y,z,middle_x\n500,38,5,9,1\n1000,37,5,11,1\n");
    REQUIRE_MESSAGE(milliseconds, (milliseconds ? "" : milliseconds.error().message));
    REQUIRE(milliseconds->goals[0].times.size() == 2);
    CHECK(milliseconds->goals[0].times[0] == near(0.5, {.relative = 1e-12}));
    CHECK(milliseconds->goals[0].times[1] == near(1, {.relative = 1e-12}));
    const auto refused = [&](const std::string& columns, const std::string& why) {
        const auto robot = read("# drawn\n" + columns + "\n1,38,5,9\n");
        CAPTURE(columns);
        REQUIRE_FALSE(robot);
        CHECK_MESSAGE(test::holds(robot.error().message, "path.csv:2: " + why), robot.error().message);
    };
    refused("time (N),x,y,z", "column \"time (N)\": ");
    refused("time (ms,x,y,z", "column \"time (ms\": its brackets hold no unit");
    refused("x,x,y,z", "there are two columns \"x\"");
    refused("x (cm),x (mm),y,z", "there are two columns \"x\"");
    refused("tiem,x,y,z", "column \"tiem\" has no meaning in a path; did you mean \"time\"?");
    refused("x_mm,y_mm,z_mm,time", "column \"x_mm\" has no meaning in a path; did you mean \"x (mm)\"?");
    refused("effort,x,y,z", "column \"effort\" has no meaning in a path; possible are time, x, y, z, tip_x");
}

TEST_CASE("mistakes in goals and ranges are named, with their line") {
    check_problem(robot_with_cable + "[[goal]]\nname = \"a\"\nmarker = \"tipp\"\npoint = [1, 2, 3]\n",
                  "bar.toml:32: goal[0].marker: there is no marker \"tipp\"; there is \"tip\" and \"middle\"");
    check_problem(test::replaced(robot_with_cable, "[0.8, 1.0]", "[1.0, 0.8]"), "range: is empty");
    check_problem(test::replaced(robot_with_cable, "[0.8, 1.0]", "[0.8, 11]"), "range: is not possible");
    check_problem(test::replaced(robot_with_cable, "rate = 0.05", "rate = 0"), "rate: must be above zero");
    check_problem(test::replaced(robot_with_cable, "tension = 2", "tensoin = 2"), "tensoin");
    check_problem(test::replaced(robot_with_cable, "range = [0.8, 1.0]\n", ""), "belongs to an actuator with a range");
    const std::string unranged =
        test::replaced(robot_with_cable, "range = [0.8, 1.0]\nrate = 0.05\nprice = { tension = 2 }\n", "");
    check_problem(unranged + reach + "point = [38, 5, 9]\n", "no actuator may move for it");
    check_problem(robot_with_cable + reach, "has no target");
    check_problem(robot_with_cable + reach + "point = [1, 2, 3]\ntolerance = \"0 mm\"\n",
                  "tolerance: must be above zero");
    check_problem(robot_with_cable + reach +
                      "path = [[1, 2, 3], [2, 3, 4]]\n[[goal]]\nname = \"b\"\nmarker = \"middle\"\n" +
                      "path = [[1, 2, 3], [2, 3, 4], [3, 4, 5]]\n",
                  "they are reached together");
    check_problem(robot_with_cable + reach + "point = [1, 2, 3]\ntimes = [1, 0.5]\n", "in their order");
    check_problem(robot_with_cable + "[[goal]]\nname = \"a\"\nmarkers = [\"tip\"]\ndirection = [0, 0, 1]\n",
                  "from one marker to another");
    check_problem(
        robot_with_cable + "[[goal]]\nname = \"a\"\nobstacle = \"ball\"\nforce = \"1 N\"\ntolerance = \"0.1 N\"\n",
        "there is no obstacle \"ball\"");
}

TEST_CASE("a program of waypoints builds on the robot file and reaches its lengths") {
    const test::Folder folder("goals");
    const std::filesystem::path file = folder.path() / "bar.toml";
    std::ofstream(file) << robot_with_cable;
    const auto robot = load_robot(file, {"mesh.size=7 mm"});
    REQUIRE(robot);
    const auto text = program_text(*robot, file, {"mesh.size=7 mm"}, folder.path() / "out",
                                   {{1, {{"flexor", 0.97}}}, {1, {{"flexor", 0.95}}}}, 2, 1e-5);
    REQUIRE_MESSAGE(text, (text ? "" : text.error().message));
    std::filesystem::create_directory(folder.path() / "out");
    std::ofstream(folder.path() / "out" / "program.toml") << *text;
    const auto built = testing::build(load_robot(folder.path() / "out" / "program.toml"));
    CHECK(built.robot.name == "bar");
    CHECK(built.robot.mesh.size == near(7, {.relative = 1e-12}));
    CHECK(built.robot.program.steps == 4);
    CHECK(built.robot.program.tolerance == near(1e-5, {.relative = 1e-12}));
    const sim::Trajectory run = testing::run_to_the_end(built);
    CHECK(run.steps[2].cables[0].length_ratio == near(0.97, {.relative = 1e-4}));
    CHECK(run.steps[4].cables[0].length_ratio == near(0.95, {.relative = 1e-4}));
    std::ofstream(folder.path() / "out" / "program.toml") << *text << "\n[mesh]\nsize = \"3 mm\"\n";
    const auto more = load_robot(folder.path() / "out" / "program.toml");
    REQUIRE_FALSE(more);
    CHECK(test::holds(more.error().message, "mesh"));
}

TEST_CASE("a program of waypoints moves motors and sliders as the robot's own program does") {
    const test::Folder folder("goals_joints");
    const std::filesystem::path file = folder.path() / "arm.toml";
    const std::string arm = R"(
name = "arm"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, density = "1000 kg/m^3" }
body = [{ name = "post", material = "soft", geometry = { box = [[0, -40, 0], [10, -30, 10]] } }]
fixed = [{ name = "foot", box = [[0, -40, 0], [10, -30, 0]] }]
object = [{ name = "bar", geometry = { box = [[0, -5, -5], [100, 5, 5]] }, mass = "10 g" },
          { name = "car", geometry = { box = [[0, 40, 0], [10, 50, 10]] }, mass = "10 g" }]
joint = [{ name = "elbow", kind = "motor", between = ["world", "bar"], point = [0, 0, 0], axis = [0, 1, 0], torque = "4 N*mm" },
         { name = "rail", kind = "slider", between = ["world", "car"], point = [5, 45, 5], axis = [1, 0, 0], position = "3 mm" }]
[program]
key = [{ time = "0.5 s", elbow = "15 N mm", rail = "2 mm" }, { time = "1 s", elbow = "5 N mm" }]
)";
    std::ofstream(file) << arm;
    const auto robot = load_robot(file);
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    const auto text = program_text(*robot, file, {}, folder.path(), {{0.25, {}}, {1, {}}}, 1, 1e-5);
    REQUIRE_MESSAGE(text, (text ? "" : text.error().message));
    std::ofstream(folder.path() / "program.toml") << *text;
    const auto led = load_robot(folder.path() / "program.toml");
    REQUIRE_MESSAGE(led, (led ? "" : led.error().message));
    // Waypoint k is reached at k + 1 s.
    CHECK(led->joints[0].wanted->at(1) == near(7.5e-3, {.relative = 1e-12}));
    CHECK(led->joints[0].wanted->at(2) == near(5e-3, {.relative = 1e-12}));
    CHECK(led->joints[1].wanted->at(1) == near(1e-3, {.relative = 1e-12}));
}

TEST_CASE("times of goals are of their own robot file's program, and of no use without goals") {
    const test::Folder folder("goals_late");
    const std::string timed =
        robot_with_cable + "duration = \"10 s\"\n" + reach + "point = [38, 5, 9]\ntimes = [2, 10]\n";
    std::ofstream(folder.path() / "bar.toml") << timed;
    check_problem(test::replaced(timed, "10 s", "5 s"), "has a time of 10 s, and the program ends at 5 s");
    std::ofstream(folder.path() / "program.toml") << "robot = \"bar.toml\"\n[program]\nduration = \"2 s\"\n";
    const auto shorter = testing::build(load_robot(folder.path() / "program.toml"));
    const auto goals = build_goals(shorter.robot, shorter.model);
    REQUIRE_FALSE(goals);
    CHECK(
        holds(goals.error().message,
              "goal: \"reach\" has a time of 10 s, and the program ends at 2 s; goals have the times of the program in "
              "bar.toml, and the file that stands on it has another program; search with bar.toml itself"));
    // Earlier times are searched for, with a note, unless they are set for this program.
    const auto notes_with = [&](const std::string& program, const std::vector<std::string>& changes) {
        REQUIRE(write_file(folder.path() / "program.toml", "robot = \"bar.toml\"\n" + program));
        const auto read = load_robot(folder.path() / "program.toml", changes);
        REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
        return notes_on_times(*read);
    };
    const std::string longer = "[program]\nduration = \"12 s\"\n";
    REQUIRE(notes_with(longer, {}).size() == 1);
    CHECK(holds(notes_with(longer, {})[0], "the times of goal \"reach\" may mean something else here"));
    CHECK(notes_with(longer, {"goal.reach.times=[1, 2]"}).empty());
    CHECK(notes_with("set = [\"goal.reach.times=[1, 2]\"]\n" + longer, {}).empty());
    CHECK(notes_with("[program]\nsteps = 3\n", {}).empty());
    const auto inputs = build_goals(shorter.robot, shorter.model, false);
    REQUIRE(inputs);
    CHECK(inputs->times == std::vector<double>{2});
    CHECK_FALSE(inputs->timed);
    // Not the last of the times, but the end.
    const auto early = testing::build(parse_robot(test::replaced(timed, "[2, 10]", "[2, 5]"), "bar.toml"));
    CHECK(build_goals(early.robot, early.model)->times == std::vector<double>{2, 5});
    CHECK(build_goals(early.robot, early.model, false)->times == std::vector<double>{10});
}

TEST_CASE("names that a program could not tell apart are known before there is one") {
    const std::string load =
        "[[load]]\nname = \"flexor\"\nbox = [[40, 0, 0], [40, 10, 10]]\nforce = [\"0 N\", \"0 N\", \"1 N\"]\n";
    const auto robot = parse_robot(robot_with_cable + load, "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    const Status status = check_program_names(*robot, "bar.toml", {"flexor"}, {1});
    REQUIRE_FALSE(status);
    CHECK(holds(status.error().message, "bar.toml: two things are named \"flexor\""));
    const auto other = parse_robot(robot_with_cable + test::replaced(load, "flexor", "weight"), "bar.toml");
    REQUIRE(other);
    CHECK(check_program_names(*other, "bar.toml", {"flexor"}, {1}));
}
