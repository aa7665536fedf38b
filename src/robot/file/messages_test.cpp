// Robot files with one mistake: one message, at the key, that the value does not satisfy.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "robot/file/robot_file.hpp"

using namespace pliant;
using namespace pliant::robot;

namespace {

const std::string head = "name = \"bar\"\nlength_unit = \"mm\"\n";
const std::string body =
    "[[body]]\nname = \"bar\"\nmaterial = \"soft\"\ngeometry = { box = [[0, 0, 0], [40, 10, 10]] }\n"
    "[[fixed]]\nname = \"clamp\"\nbox = [[0, 0, 0], [0, 10, 10]]\n";
const std::string neo = "[material.soft]\nyoungs_modulus = \"1 MPa\"\n";
const std::string blend = "[material.soft]\nlaw = \"shape-blend\"\nyoungs_modulus = \"12 MPa\"\n";
const std::string cable = "[[cable]]\nname = \"flexor\"\npoints = [[0, 5, 8], [40, 5, 8]]\n";
const std::string marker = "[[marker]]\nname = \"tip\"\npoint = [40, 5, 5]\n";

std::string message(const std::string& text) {
    const Result<Robot> robot = parse_robot(text, "bar.toml");
    return robot ? "" : robot.error().message;
}

/// Of a robot with this material and these tables.
std::string problem(const std::string& material, const std::string& tables) {
    return message(head + material + body + tables);
}

/// The only message, without file and line.
std::string only(const std::string& material, const std::string& tables = "") {
    const std::string text = problem(material, tables);
    CHECK_MESSAGE(text.find('\n') == std::string::npos, text);
    const std::size_t at = text.find(": ");
    return at == std::string::npos ? text : text.substr(at + 2);
}

Robot robot_with(const std::string& tables) {
    Result<Robot> robot = parse_robot(head + neo + body + tables, "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    return std::move(*robot);
}

}  // namespace

TEST_CASE("a value that cannot be read gives one message") {
    const std::string curve = "stiffest = \"45 MPa\"\nshape_parameter = \"calibrated\"\n";
    CHECK(only(blend + curve) == "material.soft: \"shape_curve\" is missing; it is a list of numbers");
    CHECK(only("[material.soft]\nlaw = \"ogden\"\nmu = [\"1 MPa\", \"2 MPa\"]\nalpha = [1.3]\n") ==
          "material.soft.mu: has 2 values and alpha 1; as many of each, 1 to 6");
    CHECK(only("[material.soft]\nlaw = \"ogden\"\nmu = [\"1 MPa\", \"2 mm\"]\nalpha = [1, 2]\n").find("unknown unit") !=
          std::string::npos);
    CHECK(only("[material.soft]\nlaw = \"ogden\"\nmu = [\"1 MPa\"]\nalpha = \"2\"\n") ==
          "material.soft.alpha: needs a list of finite numbers");
    CHECK(only("[material.soft]\nlaw = \"mooney-rivlin\"\nc10 = \"-1 kPa\"\nc01 = 1\n") ==
          "material.soft.c01: 1 has no unit; write a pressure such as \"12 MPa\"");
    CHECK(only("[material.soft]\nlaw = \"shape-blend\"\nyoungs_modulus = 12\nstiffest = \"45 MPa\"\n"
               "shape_parameter = \"thesis\"\n") ==
          "material.soft.youngs_modulus: 12 has no unit; write a pressure such as \"12 MPa\"");
    CHECK(only("[material.soft]\nlaw = \"neohooke\"\nc10 = \"1 MPa\"\n").starts_with("material.soft.law: "));
    CHECK(only(blend + "poisson_ratio = 0.5\nshape_parameter = 7\n").starts_with("material.soft.poisson_ratio: "));
    CHECK(only(neo, "[[spring]]\nname = \"s\"\npoints = [[0, 5, 5], [40, 5, 5]]\nstiffness = \"1 kN/m\"\n")
              .starts_with("spring[0].stiffness: unknown unit"));
    CHECK(only(neo, "[[mass]]\nname = \"m\"\npoint = [1, 1, 1]\nmass = \"1 mg\"\n")
              .starts_with("mass[0].mass: unknown unit"));
    CHECK(only(neo, "[program]\ntime_step = \"10 ms\"\ntime_tolerance = 0.01\n")
              .starts_with("program.time_tolerance: 0.01 has no unit"));
    CHECK(
        only(neo, "[program]\ntime_step = \"10 s\"\nduration = 20\n").starts_with("program.duration: 20 has no unit"));
    CHECK(only(neo, cable + "target = { tension = \"1 N\" }\nrange = [0.7, 1]\n")
              .starts_with("cable[0].range: entry 1 has no unit"));
    CHECK(only(neo, cable + "target = { length_ratio = 0.9 }\n[[program.key]]\ntime = \"1 s\"\nflexor = \"0.9\"\n") ==
          "program.key[0].flexor: is \"0.9\", a finite number is needed");
    CHECK(only(neo, "[[chamber]]\nname = \"air\"\ninside = [5, 5, 5]\ntarget = { gas_ratio = \"2\" }\n") ==
          "chamber[0].target.gas_ratio: is \"2\", a finite number is needed");
    CHECK(only(neo, "[[chamber]]\nname = \"air\"\ninside = [5, 5, 5]\ntarget = { gas_ratio = \"2 kPa\" }\n") ==
          "chamber[0].target.gas_ratio: is \"2 kPa\", a finite number is needed, without a unit");
    CHECK(
        only(neo, "[[mass]]\nname = \"m\"\npoint = [\"1 mm\", 1, 1]\nmass = \"1 g\"\n").starts_with("mass[0].point: "));
}

TEST_CASE("a key that belongs to another kind of joint is not called unknown, and an unknown kind judges none") {
    const std::string joint = "[[joint]]\nname = \"j\"\nbetween = [\"bar\", \"world\"]\npoint = [0, 5, 5]\n";
    CHECK(only(neo, joint + "kind = \"ball\"\nlimits = [-10, 10]\n") ==
          "joint[0].limits: are those of a hinge, motor or slider");
    CHECK(only(neo, joint + "kind = \"hinch\"\naxis = [0, 0, 1]\n").starts_with("joint[0].kind: "));
    const std::string hinge = joint + "kind = \"hinge\"\naxis = [0, 0, 1]\n";
    const std::string slides = ": is that of a slider; a driven hinge (kind = \"motor\") takes angle or torque";
    CHECK(only(neo, hinge + "force = \"1 N\"\n") == "joint[0].force" + slides);
    CHECK(only(neo, hinge + "position = \"1 mm\"\n") == "joint[0].position" + slides);
    CHECK(only(neo, hinge + "angle = \"3 deg\"\n") ==
          "joint[0].angle: is that of a motor: kind = \"motor\" is a hinge that is driven");
}

TEST_CASE("a joint's radius is that of a body's material, and of no effect between rigid things") {
    const std::string object =
        "[[object]]\nname = \"ball\"\ngeometry = { sphere = { center = [0, 0, 50], radius = 5 } }\nmass = \"1 g\"\n";
    const auto joint = [&](const std::string& first, const std::string& second) {
        return object + "[[joint]]\nname = \"j\"\nkind = \"ball\"\nbetween = [\"" + first + "\", \"" + second +
               "\"]\npoint = [0, 0, 50]\nradius = \"1 mm\"\n";
    };
    CHECK(only(neo, joint("ball", "world")) ==
          "joint[0].radius: is that of the material of a body; neither \"ball\" nor \"world\" is one");
    CHECK(only(neo, joint("ball", "bar")).empty());
    CHECK(only(neo, joint("ball", "wrold")).starts_with("joint[0].between: there is no body, plate or object"));
}

TEST_CASE("an empty name is the name of nothing") {
    const std::string ranged = cable + "range = [0.8, 1]\n" + marker + "[[goal]]\nname = \"reach\"\n";
    const std::string none = ": there is no marker \"\"; there is \"tip\"";
    CHECK(only(neo, ranged + "marker = \"\"\npoint = [38, 5, 9]\n") == "goal[0].marker" + none);
    CHECK(only(neo, ranged + "markers = [\"\"]\npoint = [38, 5, 9]\n") == "goal[0].markers" + none);
    CHECK(only(neo, ranged + "marker = 3\npoint = [38, 5, 9]\n") == "goal[0].marker: is 3, a text in quotes is needed");
    const std::string tolerance = "tolerance = \"0.1 N\"\n";
    CHECK(only(neo, ranged + "obstacle = \"\"\nforce = \"1 N\"\n" + tolerance)
              .starts_with("goal[0].obstacle: there is no obstacle \"\""));
    CHECK(only(neo, ranged + "support = \"\"\nforce = [\"0 N\", \"0 N\", \"1 N\"]\n" + tolerance) ==
          "goal[0].support: there is no fixed \"\"; there is \"clamp\"");
    CHECK(only("[material.soft]\nbase = \"\"\ndensity = \"1 g/cm^3\"\n").starts_with("material.soft.base: "));
}

TEST_CASE("two markers at one point have no direction") {
    const std::string both = cable + "range = [0.8, 1]\n" + marker;
    const auto goal = [](const std::string& point) {
        return "[[marker]]\nname = \"t2\"\npoint = " + point +
               "\n[[goal]]\nname = \"turn\"\nmarkers = [\"tip\", \"t2\"]\ndirection = [0, 0, 1]\n";
    };
    CHECK(only(neo, both + goal("[40, 5, 5]")) ==
          "goal[0].markers: \"tip\" and \"t2\" are at one point, which has no direction");
    CHECK(only(neo, both + goal("[40, 5, 6]")).empty());
    CHECK(only(neo, both + goal("[40, 5]")).starts_with("marker[1].point: "));
}

TEST_CASE("a key for what does not move is refused; a motion of zero is one") {
    const std::string key = "[[program.key]]\ntime = \"1 s\"\n", later = "[[program.key]]\ntime = \"2 s\"\n";
    const std::string floor = "[[obstacle]]\nname = \"floor\"\nplane = { point = [0, 0, -1], normal = [0, 0, 1] }\n";
    const std::string program = "[program]\ngravity = [0, 0, 0]\n";
    CHECK(only(neo, key + "gravity = 2\n" + later + "gravity = 1\n") ==
          "program.key[0].gravity: the robot has no program.gravity; add it");
    CHECK(only(neo, key + "clamp = 1\n") ==
          "program.key[0].clamp: this [[fixed]] has neither move nor rotate; add one of them");
    CHECK(only(neo, floor + key + "floor = 1\n") == "program.key[0].floor: this [[obstacle]] has no move; add it");
    CHECK(only(neo, program + key + "gravity = 2\n").empty());
    CHECK(only(neo, floor + "move = [0, 0, 0]\n" + key + "floor = 1\n").empty());
}

TEST_CASE("what depends on something that cannot be read is not judged") {
    const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n') + 1; };
    const std::string driven = cable +
                               "target = { shortning = \"4 mm\", offset = \"1 N\" }\nrange = [\"0 mm\", \"5 mm\"]\n"
                               "rate = \"1 mm\"\n" +
                               marker + "[[goal]]\nname = \"reach\"\nmarker = \"tip\"\npoint = [38, 5, 9]\n";
    const std::string keys = "[[program.key]]\ntime = \"1 s\"\nflexor = \"4 mm\"\n";
    const std::string cables = problem(neo, driven + keys);
    CHECK_MESSAGE(lines(cables) == 2, cables);
    CHECK(cables.find("cable[0].target: takes one of") != std::string::npos);
    CHECK(cables.find("cable[0].target.shortning: unknown key; did you mean \"shortening\"?") != std::string::npos);
    const std::string chambers = problem(neo,
                                         "[[chamber]]\nname = \"air\"\ninside = [5, 5, 5]\n"
                                         "target = { presure = \"2 kPa\" }\nrange = [\"0 kPa\", \"5 kPa\"]\n"
                                         "[[program.key]]\ntime = \"1 s\"\nair = \"1 kPa\"\n");
    CHECK_MESSAGE(lines(chambers) == 2, chambers);
    const std::string ranged =
        cable + "range = [0.8, 1]\n" + marker + "[[goal]]\nname = \"reach\"\nmarker = \"tip\"\ntimes = [0.5, 1]\n";
    CHECK(only(neo, ranged + "path = \"none.csv\"\n") == "goal[0].path: there is no file none.csv");
    CHECK(only(neo, ranged + "path = \"/\"\n") == "goal[0].path: / is a folder, a file is needed");
    CHECK(only(neo, ranged + "path = \"/dev/null\"\n") == "goal[0].path: /dev/null is not a regular file");
    CHECK(only(neo, ranged + "path = []\n") == "goal[0].path: holds no point");
    CHECK(only(neo, "[fluid]\ndensity = \"1 g/cm^3\"\nlevel = 0\n[program]\ngravity = 9.81\n") ==
          "program.gravity: needs three finite numbers [x, y, z]");
}

TEST_CASE("constants of another law are told whose they are") {
    CHECK(only(neo + "bulk_modulus = \"1 GPa\"\n") ==
          "material.soft.bulk_modulus: is a constant of mooney-rivlin, yeoh and ogden; the law here is neo-hookean");
    CHECK(only(neo + "stiffest = \"45 MPa\"\n") ==
          "material.soft.stiffest: is a constant of shape-blend; the law here is neo-hookean");
    CHECK(only("[material.soft]\nlaw = \"yeoh\"\nc10 = \"1 MPa\"\nc01 = \"1 MPa\"\n") ==
          "material.soft.c01: is a constant of mooney-rivlin; the law here is yeoh");
}

TEST_CASE("a Poisson ratio is allowed beside any shape parameter, also one by name, from which it follows") {
    const std::string by_name = blend + "stiffest = \"45 MPa\"\nshape_parameter = \"thesis\"\n";
    CHECK(only(by_name).empty());
    CHECK(only(by_name + "poisson_ratio = 0.3\n").empty());
    CHECK(only(blend + "shape_parameter = 7\npoisson_ratio = 0.3\n").empty());
}

TEST_CASE("a body has a region or a geometry, and the advice does not contradict itself") {
    const std::string text = problem(neo,
                                     "[[body]]\nname = \"two\"\nmaterial = \"soft\"\nregion = \"all\"\n"
                                     "geometry = { box = [[40, 0, 0], [50, 10, 10]] }\n");
    CHECK(text ==
          "bar.toml:15: body[1].region: stands beside geometry; region is for a body of a mesh file ([mesh] "
          "file = \"...\"), geometry for any other");
}

TEST_CASE("messages say the limit that the value exceeds") {
    const std::string target = "target = { length_ratio = 0.9 }\n";
    CHECK(only(neo, cable + target + "friction = 10.1\n").find("10.1 is not possible; a coefficient from 0 to 10") !=
          std::string::npos);
    CHECK(only(neo, "[contact]\nfriction = 20\n").find("20 is not possible; a coefficient from 0 to 10") !=
          std::string::npos);
    const std::string plane = "plane = { point = [0, 0, -1], normal = [0, 0, 1] }\n";
    CHECK(only(neo, "[[obstacle]]\nname = \"floor\"\n" + plane + "friction = 11\n").find("11 is not possible") !=
          std::string::npos);
    CHECK(only(neo, "[fluid]\ndensity = \"1 g/cm^3\"\ndrag_normal = 1000.1\n").find("from 0 to 1000,") !=
          std::string::npos);
    CHECK(only(neo, "[mesh]\npoint_reach = \"-1 mm\"\n").find("\"0 mm\" still allows a thousandth") !=
          std::string::npos);
}

TEST_CASE("a time step that does not divide the duration is rounded, with a note; one beyond it is refused") {
    const auto program = [](const std::string& step, const std::string& duration) {
        return "[program]\ntime_step = \"" + step + "\"\nduration = \"" + duration + "\"\n";
    };
    const Robot whole = robot_with(program("0.1 s", "0.3 s"));  // 0.3 / 0.1 is not quite 3
    CHECK(whole.program.steps == 3);
    CHECK(whole.notes.empty());
    const Robot rounded = robot_with(program("0.3 s", "1 s"));
    CHECK(rounded.program.steps == 3);
    CHECK(rounded.notes == std::vector<std::string>{"program.time_step is 0.333333 s instead of 0.3 s, so that 3 steps "
                                                    "fill the duration of 1 s"});
    CHECK(robot_with(program("1 s", "1 s")).program.steps == 1);
    CHECK(robot_with(program("0.001 ms", "1 s")).program.steps == 1000000);
    CHECK(only(neo, program("2 s", "1 s")) == "program.time_step: is longer than the duration, 1 s");
    CHECK(only(neo, program("0.001 ms", "2 s")) ==
          "program.time_step: makes 2e+06 steps in 2 s; at most 1000000 are possible");
    CHECK(only(neo, program("0 s", "1 s")) == "program.time_step: must be above zero");
}

TEST_CASE("a goal has a time for every waypoint, none after the end of the program") {
    const std::string ranged = cable + "range = [0.8, 1]\n" + marker + "[[goal]]\nname = \"reach\"\nmarker = \"tip\"\n";
    const std::string path = "path = [[38, 5, 9], [37, 5, 11]]\n";
    CHECK(only(neo, ranged + path + "times = [0.5, 1]\n").empty());
    CHECK(only(neo, ranged + "point = [38, 5, 9]\ntimes = [0.5, 1]\n").empty());  // held there
    CHECK(only(neo, ranged + path + "times = [0.5]\n") == "goal[0].times: gives 1 time for 2 waypoints");
    CHECK(only(neo, ranged + path + "times = [0.5, 3]\n") ==
          "goal: \"reach\" has a time of 3 s, and the program ends at 1 s; give program.duration");
    CHECK(only(neo, ranged + path + "times = [0.5, 3]\n[program]\nduration = \"3 s\"\n").empty());
}

TEST_CASE("what only a motion in time knows is refused without time_step, as damping is") {
    const std::string object =
        "[[object]]\nname = \"ball\"\ngeometry = { sphere = { center = [0, 0, 50], radius = 5 } }\nmass = \"1 g\"\n";
    const std::string hinge =
        "[[joint]]\nname = \"j\"\nkind = \"hinge\"\nbetween = [\"bar\", \"world\"]\npoint = [0, 5, 5]\naxis = [0, 0, "
        "1]\n";
    const std::string fluid = "[fluid]\ndensity = \"1 g/cm^3\"\n";
    const std::string moves = "[program]\ntime_step = \"10 ms\"\n", why = ": has no meaning without program.time_step";
    CHECK(only(neo, object + "velocity = [0, 0, 1]\n") == "object[0].velocity" + why);
    CHECK(only(neo, object + "angular_velocity = [0, 0, 1]\n") == "object[0].angular_velocity" + why);
    CHECK(only(neo, hinge + "damping = 0.01\n") == "joint[0].damping" + why);
    CHECK(only(neo, fluid + "drag_normal = 1\n") == "fluid.drag_normal" + why);
    CHECK(only(neo, fluid + "drag_tangential = 1\n") == "fluid.drag_tangential" + why);
    CHECK(only(neo, fluid + "current = [1, 0, 0]\n") == "fluid.current" + why);
    CHECK(only(neo, object + "velocity = [0, 0, 1]\nangular_velocity = [0, 0, 1]\n" + moves).empty());
    CHECK(only(neo, hinge + "damping = 0.01\n" + moves).empty());
    CHECK(only(neo, fluid + "drag_normal = 1\ncurrent = [1, 0, 0]\n" + moves).empty());
    CHECK(only(neo, object + "velocity = [0, 0, 0]\n" + fluid + "drag_normal = 0\n").empty());
}

TEST_CASE("a support cannot move its nodes where it does not hold them") {
    const std::string end = "[[fixed]]\nname = \"end\"\nplane = { point = [40, 0, 0], normal = [1, 0, 0] }\n";
    CHECK(only(neo, end + "directions = [\"x\"]\nmove = [0, 0, 3]\n")
              .starts_with("fixed[1].move: moves the nodes by (0, 0, 3) across"));
    CHECK(only(neo, end + "directions = \"normal\"\nmove = [1, 2, 0]\n")
              .starts_with("fixed[1].move: moves the nodes by (0, 2, 0) across"));
    CHECK(only(neo, end + "directions = \"normal\"\nmove = [1, 0, 0]\n").empty());
    CHECK(only(neo, end + "directions = [[1, 1, 0], [0, 1, 0]]\nmove = [1, 2, 0]\n").empty());
    CHECK(only(neo, end + "move = [0, 0, 3]\n").empty());
}

TEST_CASE("names that are blank, or that of the key of a time, are refused") {
    CHECK(only(neo, "[[marker]]\nname = \"\"\npoint = [1, 1, 1]\n") == "marker[0].name: is blank; a name is required");
    CHECK(only(neo, "[[marker]]\nname = \" \"\npoint = [1, 1, 1]\n") == "marker[0].name: is blank; a name is required");
    CHECK(message("name = \"\"\nlength_unit = \"mm\"\n" + neo + body) ==
          "bar.toml:1: name: is blank; a name is required");
    const std::string load = "[[load]]\nname = \"time\"\npoint = [40, 5, 5]\nforce = [\"1 N\", \"0 N\", \"0 N\"]\n";
    CHECK(only(neo, load + "[[program.key]]\ntime = \"1 s\"\n")
              .starts_with("program.key[0].time: says when the key holds"));
    CHECK(only(neo, load).empty());
}

TEST_CASE("names with line breaks or other control characters are refused, once") {
    const std::string refusal = "must have no line breaks or other control characters";
    CHECK(only(neo, "[[marker]]\nname = \"a\\nb\"\npoint = [1, 1, 1]\n") == "marker[0].name: " + refusal);
    CHECK(message("name = \"bar\\u001b[2J\"\nlength_unit = \"mm\"\n" + neo + body) == "bar.toml:1: name: " + refusal);
    const std::string soft = "[material.\"so\\nft\"]\nyoungs_modulus = \"1 MPa\"\n";
    CHECK(only(neo + soft) == "material.so ft: " + refusal);
}

TEST_CASE("a base robot is found through a folder that is a link, and named without detours otherwise") {
    namespace fs = std::filesystem;
    const pliant::test::Folder folder("linked");
    fs::create_directories(folder / "real" / "sub");
    fs::create_directory_symlink(folder / "real" / "sub", folder / "link");
    REQUIRE(write_file(folder / "real" / "robot.toml", head + neo + body));
    REQUIRE(write_file(folder / "real" / "sub" / "changed.toml", "robot = \"../robot.toml\"\nset = [\"name=7\"]\n"));
    for (const std::string sub : {"real/sub", "link"}) {
        const Result<Robot> robot = load_robot(folder / sub / "changed.toml");
        REQUIRE_FALSE(robot);
        const std::string shown = (sub == "link" ? folder / "link" / ".." : folder / "real").string();
        CHECK(robot.error().message.starts_with(shown + "/robot.toml"));
    }
}

TEST_CASE("a table where a list of tables belongs is the only thing told") {
    const std::string text = head + neo + body;
    CHECK(message(test::replaced(text, "[[body]]", "[body]")) ==
          "bar.toml:5: body: is a table; write [[body]] for each");
    CHECK(message(test::replaced(text, "[[fixed]]", "[fixed]")) ==
          "bar.toml:9: fixed: is a table; write [[fixed]] for each");
}

TEST_CASE("gravity in mm/s^2 and a density a thousand times too large get a note") {
    CHECK(robot_with("[program]\ngravity = [0, 0, -98.1]\n").notes.empty());
    CHECK(robot_with("[program]\ngravity = [0, 0, -9810]\n").notes ==
          std::vector<std::string>{"program.gravity is 9810 m/s^2, 1000 times that of the earth; it is in m/s^2, "
                                   "whatever length_unit is"});
    const Result<Robot> dense = parse_robot(head + neo + "density = \"1040 g/cm^3\"\n" + body, "bar.toml");
    REQUIRE(dense);
    CHECK(dense->notes == std::vector<std::string>{"material \"soft\" has 1.04e+06 kg/m^3, more than any substance "
                                                   "on earth"});
}

TEST_CASE("a body that blends into its own material gets a note") {
    const auto notes = [](const std::string& other) {
        const Result<Robot> robot = parse_robot(
            head + neo + "[material.firm]\nyoungs_modulus = \"2 MPa\"\n" + body +
                "[[body]]\nname = \"tip\"\nmaterial = \"soft\"\ngeometry = { box = [[40, 0, 0], [50, 10, 10]] }\n"
                "blend = { material = \"" +
                other + "\", from = [40, 0, 0], to = [50, 0, 0] }\n",
            "bar.toml");
        REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
        return robot->notes;
    };
    CHECK(notes("firm").empty());
    CHECK(notes("soft") ==
          std::vector<std::string>{"body \"tip\" blends into its own material \"soft\", which changes nothing"});
}
