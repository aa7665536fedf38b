// The public interface: values that can be copied, kept and compared, and errors with a location.
#include "pliant/simulation.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <utility>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "library/simulation/test_bar.hpp"
#include "pliant/program.hpp"

using namespace pliant;
using test::bar;

namespace {

const char* const sagging = "program = { duration = \"1 s\", time_step = \"10 ms\", gravity = [0, 0, -9.81] }\n";

Inputs pulled(const State& state, double shortening_m) {
    Inputs inputs = state.inputs();
    inputs.cables[0].value -= shortening_m;
    return inputs;
}

double tip_mm(const Stepper& stepper, const State& state) {
    return 1e3 * stepper.observe(state).markers[0].position_m[2];
}

}  // namespace

TEST_CASE("a model reports its nodes, tets, names and surface") {
    const Model model(bar());
    CHECK(model.order() == 1);
    CHECK(model.tets().size() == 4 * model.tet_count());
    CHECK(model.rest_positions().size() == model.node_count());
    CHECK(model.regions().size() == model.tet_count());
    CHECK(model.cables() == std::vector<std::string>{"flexor"});
    CHECK(model.markers() == std::vector<std::string>{"tip"});
    CHECK(model.chambers().empty());
    double volume = 0;  // of the closed surface, by the divergence theorem
    const std::vector<Point> points = model.rest_positions();
    for (const auto& t : model.surface()) {
        const Point &a = points[static_cast<std::size_t>(t[0])], &b = points[static_cast<std::size_t>(t[1])],
                    &c = points[static_cast<std::size_t>(t[2])];
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                   a[2] * (b[0] * c[1] - b[1] * c[0])) /
                  6;
    }
    CHECK(volume == near(6e-6, {.relative = 1e-9}));
}

TEST_CASE("coordinates() is the positions without a copy, valid as long as any copy of the state") {
    std::optional<Model> model(bar());
    Stepper stepper(*model);
    State state = stepper.rest();
    const State rest = state;
    const std::span<const double> before = state.coordinates();
    REQUIRE(before.size() == 3 * model->node_count());
    const std::vector<Point> points = rest.positions();
    for (std::size_t n = 0; n < points.size(); ++n)
        for (std::size_t k = 0; k < 3; ++k) CHECK(before[3 * n + k] == points[n][k]);
    (void)stepper.step(state, pulled(state, 0.002));
    CHECK(before.data() == rest.coordinates().data());
    CHECK(before.data() != state.coordinates().data());
    const Model copy = *model;
    const std::span<const double> at_rest = model->rest_coordinates();
    model.reset();
    CHECK(at_rest.data() == copy.rest_coordinates().data());
    CHECK(at_rest[0] == copy.rest_positions()[0][0]);
}

TEST_CASE("the path of a cable has the cable's length") {
    const Model model(bar());
    Stepper stepper(model);
    State state = stepper.rest();
    (void)stepper.step(state, pulled(state, 0.002));
    const auto paths = stepper.cable_paths(state);
    REQUIRE(paths.size() == 1);
    REQUIRE(paths[0].size() == 3);
    double length = 0;
    for (std::size_t p = 1; p < 3; ++p)
        length += std::hypot(paths[0][p][0] - paths[0][p - 1][0], paths[0][p][1] - paths[0][p - 1][1],
                             paths[0][p][2] - paths[0][p - 1][2]);
    CHECK(length == near(stepper.observe(state).cables[0].length_m, {.relative = 1e-12}));
}

TEST_CASE("sensor readings are in SI units, with their names") {
    const Model model(bar(R"(
        [[sensor]]
        name = "pull"
        kind = "tension"
        cable = "flexor"
        [[sensor]]
        name = "line"
        kind = "strain"
        points = [[5, 5, 1], [55, 5, 1]]
    )"));
    Stepper stepper(model);
    State state = stepper.rest();
    (void)stepper.step(state, pulled(state, 0.002));
    const Observation seen = stepper.observe(state);
    REQUIRE(seen.sensors.size() == 2);
    CHECK(seen.sensors[0].name == "pull");
    CHECK(seen.sensors[0].readings[0].name == "tension");
    CHECK(seen.sensors[0].readings[0].unit == "N");
    CHECK(seen.sensors[0].readings[0].value == seen.cables[0].tension_N);
    CHECK(seen.sensors[1].readings[1].unit == "m");
    CHECK(seen.sensors[1].readings[1].value ==
          near(0.05 * (1 + seen.sensors[1].readings[0].value), {.relative = 1e-9}));
}

TEST_CASE("a quantity needs a unit that fits") {
    CHECK(quantity("4 mm", "m") == near(0.004, {.relative = 1e-15}));
    CHECK(quantity("20 kPa", "Pa") == near(2e4, {.relative = 1e-15}));
    CHECK(quantity("2 ml", "m^3") == near(2e-6, {.relative = 1e-15}));
    CHECK_THROWS_WITH_AS((void)quantity("4", "m"), "\"4\" has no unit; write a length such as \"2.5 mm\"", Failure);
    CHECK_THROWS_WITH_AS((void)quantity("4 mm", "J"),
                         "there is no unit \"J\" here; write m, s, N, Pa, m^3, kg/m^3 or N/m", Failure);
}

TEST_CASE("a step in time as long as the file's time_step is one, also where the program's divide its duration") {
    // 143 steps of 6.993 ms, and 3 of 0.333 s
    for (const auto& [step_s, duration] : {std::pair{0.007, "1 s"}, {0.3, "1 s"}, {0.005, "1 s"}}) {
        const Model model(
            bar(fmt::format("program = {{ duration = \"{}\", time_step = \"{} s\" }}\n", duration, step_s)));
        Stepper stepper(model);
        State state = stepper.rest();
        for (int k = 0; k < 20; ++k) {
            Inputs inputs = state.inputs();
            inputs.time += step_s;
            CHECK(stepper.step(state, inputs).pieces == 1);
        }
        Inputs inputs = state.inputs();
        inputs.time += 2 * step_s;
        CHECK(stepper.step(state, inputs).pieces == 2);
    }
}

TEST_CASE("a mesh made by a program takes the place of a file") {
    const std::string memory_block = R"(
        name = "block"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.3 }
        mesh = { file = "memory:", order = 1 }
        body = [{ name = "block", material = "soft", region = "all" }]
        fixed = [{ name = "bottom", box = [[0, 0, 0], [10, 10, 0]] }]
        load = [{ name = "push", box = [[0, 0, 10], [10, 10, 10]], force = ["0 N", "0 N", "-0.1 N"] }]
        marker = [{ name = "top", point = [5, 5, 10] }]
    )";
    const Robot robot = Robot::parse(memory_block);
    Mesh cube;  // of 10 mm, in six tets around a diagonal, with an unused point
    for (int k = 0; k < 8; ++k) cube.points.push_back({0.01 * (k & 1), 0.01 * (k >> 1 & 1), 0.01 * (k >> 2)});
    cube.points.push_back({1, 1, 1});
    cube.tets = {0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
    const Model model(robot, cube);
    CHECK(model.node_count() == 8);
    CHECK(model.tet_count() == 6);
    Stepper stepper(model);
    State state = stepper.rest();
    CHECK(stepper.step(state, stepper.program(1)).arrived);
    CHECK(stepper.observe(state).supports[0].force_N[2] == near(0.1, {.relative = 1e-3}));
    CHECK(stepper.observe(state).markers[0].position_m[2] < 0.01);

    const Model quadratic(Robot::parse(memory_block, {}, {"mesh.order=2"}), cube);
    Mesh of_ten;  // the same cube: `order = 1` takes its corners
    of_ten.nodes_per_tet = 10;
    of_ten.tets.assign(quadratic.tets().begin(), quadratic.tets().end());
    const std::span<const double> at = quadratic.rest_coordinates();
    for (std::size_t n = 0; n < at.size(); n += 3) of_ten.points.push_back({at[n], at[n + 1], at[n + 2]});
    REQUIRE(of_ten.points.size() == 27);
    const Model corners(robot, of_ten);
    CHECK(corners.order() == 1);
    CHECK(std::ranges::equal(corners.tets(), model.tets()));
    CHECK(std::ranges::equal(corners.rest_coordinates(), model.rest_coordinates()));
    CHECK(Model(Robot::parse(memory_block, {}, {"mesh.order=2"}), of_ten).node_count() == 27);

    const auto problem = [&](const Mesh& mesh) -> std::string {
        try {
            (void)Model(robot, mesh);
        } catch (const Failure& failure) {
            return failure.what();
        }
        return "";
    };
    Mesh wrong = cube;
    wrong.tets.back() = 9;
    CHECK(problem(wrong) == "the mesh: a tetrahedron names point 9, there are 9");
    wrong.tets.pop_back();
    CHECK(problem(wrong) == "the mesh: 23 node numbers are no multiple of 4");
    wrong = cube;
    wrong.points[0][1] = NAN;
    CHECK(problem(wrong) == "the mesh: point 0 is not finite");
    wrong = cube;
    wrong.regions = {0, 0, 0, 0, 0, 1};
    CHECK(problem(wrong) == "the mesh: a tetrahedron is in region 1 of 1");
    CHECK(problem({}) == "the mesh: holds no tetrahedra");
    wrong = cube;
    wrong.regions.assign(6, 0);
    wrong.region_names = {"all", "other", "all"};
    CHECK(problem(wrong) == "the mesh: two regions are named \"all\"; each needs a name of its own");
    wrong = cube;
    for (const double x : {0.1, 0.2, 0.3, 0.4}) {  // flat, and attached to nothing
        wrong.tets.push_back(static_cast<int>(wrong.points.size()));
        wrong.points.push_back({x, x * x, 0});
    }
    CHECK(problem(wrong) == "tetrahedron 6 of the mesh is flat or inside out at rest (volume 0 m^3)");
    CHECK_THROWS_WITH_AS((void)Model(robot), doctest::Contains("can only be given by a program"), Failure);
    CHECK_THROWS_WITH_AS((void)Model(bar(), cube), doctest::Contains("the bodies are drawn"), Failure);
}

TEST_CASE("single steps to the program's end and run() reach the same state") {
    const Model model(bar());
    Stepper stepper(model, {.tolerance = 1e-8});
    State state = stepper.rest();
    for (int k = 1; k <= 4; ++k) CHECK(stepper.step(state, stepper.program(0.25 * k)).arrived);
    std::vector<ProgramStep> steps;
    const ProgramResult result = run(model, {.on_step = [&](const ProgramStep& step) { steps.push_back(step); }});
    CHECK(result.converged());
    REQUIRE(steps.size() == 31);
    CHECK(steps.front().index == 0);
    const Observation seen = stepper.observe(state), last = steps.back().observed;
    CHECK(seen.cables[0].length_m == near(0.056, {.relative = 1e-5}));
    CHECK(seen.cables[0].tension_N == near(last.cables[0].tension_N, {.relative = 1e-3}));
    CHECK(seen.markers[0].position_m[2] == near(last.markers[0].position_m[2], {.relative = 1e-3}));
    CHECK(seen.supports.size() == 1);
}

TEST_CASE("a state is a value: copies, bytes and other steppers continue with the same bits") {
    const Model model(bar());
    Stepper stepper(model);
    State state = stepper.rest();
    for (int k = 0; k < 3; ++k) stepper.step(state, pulled(state, 0.001));
    const State kept = state;
    CHECK(kept == state);
    const Inputs more = pulled(state, 0.001);
    stepper.step(state, more);
    CHECK_FALSE(kept == state);
    State aside = stepper.rest();
    stepper.step(aside, pulled(aside, 0.01));  // another solve in between
    State again = kept;
    stepper.step(again, more);
    CHECK(again == state);
    Stepper other(model);
    State from_bytes = other.state_from(kept.bytes());
    CHECK(from_bytes == kept);
    other.step(from_bytes, more);
    CHECK(from_bytes == state);
    const test::Folder folder;
    kept.save(folder / "bar.state");
    CHECK(other.load(folder / "bar.state") == kept);
}

TEST_CASE("what was moved from keeps its value") {
    Robot robot = bar();
    const Robot taken = std::move(robot);
    CHECK(robot.name() == "bar");
    Model model(robot);
    const Model moved = std::move(model);
    CHECK(model.node_count() == moved.node_count());
    Stepper stepper(model);
    State state = stepper.rest();
    State other = std::move(state);
    CHECK((state == other));
    CHECK(state.coordinates().size() == 3 * moved.node_count());
    (void)stepper.step(state, pulled(other, 0.001));
    CHECK_FALSE((state == other));
    other = std::move(state);
    CHECK((state == other));
    static_assert(std::is_nothrow_move_constructible_v<State> && std::is_nothrow_move_assignable_v<State>);
}

TEST_CASE("a state of a motion in time is told apart from one without") {
    const Model still(bar());
    const Model moving(bar("program = { duration = \"1 s\", time_step = \"10 ms\" }\n"));
    const Stepper one(still), other(moving);
    CHECK_THROWS_WITH_AS((void)other.state_from(one.rest().bytes()),
                         "a state of a robot without program.time_step, and this one has it", Failure);
    CHECK_THROWS_WITH_AS((void)one.state_from(other.rest().bytes()),
                         "a state of a robot with program.time_step, and this one has none", Failure);
}

TEST_CASE("a cable pulled and released, by length or by tension, returns to the same state") {
    const Model model(bar());
    Stepper stepper(model, {.tolerance = 1e-9});
    State state = stepper.rest();
    const double flat = tip_mm(stepper, state);
    stepper.step(state, pulled(state, 0.003));
    const double bent = tip_mm(stepper, state);
    const double tension = stepper.observe(state).cables[0].tension_N;
    CHECK(bent - flat > 5);
    Inputs inputs = state.inputs();
    inputs.cables[0] = {Drive::By::tension, tension / 2};
    CHECK(stepper.step(state, inputs).arrived);
    CHECK(stepper.observe(state).cables[0].tension_N == near(tension / 2, {.relative = 1e-6}));
    inputs.cables[0] = {Drive::By::tension, tension};
    stepper.step(state, inputs);
    CHECK(tip_mm(stepper, state) == near(bent, {.relative = 1e-6}));
    inputs.cables[0] = {Drive::By::length, 0.06};
    stepper.step(state, inputs);
    CHECK(tip_mm(stepper, state) == near(flat, {.relative = 1e-6}));
}

TEST_CASE("in dynamics a released bar swings, and a step back in time is refused") {
    const Model model(bar("program = { duration = \"0.2 s\", time_step = \"10 ms\", gravity = [0, 0, -9.81] }\n"));
    Stepper stepper(model);
    State state = stepper.rest();
    Inputs inputs = state.inputs();
    for (int k = 1; k <= 5; ++k) {
        inputs.time = 0.002 * k;
        CHECK(stepper.step(state, inputs).arrived);
    }
    double fastest = 0;
    for (const Point& v : state.velocities()) fastest = std::max(fastest, std::fabs(v[2]));
    CHECK(fastest > 1e-4);
    CHECK(stepper.observe(state).kinetic_energy_J > 0);
    inputs.time = 0.008;
    CHECK_THROWS_WITH_AS(stepper.step(state, inputs), "a step in time from 0.01 s to 0.008 s does not lead on",
                         Failure);
}

TEST_CASE("a step in time that is as short as rounding changes nothing, and drives cannot jump in it") {
    const Model model(bar(sagging));
    Stepper stepper(model);
    State state = stepper.rest();
    Inputs inputs = state.inputs();
    inputs.time = 0.3;
    REQUIRE(stepper.step(state, inputs).arrived);
    const State there = state;
    for (const double time : {0.1 + 0.2, 0.3, std::nextafter(0.3, 0)}) {
        CAPTURE(time);
        inputs.time = time;
        const StepResult result = stepper.step(state, inputs);
        CHECK(result.arrived);
        CHECK(result.pieces == 0);
        CHECK((state == there));
    }
    inputs.time = 0.1 + 0.2;
    inputs.cables[0].value -= 1e-3;
    CHECK_THROWS_WITH_AS(stepper.step(state, inputs),
                         "the inputs change, but a step in time from 0.3 s to 0.30000000000000004 s does not lead on",
                         Failure);
    CHECK((state == there));
    inputs = there.inputs();
    inputs.time = 0.299999999;  // more than rounding of a time step of 10 ms
    CHECK_THROWS_WITH_AS(stepper.step(state, inputs), "a step in time from 0.3 s to 0.299999999 s does not lead on",
                         Failure);
    inputs.time = 0.31;
    CHECK(stepper.step(state, inputs).arrived);
    double moved = 0;
    const std::vector<Point> now = state.positions(), before = there.positions(), velocities = there.velocities();
    for (std::size_t n = 0; n < now.size(); ++n)
        moved = std::max(moved, std::fabs(now[n][2] - before[n][2] - 0.01 * velocities[n][2]));
    CHECK(moved < 1e-3);  // by its velocity, and at most gravity during 10 ms
}

TEST_CASE("a step tells the share of its time steps that is done") {
    const Model model(bar(sagging));
    Stepper stepper(model);
    State state = stepper.rest();
    Inputs inputs = state.inputs();
    inputs.time = 0.1;
    std::vector<double> shares;
    const Watch watch = [&](std::string_view stage, double share) {
        CHECK(stage == "step");
        if (shares.empty() || shares.back() != share) shares.push_back(share);
        return true;
    };
    REQUIRE(stepper.step(state, inputs, watch).arrived);
    REQUIRE(shares.size() == 11);
    for (std::size_t k = 0; k < shares.size(); ++k)
        CHECK(shares[k] == near(0.1 * static_cast<double>(k), {.absolute = 1e-9}));
}

TEST_CASE("a stepper that is at work refuses a second use: in its own watch, or on another thread") {
    const Model model(bar());
    Stepper stepper(model);
    State state = stepper.rest();
    State other = state;
    const Inputs inputs = pulled(state, 0.003);
    const auto tried = [&] {
        try {
            (void)stepper.step(other, inputs);
        } catch (const Failure& failure) {
            return std::string(failure.what());
        }
        return std::string();
    };
    constexpr const char* refused = "the stepper is at work";
    bool asked = false;
    const Watch watch = [&](std::string_view, double) {
        if (asked) return true;
        asked = true;
        CHECK(tried().find(refused) == 0);
        CHECK_THROWS_WITH_AS((void)stepper.observe(other), doctest::Contains(refused), Failure);
        CHECK_THROWS_WITH_AS((void)stepper.rest(), doctest::Contains(refused), Failure);
        CHECK_THROWS_WITH_AS((void)stepper.program(1), doctest::Contains(refused), Failure);
        std::string elsewhere;
        std::thread([&] { elsewhere = tried(); }).join();
        CHECK(elsewhere.find(refused) == 0);
        Stepper another(model);
        CHECK((another.rest() == other));
        return true;
    };
    CHECK(stepper.step(state, inputs, watch).arrived);
    CHECK(asked);
    // Free again, also after an exception; and the result is that of an undisturbed step.
    const Watch throws = [](std::string_view, double) -> bool { throw std::logic_error("mine"); };
    State third = stepper.rest();
    CHECK_THROWS_AS(stepper.step(third, inputs, throws), std::logic_error);
    CHECK(stepper.step(other, inputs).arrived);
    CHECK((other == state));
}

TEST_CASE("errors are thrown with their kind, line and key") {
    try {
        (void)bar("materail.soft = {}\n");
        FAIL("a misspelt key passed");
    } catch (const Failure& failure) {
        CHECK(failure.kind() == Failure::Kind::input);
        CHECK(failure.line() == 10);
        CHECK(failure.key() == "materail");
        CHECK(std::string(failure.what()).find("did you mean") != std::string::npos);
    }
    const Model model(bar());
    Stepper stepper(model);
    State state = stepper.rest();
    const auto message = [&](const Inputs& inputs) -> std::string {
        try {
            stepper.step(state, inputs);
        } catch (const Failure& failure) {
            return failure.what();
        }
        return "";
    };
    CHECK(message({}) == "the inputs drive 0 cables and 0 chambers; the robot has 1 and 0");
    CHECK(message({0, {{Drive::By::volume, 1}}, {}}) == "cable \"flexor\": is driven by length or tension");
    CHECK(message({0, {{Drive::By::length, NAN}}, {}}) == "cable \"flexor\": driven by a number that is not finite");
    CHECK(message({0, {{Drive::By::tension, -1}}, {}}) ==
          "cable \"flexor\": a tension of -1 N is not possible: it must not be negative");
    CHECK(message({0, {{Drive::By::length, 0}}, {}}) ==
          "cable \"flexor\": a length of 0 m is not possible: it must be above 0; a shortening in metres is less than "
          "the "
          "cable's length");
    CHECK_THROWS_WITH_AS((void)stepper.state_from("nothing"), doctest::Contains("not a state that Pliant has written"),
                         Failure);
    const Model other(bar());
    Stepper elsewhere(other);
    CHECK_THROWS_WITH_AS((void)elsewhere.observe(state), "the state is one of another model", Failure);
    CHECK_THROWS_AS(Stepper(model, {.tolerance = 0.0}), Failure);
}

TEST_CASE("the text of a robot has its changes and names its files from another folder") {
    const test::Folder folder;
    std::filesystem::create_directories(folder / "parts");
    test::write(folder / "parts/tet.off",
                "OFF\n4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
    test::write(folder / "parts/tet.toml", R"(
        name = "tet"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45 }
        mesh = { order = 1, size = "5 mm" }
        body = [{ name = "tet", material = "soft", geometry = "tet.off" }]
        fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 9, 9]] }]
    )");
    const Robot robot = Robot::load(folder / "parts/tet.toml", {"mesh.size=2 mm"});
    test::write(folder / "again.toml", robot.text(folder.path()));
    const Robot again = Robot::load(folder / "again.toml");
    CHECK(again.name() == "tet");
    CHECK(Model(again).node_count() == Model(robot).node_count());
}

TEST_CASE("a watch can cancel the work, and its exceptions are passed on") {
    const Model model(bar());
    Stepper stepper(model);
    State state = stepper.rest();
    try {
        stepper.step(state, pulled(state, 0.003), [](std::string_view, double) { return false; });
        FAIL("it was not cancelled");
    } catch (const Failure& failure) {
        CHECK(failure.kind() == Failure::Kind::cancelled);
    }
    CHECK_THROWS_AS(stepper.step(state, pulled(state, 0.003),
                                 [](std::string_view, double) -> bool { throw std::logic_error("mine"); }),
                    std::logic_error);
    CHECK(stepper.step(state, pulled(state, 0.003)).arrived);
}
