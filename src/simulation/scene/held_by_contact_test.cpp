// Robots and objects held only by contact and friction, from the robot file on: a grip that does not creep, several
// robots in one scene, and the motions that an equilibrium leaves free.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "base/core/near.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using robot::testing::g;
using robot::testing::run_text;

namespace {

/// Bodies of soft rubber on a ground.
std::string on_ground(const std::string& bodies, double friction, const std::string& program) {
    return fmt::format(R"(
name = "held"
length_unit = "mm"
[material.rubber]
youngs_modulus = "0.2 MPa"
poisson_ratio = 0.4
density = "1000 kg/m^3"
{}
[mesh]
size = "10 mm"
order = 1
[contact]
distance = "0.1 mm"
[[obstacle]]
name = "ground"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
friction = {}
[program]
{}
)",
                       bodies, friction, program);
}
std::string cube_at(const std::string& name, double x_mm, double z_mm) {
    return fmt::format(
        "[[body]]\nname = \"{0}\"\nmaterial = \"rubber\"\ngeometry = {{ box = [[{1}, 0, {2}], [{3}, 20, {4}]] }}\n"
        "[[marker]]\nname = \"{0}\"\npoint = [{5}, 10, {6}]\n",
        name, x_mm, z_mm, x_mm + 20, z_mm + 20, x_mm + 10, z_mm + 10);
}
const std::string still = "steps = 4\ngravity = [0, 0, -9.81]\n";

/// The warning that begins so, or "".
std::string warning(const sim::Trajectory& result, const std::string& begins) {
    const auto found = std::ranges::find_if(result.warnings, [&](const auto& w) { return w.starts_with(begins); });
    return found == result.warnings.end() ? "" : *found;
}
const std::string open_places = "at the end the equilibrium leaves open";

}  // namespace

TEST_CASE("a cube of 100 g held by three fingers creeps by less than 0.1 mm in 10 s") {
    const sim::Trajectory t = run_text(R"(
name = "grip"
length_unit = "mm"
material.rubber = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
body = [{ name = "one", material = "rubber", geometry = { box = [[-24, -9, -4], [-10.3, -1, 4]] } },
        { name = "two", material = "rubber", geometry = { box = [[-24, 1, -4], [-10.3, 9, 4]] } },
        { name = "thumb", material = "rubber", geometry = { box = [[10.3, -4, -4], [24, 4, 4]] } }]
mesh = { size = "5 mm", order = 1 }
fixed = [{ name = "left", plane = { point = [-24, 0, 0], normal = [1, 0, 0] }, move = [1.3, 0, 0] },
         { name = "right", plane = { point = [24, 0, 0], normal = [1, 0, 0] }, move = [-1.3, 0, 0] }]
contact = { distance = "0.2 mm" }
obstacle = [{ name = "table", plane = { point = [0, 0, -10], normal = [0, 0, 1] }, friction = 0.3, move = [0, 0, -5] }]
object = [{ name = "cube", geometry = { box = [[-10, -10, -10], [10, 10, 10]] }, mass = "100 g", friction = 0.5 }]
[program]
duration = "10.8 s"
time_step = "0.05 s"
stiffness_damping = 0.002
gravity = [0, 0, -9.81]
key = [{ time = "0.3 s", left = 1, right = 1, table = 0 }, { time = "0.6 s", table = 1 }]
)");
    const auto height = [&](std::size_t k) { return t.steps[k].objects[0].position_m.z; };
    MESSAGE("sunk by ", 1e3 * height(16), " mm when the table had gone, and by ", 1e6 * (height(16) - height(216)),
            " um in the 10 s after that");
    CHECK(t.steps.size() == 217);
    CHECK(norm(t.steps[216].contacts[0].force_N) == 0);
    CHECK(t.steps[216].objects[0].force_N.z == near(0.1 * g, {.relative = 1e-3}));
    CHECK(height(16) > -1e-3);  // in the grip
    CHECK(std::abs(height(216) - height(16)) < 0.1e-3);
}

TEST_CASE("several robots in one scene stand separately, and one that stands on another is carried by it") {
    const sim::Trajectory beside = run_text(on_ground(cube_at("left", 0, 0) + cube_at("right", 30, 0), 0.5, still));
    const sim::Step& end = beside.steps.back();
    CHECK(end.contacts[0].force_N.z == near(16e-3 * g, {.relative = 1e-3}));
    CHECK(end.self_contact_N == 0);
    CHECK(end.markers[1].position_m.x - end.markers[0].position_m.x == near(30e-3, {.absolute = 1e-6}));
    CHECK(end.markers[0].position_m.z == near(end.markers[1].position_m.z, {.absolute = 1e-6}));

    const sim::Trajectory stacked =
        run_text(on_ground(cube_at("lower", 0, 0) + cube_at("upper", 0, 20.5), 0.5,
                           "duration = \"0.6 s\"\ntime_step = \"0.01 s\"\nmass_damping = 5\n"
                           "stiffness_damping = 0.002\ngravity = [0, 0, -9.81]\n"));
    const sim::Step& last = stacked.steps.back();
    CHECK(last.contacts[0].force_N.z == near(16e-3 * g, {.relative = 0.01}));
    CHECK(last.self_contact_N == near(8e-3 * g, {.relative = 0.02}));  // the weight that the lower one carries
    CHECK(last.markers[1].position_m.z == near(30e-3, {.absolute = 0.5e-3}));
    CHECK(last.smallest_distance_m > -0.1e-3);  // the ground is inset by less than the contact distance
}

TEST_CASE("a block that is pushed without friction stays with what pushes it, also in fine steps") {
    for (const int steps : {48, 96}) {
        CAPTURE(steps);
        const sim::Trajectory t = run_text(fmt::format(R"(
name = "pushed"
length_unit = "mm"
material.rubber = {{ youngs_modulus = "0.1 MPa", poisson_ratio = 0.3, density = "1000 kg/m^3" }}
body = [{{ name = "block", material = "rubber", geometry = {{ box = [[0, 0, 0], [20, 20, 10]] }} }}]
marker = [{{ name = "middle", point = [10, 10, 5] }}]
mesh = {{ size = "10 mm", order = 1 }}
contact.distance = "0.1 mm"
[[obstacle]]
name = "floor"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[[obstacle]]
name = "pusher"
geometry = {{ box = [[-11, -5, 2], [-1, 25, 8]] }}
move = [6, 0, 0]
[program]
gravity = [0, 0, -9.81]
steps = {}
)",
                                                       steps));
        REQUIRE(t.converged);
        CHECK(t.steps.back().markers[0].position_m.x == near(15.0e-3, {.absolute = 0.05e-3}));
        for (const std::string& w : t.warnings) CHECK_MESSAGE(w.find("jumps") == std::string::npos, w);
    }
}

TEST_CASE("motions not held by contact, friction and gravity are named in one line; none if all are held") {
    const auto open = [&](double friction, const std::string& more = "") {
        return warning(run_text(on_ground(cube_at("cube", 0, 0) + more, friction, still)), open_places);
    };
    CHECK(open(0.5) == "");
    const std::string smooth = open(0);
    CHECK_MESSAGE(smooth.ends_with("the piece of \"cube\" can slide in 2 directions and turn or roll in 1 way"),
                  smooth);
    CHECK(smooth.find('\n') == std::string::npos);
    // An object on the same smooth ground is as free, and one that has nothing under it falls as far as the tether
    // lets.
    const std::string both = open(0, R"(
[[object]]
name = "block"
geometry = { box = [[40, 0, 0], [60, 20, 8]] }
mass = "5 g"
)");
    CHECK_MESSAGE(
        both.find("\"cube\" can slide in 2 directions and turn or roll in 1 way, object \"block\" can slide in "
                  "2 directions and turn or roll in 1 way") != std::string::npos,
        both);
    // A spring to a fixed point takes one direction.
    const std::string tied = open(0, R"(
[[spring]]
name = "tie"
points = [[-30, 10, 10], [10, 10, 10]]
anchor = "first"
stiffness = "0.1 N/mm"
)");
    CHECK_MESSAGE(tied.find("can slide in 1 direction") != std::string::npos, tied);
}

namespace {

/// An object in free space; a body far away, since a robot needs one.
std::string floating_object(const std::string& box, const std::string& density, const std::string& rest) {
    return fmt::format(R"(
name = "free"
length_unit = "mm"
material.rubber = {{ youngs_modulus = "1 MPa", poisson_ratio = 0.45, density = "1000 kg/m^3" }}
body = [{{ name = "anchor", material = "rubber", geometry = {{ box = [[-200, -200, 200], [-190, -190, 210]] }} }}]
mesh = {{ size = "10 mm", order = 1 }}
fixed = [{{ name = "clamp", box = [[-200, -200, 200], [-190, -190, 210]] }}]
object = [{{ name = "thing", geometry = {{ box = {} }}, density = "{} kg/m^3" }}]
{}
)",
                       box, density, rest);
}
const std::string water = "fluid = { density = \"1000 kg/m^3\", level = 0 }\n";
const std::string deep_water = "fluid = { density = \"1000 kg/m^3\" }\n";
const std::string still_program = "[program]\nsteps = 4\ngravity = [0, 0, -9.81]\n";

sim::Trajectory run_to_where_it_stops(const std::string& text) {
    return robot::testing::run(robot::testing::build_text(text));
}

bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

bool any_says(const sim::Trajectory& result, std::string_view part) {
    return std::ranges::any_of(result.warnings, [&](const std::string& w) { return has(w, part); });
}

}  // namespace

TEST_CASE("what falls, sinks or rises without end has no equilibrium: the program stops and says so") {
    const std::string cube = "[[0, 0, 0], [10, 10, 10]]";
    for (const auto& [density, fluid] :
         {std::pair{"10000", std::string()}, std::pair{"1500", deep_water}, std::pair{"500", deep_water}}) {
        CAPTURE(density);
        const sim::Trajectory t = run_to_where_it_stops(floating_object(cube, density, fluid + still_program));
        CHECK_FALSE(t.converged);
        CHECK_MESSAGE(has(t.message, "nothing carries object \"thing\""), t.message);
        CHECK(t.steps.size() == 1);
    }
    const sim::Trajectory in_balance = run_to_where_it_stops(floating_object(cube, "1000", deep_water + still_program));
    CHECK_MESSAGE(in_balance.converged, in_balance.message);
    const sim::Trajectory weightless = run_to_where_it_stops(floating_object(cube, "1000", "[program]\nsteps = 4\n"));
    CHECK_MESSAGE(weightless.converged, weightless.message);
}

TEST_CASE("what falls far and is caught has an equilibrium: a floor carries its weight, water floats it") {
    const std::string floor =
        "contact = { distance = \"0.1 mm\" }\n"
        "obstacle = [{ name = \"floor\", plane = { point = [0, 0, 0], normal = [0, 0, 1] }, friction = 0.5 }]\n";
    // The robot is a cube of 10 mm: the tether takes 2 % of the weight over these heights.
    const std::string high = "[[0, 0, 400], [20, 20, 410]]";
    for (const int steps : {1, 4}) {
        CAPTURE(steps);
        const std::string program = fmt::format("[program]\nsteps = {}\ngravity = [0, 0, -9.81]\n", steps);
        const auto lands = run_text(floating_object(high, "1000", floor + program));
        CHECK(lands.steps.back().objects[0].position_m.z == near(5e-3, {.absolute = 0.2e-3}));
        const double tether = steps == 1 ? 0.03 : 1e-3;
        CHECK(lands.steps.back().objects[0].force_N.z == near(4e-3 * g, {.relative = tether}));
        const auto floats = run_text(floating_object(high, "500", water + program));
        CHECK(floats.steps.back().objects[0].position_m.z == near(0, {.absolute = 1e-3}));
    }
    const auto misses =
        run_to_where_it_stops(floating_object(high, "1000", "[program]\nsteps = 1\ngravity = [0, 0, -9.81]\n"));
    CHECK_MESSAGE(has(misses.message, "nothing carries object \"thing\""), misses.message);
}

TEST_CASE("a flat box floats upright and stable in any number of steps, a tall one does not") {
    // Metacentric height over the centre of mass: I / V - (h - draught) / 2, with I / V = w^2 / (12 draught).
    for (const int steps : {1, 2, 3, 4, 8}) {
        CAPTURE(steps);
        const std::string program = fmt::format("{}[program]\nsteps = {}\ngravity = [0, 0, -9.81]\n", water, steps);
        const auto flat = run_text(floating_object("[[-20, -20, -5], [20, 20, 15]]", "600", program));  // 7 mm
        CHECK(flat.steps.back().objects[0].position_m.z == near(-2e-3, {.absolute = 0.1e-3}));
        CHECK_FALSE(any_says(flat, "unstable"));
        CHECK(any_says(flat, "can slide in 2 directions and turn or roll in 1 way"));
        const auto tall = run_text(floating_object("[[-5, -5, -20], [5, 5, 40]]", "600", program));  // -12 mm
        // It stays in balance on its end, or tips over to where it is stable: either is told.
        const bool stands = any_says(tall, "from step 1 on the equilibrium is unstable");
        CHECK(stands != any_says(tall, "at step 1 the robot jumps"));
        CHECK(tall.steps.back().objects[0].position_m.z == near(stands ? -6e-3 : -0.75e-3, {.absolute = 0.01e-3}));
    }
}

TEST_CASE("a pendulum that stands on its hinge is unstable, one that hangs is not") {
    const std::string hinge =
        "joint = [{ name = \"j\", kind = \"hinge\", between = [\"world\", \"thing\"], point = [0, 0, 0], axis = [0, 1, "
        "0] }]\n";
    CHECK(any_says(run_text(floating_object("[[-5, -5, 0], [5, 5, 50]]", "2000", hinge + still_program)), "unstable"));
    CHECK(run_text(floating_object("[[-5, -5, -50], [5, 5, 0]]", "2000", hinge + still_program)).warnings.empty());
}

TEST_CASE("an object that a motor drives into an obstacle is named as squeezed") {
    const std::string arm = R"(
joint = [{ name = "m", kind = "motor", between = ["world", "thing"], point = [0, 0, 0], axis = [0, 0, 1], angle = "90 deg" }]
contact = { distance = "0.5 mm" }
obstacle = [{ name = "peg", geometry = { box = [[35, Y, -20], [45, 30, 20]] } }]
[program]
duration = "0.2 s"
time_step = "5 ms"
)";
    const std::string box = "[[0, -3, -3], [60, 3, 3]]",
                      squeezed = "object \"thing\", which should be rigid, is deformed";
    const auto with = [&](const std::string& y, const std::string& angle) {
        std::string text = arm;
        text.replace(text.find('Y'), 1, y);
        text.replace(text.find("90 deg"), 6, angle);
        return run_to_where_it_stops(floating_object(box, "9000", text));
    };
    CHECK(any_says(with("20", "90 deg"), squeezed));
    CHECK_FALSE(any_says(with("20", "10 deg"), squeezed));  // it does not reach the peg
}

TEST_CASE("where an impact stops a motion in time, the message says what touches what and what helps") {
    const std::string impact = R"(
contact = { distance = "0.2 mm" }
obstacle = [{ name = "wall", geometry = { box = [[30, -43, -51], [40, 77, 66]] } }]
[program]
duration = "10 ms"
time_step = "1 ms"
)";
    std::string text = floating_object("[[0, 0, 0], [20, 20, 20]]", "625000", impact);
    text.replace(text.find("name = \"thing\""), 14, "name = \"thing\", velocity = [3, 0, 0]");
    const sim::Trajectory soft = run_to_where_it_stops(text);
    if (!soft.converged) {  // 100 kPa over 0.2 mm cannot stop 5 kg at 3 m/s
        const bool told = has(soft.message, "object \"thing\" touches obstacle \"wall\"") ||
                          has(soft.message, "object \"thing\" is about to touch obstacle \"wall\"");
        CHECK_MESSAGE(told, soft.message);
        CHECK_MESSAGE(has(soft.message, "contact.stiffness"), soft.message);
    }
    text.replace(text.find("distance = \"0.2 mm\""), 19, "distance = \"0.2 mm\", stiffness = \"10 MPa\"");
    const sim::Trajectory stiff = run_to_where_it_stops(text);
    CHECK_MESSAGE(stiff.converged, stiff.message);
}
