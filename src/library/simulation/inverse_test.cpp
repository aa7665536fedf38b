// Goals, workspaces and gradients of programs through the public interface.
#include "pliant/inverse.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "library/simulation/test_bar.hpp"
#include "pliant/program.hpp"
#include "pliant/workspace.hpp"

using namespace pliant;
using test::bar;
namespace fs = std::filesystem;

namespace {

/// A bar whose tip has a goal and whose cable may be shortened by up to 8 mm.
std::string with_goal_text(const std::string& wanted) {
    return test::bar_text("goal = [{ name = \"reach\", marker = \"tip\", " + wanted + " }]\n");
}

Robot with_goal(const std::string& wanted, const std::vector<std::string>& changes = {}) {
    return Robot::parse(with_goal_text(wanted), {}, changes);
}

const char* const reachable = "plane = { point = [0, 0, 8], normal = [0, 0, 1] }, tolerance = \"0.01 mm\"";
const char* const too_high = "plane = { point = [0, 0, 80], normal = [0, 0, 1] }, tolerance = \"0.01 mm\"";

}  // namespace

TEST_CASE("a goal is reached, and a step with the inputs that were found leads there") {
    const Model model(with_goal(reachable));
    const InverseResult result = inverse(model);
    REQUIRE(result.reached());
    CHECK(result.message().empty());
    REQUIRE(result.inputs().size() == 1);
    CHECK(result.inputs()[0].name == "flexor");
    CHECK(result.inputs()[0].unit == "m");
    CHECK(result.inputs()[0].high == near(0.008, {.relative = 1e-12}));
    CHECK(result.waypoints_wanted() == 1);
    REQUIRE(result.waypoint_count() == 1);
    const Waypoint at = result.waypoint(0);
    CHECK(at.reached);
    CHECK(at.limits.empty());
    REQUIRE(at.goals.size() == 1);
    CHECK(at.goals[0].unit == "m");
    CHECK(at.goals[0].error < 1e-5);
    CHECK(at.forward_solutions > 0);
    CHECK(at.positions.size() == model.node_count());
    CHECK(at.observed.markers[0].position_m[2] == near(0.008, {.absolute = 1e-5}));
    Stepper stepper(model);
    State state = stepper.rest();
    Inputs inputs = stepper.program(at.time);
    inputs.cables[0] = {Drive::By::length, 0.06 - at.inputs[0]};
    REQUIRE(stepper.step(state, inputs).arrived);
    CHECK(stepper.observe(state).markers[0].position_m[2] == near(0.008, {.absolute = 2e-5}));
    const Inputs found = result.inputs_at(0);
    CHECK(found.time == at.time);
    REQUIRE(found.cables.size() == 1);
    CHECK(found.cables[0].by == Drive::By::length);
    CHECK(found.cables[0].value == near(inputs.cables[0].value, {.relative = 1e-12}));
    State again = stepper.rest();
    REQUIRE(stepper.step(again, found).arrived);
    CHECK(stepper.observe(again).markers[0].position_m[2] ==
          near(at.observed.markers[0].position_m[2], {.absolute = 2e-5}));
    CHECK_THROWS_WITH_AS((void)result.waypoint(1), "there is no waypoint 1; there are 1", Failure);
    CHECK_THROWS_WITH_AS((void)result.inputs_at(1), "there is no waypoint 1; there are 1", Failure);
}

TEST_CASE("an unreachable goal ends at the nearest point and names the limit") {
    const InverseResult result = inverse(Model(with_goal(too_high)));
    CHECK_FALSE(result.reached());
    REQUIRE(result.waypoint_count() == 1);
    const Waypoint at = result.waypoint(0);
    CHECK_FALSE(at.reached);
    CHECK(at.inputs[0] == near(0.008, {.relative = 1e-9}));
    REQUIRE(at.limits.size() == 1);
    CHECK(at.limits[0] == "flexor is at the upper end of its range");
    CHECK(result.text().find("waypoint 1 of 1: not reached") != std::string::npos);
    CHECK(result.json().find("\"reached\": false") != std::string::npos);
}

TEST_CASE("a goal beside all that the actuators do says so") {
    const Model model(with_goal(reachable));
    Stepper stepper(model);
    State state = stepper.rest();
    Inputs inputs = stepper.program(1);
    inputs.cables[0] = {Drive::By::length, 0.056};
    REQUIRE(stepper.step(state, inputs).arrived);
    const Point tip = stepper.observe(state).markers[0].position_m;
    const std::string beside = fmt::format("point = [{}, {}, {}]", 1e3 * tip[0], 1e3 * tip[1] + 10, 1e3 * tip[2]);
    const InverseResult result = inverse(Model(with_goal(beside)));
    CHECK_FALSE(result.reached());
    CHECK(result.waypoint(0).limits == std::vector<std::string>{"no small change of the inputs brings it nearer"});
}

TEST_CASE("a robot without a goal, an impossible number of starts and a cancelled search throw") {
    CHECK_THROWS_AS((void)inverse(Model(bar())), Failure);
    for (const int starts : {-1, 2000000000})
        CHECK_THROWS_WITH_AS((void)inverse(Model(with_goal(reachable)), {.starts = starts}),
                             doctest::Contains("starts are not possible; 0 to 100000 are"), Failure);
    const Model model(with_goal(reachable));
    CHECK_THROWS_AS((void)inverse(model, {}, [](std::string_view, double) { return false; }), Failure);
}

TEST_CASE("the results of a robot given as text include its robot file, and the program runs again") {
    const test::Folder folder;
    const InverseResult result = inverse(Model(with_goal(reachable)));
    CHECK(result.write(folder / "out").empty());
    for (const char* file : {"program.toml", "robot.toml", "inverse.json", "waypoints.csv", "summary.json"})
        CHECK_MESSAGE(fs::exists(folder / "out" / file), file);
    const ProgramResult again = run(Model(Robot::load(folder / "out/program.toml")));
    REQUIRE(again.converged());
    CHECK(again.step(again.step_count() - 1).observed.markers[0].position_m[2] == near(0.008, {.absolute = 2e-5}));
    CHECK_THROWS_AS((void)result.write(folder / "none", [](std::string_view, double) { return false; }), Failure);
    CHECK_FALSE(fs::exists(folder / "none"));
}

TEST_CASE("the program of a cancelled search leads through the waypoints that were finished") {
    const Model model(
        bar("goal = [{ name = \"reach\", marker = \"tip\", tolerance = \"1 mm\", "
            "path = [[60, 5, 5], [59, 5, 8], [57, 5, 12]] }]\n"));
    const InverseResult result = inverse(model, {}, [](std::string_view, double share) { return share < 0.3; });
    CHECK_FALSE(result.reached());
    CHECK(result.message() == "cancelled at waypoint 2 of 3");
    REQUIRE(result.waypoint_count() == 2);
    CHECK(result.waypoint(0).reached);
    CHECK(result.waypoint(1).limits == std::vector<std::string>{"the search was cancelled here"});
    CHECK(result.text().ends_with("\n  the search was cancelled here\n"));
    const test::Folder folder;
    (void)result.write(folder / "out", {}, [] { return true; });
    CHECK_FALSE(fs::exists(folder / "out/pictures"));
    const std::string program = read_file(folder / "out/program.toml").value();
    const std::size_t first = program.find("[[program.key]]");
    CHECK(first != std::string::npos);
    CHECK(program.find("[[program.key]]", first + 1) == std::string::npos);
}

TEST_CASE("a cancelled workspace search resumes from its checkpoint to the same samples") {
    const test::Folder folder;
    const Model model(with_goal(reachable));
    const WorkspaceOptions small{.side = 4, .between = 0};
    const Workspace whole = workspace(model, small);
    REQUIRE(whole.sample_count() == 4);
    for (std::size_t k = 0; k < 4; ++k) {
        const WorkspaceSample sample = whole.sample(k);
        CHECK(sample.found);
        CHECK((sample.tensions_N[0] > 1e-9) == (sample.inputs[0] > 0));
        CHECK((sample.markers[0][2] > 0.0051) == (sample.inputs[0] > 0));
        const Inputs inputs = whole.inputs_at(k);
        CHECK(inputs.cables[0].value == near(0.06 - sample.inputs[0], {.relative = 1e-12}));
        Stepper stepper(model);
        State state = stepper.rest();
        REQUIRE(stepper.step(state, inputs).arrived);
        CHECK(stepper.observe(state).markers[0].position_m[2] == near(sample.markers[0][2], {.absolute = 2e-5}));
    }
    CHECK_THROWS_WITH_AS((void)whole.inputs_at(4), "there is no sample 4; there are 4", Failure);
    WorkspaceOptions kept = small;
    kept.checkpoint = folder / "kept";
    CHECK_THROWS_AS((void)workspace(model, kept, [](std::string_view, double share) { return share < 0.5; }), Failure);
    kept.resume = true;
    const Workspace resumed = workspace(model, kept);
    for (std::size_t k = 0; k < 4; ++k) CHECK(resumed.sample(k).markers == whole.sample(k).markers);
    resumed.write(folder / "out");
    CHECK(fs::exists(folder / "out/workspace.csv"));
    CHECK(fs::exists(folder / "out/workspace.png"));
    resumed.remove_checkpoint();
    CHECK_FALSE(fs::exists(folder / "kept"));
    CHECK_THROWS_AS((void)whole.sample(4), Failure);
    CHECK_THROWS_AS((void)whole.sheets(1), Failure);
}

namespace {

/// The bar with a second cable, along its lower side.
Model with_two_cables(const std::vector<std::string>& changes = {}) {
    std::string text = test::bar_text();
    const std::string end = "\"8 mm\"] }]";
    text.replace(text.find(end), end.size(),
                 "\"8 mm\"] }, { name = \"extensor\", points = [[0, 5, 1], [60, 5, 1]], "
                 "target.shortening = \"0 mm\", range = [\"0 mm\", \"2 mm\"] }]");
    return Model(Robot::parse(text, {}, changes));
}

}  // namespace

TEST_CASE("a new search does not delete the samples that an unfinished one has kept") {
    const test::Folder folder;
    const Model model = with_two_cables(), other = with_two_cables({"material.soft.youngs_modulus=2 MPa"});
    const WorkspaceOptions kept{.side = 2, .between = 2, .checkpoint = folder / "kept"};
    // The sheet of four samples is a piece, and the two between are another.
    CHECK_THROWS_AS((void)workspace(model, kept, [](std::string_view, double share) { return share < 0.8; }), Failure);
    CHECK_THROWS_WITH_AS((void)workspace(model, kept),
                         ((folder / "kept").string() + ": holds 4 of 6 samples of this search, which a new search "
                                                       "would delete; resume it, or remove the folder")
                             .c_str(),
                         Failure);
    CHECK(fs::exists(folder / "kept/piece_0000"));
    WorkspaceOptions resumed = kept;
    resumed.resume = true;
    const std::string whole = workspace(model, resumed).json();
    CHECK(workspace(model, kept).json() == whole);  // replaces what was finished
    CHECK(workspace(other, kept).json() != whole);  // replaces what is of another search
}

TEST_CASE("a workspace warns of samples at which a chamber would have to pull harder than a vacuum") {
    const Model model(with_goal(reachable));
    CHECK(workspace(model, {.side = 2, .between = 0}).warnings().empty());
    const Model sucked(Robot::parse(R"(name = "cube"
length_unit = "mm"
material.soft = { youngs_modulus = "10 MPa", poisson_ratio = 0.45 }
body = [{ name = "cube", material = "soft", geometry = { difference = [{ box = [[0, 0, 0], [4, 4, 4]] },
                                                                      { box = [[1, 1, 1], [3, 3, 3]] }] } }]
fixed = [{ name = "base", box = [[0, 0, 0], [4, 4, 0]] }]
marker = [{ name = "top", point = [2, 2, 4] }]
chamber = [{ name = "air", inside = [2, 2, 2], target = { volume_ratio = 1 }, range = [0.9, 1] }]
mesh = { size = "1 mm", order = 1 }
)"));
    const Workspace found = workspace(sucked, {.side = 2, .between = 0});
    REQUIRE(found.warnings().size() == 1);
    CHECK(found.warnings()[0].find("the pressure in chamber \"air\" is below a vacuum") != std::string::npos);
    CHECK(found.json().find("\"warnings\"") != std::string::npos);
}

TEST_CASE("a damaged piece of a workspace, or one of another search, is solved anew") {
    const test::Folder folder;
    const Model model(with_goal(reachable)), other(with_goal(reachable, {"material.soft.youngs_modulus=2 MPa"}));
    WorkspaceOptions kept{.side = 3, .between = 0, .checkpoint = folder / "kept"};
    const std::string right = workspace(model, kept).json();
    const std::string piece = read_file(folder / "kept/piece_0000").value();
    kept.resume = true;
    for (std::size_t at = 0; at < piece.size(); at += 29) {
        std::string changed = piece;
        changed[at] = static_cast<char>(changed[at] ^ 4);
        REQUIRE(write_file(folder / "kept/piece_0000", changed));
        CHECK(workspace(model, kept).json() == right);
    }
    kept.resume = false;
    kept.checkpoint = folder / "other";
    CHECK(workspace(other, kept).json() != right);
    fs::copy_file(folder / "other/piece_0000", folder / "kept/piece_0000", fs::copy_options::overwrite_existing);
    kept = {.side = 3, .between = 0, .checkpoint = folder / "kept", .resume = true};
    CHECK(workspace(model, kept).json() == right);
    CHECK_THROWS_AS((void)workspace(other, kept), Failure);
}

TEST_CASE("a second search or run on the checkpoint of one at work is refused, and the first ends as if alone") {
    const test::Folder folder;
    const Model model(with_goal(reachable)), other(with_goal(reachable, {"material.soft.youngs_modulus=2 MPa"}));
    const WorkspaceOptions kept{.side = 3, .between = 0, .checkpoint = folder / "kept"};
    const std::string refusal = (folder / "kept").string() +
                                ": another process is at work on this checkpoint; wait for it, or choose another "
                                "folder for the results";
    int refused = 0;
    const Workspace found = workspace(model, kept, [&](std::string_view, double share) {
        if (share < 0.5 || refused > 0) return true;
        ++refused;
        CHECK_THROWS_WITH_AS((void)workspace(other, kept), refusal.c_str(), Failure);
        return true;
    });
    CHECK(refused == 1);
    CHECK(found.json() == workspace(model, {.side = 3, .between = 0}).json());
    found.remove_checkpoint();
    CHECK_FALSE(fs::exists(folder / "kept"));

    const RunOptions saved{.checkpoint = folder / "kept"};
    refused = 0;
    const ProgramResult first = run(model, saved, [&](std::string_view, double share) {
        if (share < 0.5 || refused > 0) return true;
        ++refused;
        CHECK_THROWS_WITH_AS((void)run(other, saved), refusal.c_str(), Failure);
        return true;
    });
    CHECK(refused == 1);
    CHECK(first.converged());
    CHECK(run(other, saved).converged());
    first.remove_checkpoint();
    CHECK_FALSE(fs::exists(folder / "kept"));
}

TEST_CASE("a checkpoint does not overwrite a folder with other files") {
    const test::Folder folder;
    fs::create_directories(folder / "kept");
    REQUIRE(write_file(folder / "kept/mine", "mine"));
    const Model model(with_goal(reachable));
    CHECK_THROWS_AS((void)workspace(model, {.side = 2, .between = 0, .checkpoint = folder / "kept"}), Failure);
    CHECK(fs::exists(folder / "kept/mine"));
}

TEST_CASE("the program of a robot file that stands on another one is written and runs") {
    const test::Folder folder;
    REQUIRE(write_file(folder / "bar.toml", with_goal_text(reachable)));
    REQUIRE(
        write_file(folder / "soft.toml", "robot = \"bar.toml\"\nset = [\"material.soft.youngs_modulus=0.5 MPa\"]\n"));
    const InverseResult result = inverse(Model(Robot::load(folder / "soft.toml")));
    REQUIRE(result.reached());
    (void)result.write(folder / "out", {}, [] { return true; });
    const ProgramResult again = run(Model(Robot::load(folder / "out/program.toml")));
    REQUIRE(again.converged());
    CHECK(again.step(again.step_count() - 1).observed.markers[0].position_m[2] == near(0.008, {.absolute = 2e-5}));
}

TEST_CASE("the program of goals with times is written, however late the times are") {
    const test::Folder folder;
    const InverseResult result = inverse(Model(
        bar("goal = [{ name = \"reach\", marker = \"tip\", times = [2, 10], tolerance = \"0.01 mm\", "
            "plane = { point = [0, 0, 8], normal = [0, 0, 1] } }]\nprogram = { steps = 10, duration = \"10 s\" }\n")));
    REQUIRE(result.waypoint_count() == 2);
    CHECK(result.waypoint(1).time == 10);
    (void)result.write(folder / "out", {}, [] { return true; });
    const Model led(Robot::load(folder / "out/program.toml"));
    CHECK(run(led).converged());
    CHECK_THROWS_WITH_AS((void)inverse(led), doctest::Contains("search with robot.toml itself"), Failure);
}

TEST_CASE("what could not be written is refused before the search") {
    const Model model(bar(std::string("goal = [{ name = \"reach\", marker = \"tip\", ") + reachable +
                          " }]\nload = [{ name = \"flexor\", box = [[60, 0, 0], [60, 10, 10]], force = [\"0 N\", \"0 "
                          "N\", \"0.1 N\"] }]\n"));
    CHECK_THROWS_WITH_AS((void)inverse(model, {.to_write = true}),
                         doctest::Contains("two things are named \"flexor\", which the program must name"), Failure);
}
