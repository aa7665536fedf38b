// Goals and identifications requested by a page.
#include "studio/search/search_session.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "simulation/run/simulate.hpp"
#include "studio/base/test_events.hpp"
#include "studio/search/goal_task.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using studio::test::bar;
using studio::test::Events;
using studio::test::Json;

namespace {

std::shared_ptr<const Built> built_from(const std::string& text) {
    SimulationSession session({[](const std::string&) {}, [](const auto&) {}, [] { return std::set<std::string>(); }});
    session.open({"bar.toml", text, Accuracy::preview});
    REQUIRE(session.wait_until_built());
    return session.built();
}

GoalOrder goal_at(double z_mm) {
    return {"tip", {{4, 1.5, z_mm}}, 1.0, {{"flexor", 0, 1}}};
}

struct SearchBench {
    Events events;
    SearchSession session{[this](const std::string& json) { events.add(json); }};
    /// The final message of the search.
    std::string end() {
        const Json last = events.wait_for([](const Json& e) { return e["type"] == "search" && e["stage"] == ""; });
        return last["error"];
    }
    Json result() {
        events.wait_for([](const Json& e) { return e["type"] == "searched"; });
        return Json::parse(session.result()->json);
    }
};

std::string problem(const Built& built, const GoalOrder& order) {
    const auto task = goal_task(built, order);
    return task ? "" : task.error().message;
}

}  // namespace

TEST_CASE("a goal from the page becomes a task, in the units of its sliders") {
    const auto built = built_from(bar);
    const Json inputs = Json::parse(goal_inputs_json(*built));
    REQUIRE(inputs.size() == 1);
    CHECK(inputs[0]["name"] == "flexor");
    CHECK(inputs[0]["kind"] == "shortening_mm");
    CHECK(inputs[0]["low"] == 0);
    CHECK(inputs[0]["high"].get<double>() == near(2, {.relative = 1e-9}));
    const auto task = goal_task(*built, goal_at(1.5));
    REQUIRE(task);
    CHECK(task->inputs[0].high == near(1e-3, {.relative = 1e-12}));
    CHECK(task->goals[0].wanted[0][0].z == near(1.5e-3, {.relative = 1e-12}));
    CHECK(task->goals[0].tolerance == near(1e-3, {.relative = 1e-12}));
}

TEST_CASE("impossible goals are refused in one line") {
    const auto built = built_from(bar);
    GoalOrder order = goal_at(1.5);
    order.marker = "top";
    CHECK(problem(*built, order) == "top: there is no such marker");
    order = goal_at(1.5);
    order.inputs = {{"rope", 0, 1}};
    CHECK(problem(*built, order) == "rope: cannot be moved: there is no such actuator");
    order.inputs = {{"flexor", 1, 1}};
    CHECK(problem(*built, order) == "flexor: the range from 1 to 1 is empty");
    order.inputs = {{"flexor", 0, 9}};
    CHECK(problem(*built, order) == "flexor: the range from 0 to 9 has values that are not possible");
    order.inputs = {{"flexor", 0, 1}, {"flexor", 0, 1}};
    CHECK(problem(*built, order) == "flexor: is named twice");
    CHECK(holds(
        problem(*built_from(std::string(bar) + "[program]\ntime_step = \"1 ms\"\nduration = \"1 s\"\n"), goal_at(1.5)),
        "time_step"));
}

TEST_CASE("a search reports its end, and its result is kept until the next search") {
    const auto built = built_from(bar);
    SearchBench b;
    CHECK(b.session.result() == nullptr);
    CHECK(Json::parse(b.session.news()[0])["result"] == 0);
    REQUIRE(b.session.find_inputs(built, *goal_task(*built, goal_at(1.5))));
    CHECK(b.end() == "");
    const Json result = b.result();
    CHECK(result["kind"] == "goal");
    CHECK(result["revision"] == built->revision);
    CHECK(result["opened"] == built->source.opened);
    CHECK(result["order"] == built->model.mesh().order);
    CHECK(result["program"]["keys"].get<std::string>().starts_with("[[program.key]]\ntime = \"1 s\"\n\"flexor\" = \""));
    CHECK(result["program"]["changes"][0] == Json{{"key", "program.steps"}, {"value", 10}});
    CHECK(result["program"]["changes"][1] == Json{{"key", "program.duration"}, {"value", "1 s"}});
    REQUIRE(result["found"]["waypoints"].size() == 1);
    CHECK(result["found"]["waypoints"][0]["reached"] == true);
    // Gravity, which the search holds, does not grow again in the program.
    b.events.clear();
    const auto heavy = built_from(std::string(bar) + "[program]\ngravity = [0, 0, -9.81]\n");
    REQUIRE(b.session.find_inputs(heavy, *goal_task(*heavy, goal_at(1.5))));
    CHECK(b.end() == "");
    const Json held = b.result();
    CHECK(holds(held["program"]["keys"].get<std::string>(), "\"gravity\" = 1\n"));
    b.events.clear();
    REQUIRE(b.session.identify(built, {{"material.soft.nothing"}, "time,tip_z_mm\n1,1\n", "t.csv", ""}));
    CHECK(holds(b.end(), "material.soft.nothing: the robot has no such parameter"));
    CHECK(Json::parse(b.session.result()->json) == held);
}

TEST_CASE("a modulus is identified from a table, with plots") {
    const auto built = built_from(bar);
    SearchBench b;
    REQUIRE(b.session.identify(built,
                               {{"cable.flexor.target.shortening"}, "time,tip_z_mm\n0.5,1.02\n1,1.05\n", "t.csv", ""}));
    CHECK(b.end() == "");
    const Json found = b.result()["found"];
    CHECK(found["unknowns"][0]["key"] == "cable.flexor.target.shortening");
    CHECK(found["shown"][0]["value"].get<std::string>().ends_with(" mm"));
    REQUIRE(b.session.result()->plots.size() == 1);
    CHECK(b.session.result()->plots[0].png.starts_with("\x89PNG"));
}

TEST_CASE("a workspace holds what each marker can reach") {
    const auto built = built_from(bar);
    const WorkspaceOrder order{{{"flexor", 0, 0.2}}, 5, 0};
    const auto task = workspace_task(*built, order);
    REQUIRE(task);
    SearchBench b;
    REQUIRE(b.session.find_workspace(built, *task, order));
    CHECK(b.end() == "");
    const Json found = b.result()["found"];
    CHECK(found["summary"]["samples"] == 5);
    CHECK(found["summary"]["found"] == 5);
    const Json& reach = found["reach"][0];
    CHECK(reach["name"] == "tip");
    REQUIRE(reach["points"].size() == 15);
    // Without actuation the tip is at its rest position.
    bool at_rest = false;
    for (std::size_t k = 0; k < 15; k += 3)
        at_rest = at_rest || (reach["points"][k].get<double>() == near(4, {.absolute = 1e-3}) &&
                              reach["points"][k + 2].get<double>() == near(1, {.absolute = 1e-3}));
    CHECK(at_rest);
    const double low = found["summary"]["markers"]["tip"]["low_mm"][0].get<double>();
    // The far end of the range is where the program ends.
    Progress silent;
    const sim::Trajectory pulled = sim::run(built->model, built->robot.program, silent);
    CHECK(low == near(1e3 * pulled.steps.back().markers[0].position_m.x, {.absolute = 1e-3}));
    CHECK(low < 3.95);
    CHECK(holds(found["csv"].get<std::string>(), "tip_x_mm"));
    CHECK(workspace_task(*built, {{{"rope", 0, 1}}, 5, 0}).error().message ==
          "rope: cannot be moved: there is no such actuator");
    std::string blind = bar;
    blind.erase(blind.find("marker ="), blind.find("mesh =") - blind.find("marker ="));
    CHECK(holds(workspace_task(*built_from(blind), order).error().message, "has no [[marker]]"));
}

TEST_CASE("a workspace says which chambers would have to pull harder than a vacuum") {
    const auto built = built_from(R"(name = "cube"
length_unit = "mm"
material.soft = { youngs_modulus = "10 MPa", poisson_ratio = 0.45 }
body = [{ name = "cube", material = "soft", geometry = { difference = [{ box = [[0, 0, 0], [4, 4, 4]] },
                                                                      { box = [[1, 1, 1], [3, 3, 3]] }] } }]
fixed = [{ name = "base", box = [[0, 0, 0], [4, 4, 0]] }]
marker = [{ name = "top", point = [2, 2, 4] }]
chamber = [{ name = "air", inside = [2, 2, 2], target = { volume_ratio = 0.99 } }]
mesh = { size = "1 mm", order = 1 }
)");
    const WorkspaceOrder order{{{"air", 0.9, 1}}, 3, 0};
    const auto task = workspace_task(*built, order);
    REQUIRE(task);
    SearchBench b;
    REQUIRE(b.session.find_workspace(built, *task, order));
    CHECK(b.end() == "");
    const Json summary = b.result()["found"]["summary"];
    REQUIRE(summary["warnings"].size() == 1);
    CHECK(holds(summary["warnings"][0].get<std::string>(), "the pressure in chamber \"air\" is below a vacuum"));
}

TEST_CASE("a sweep and a whole program run in the background, and the program's states can be played") {
    const auto built = built_from(bar);
    SearchBench b;
    REQUIRE(b.session.sweep(built, {{{"cable.flexor.target.shortening", "mm", {0.1, 0.2}}}}));
    CHECK(b.end() == "");
    CHECK(b.result()["found"]["runs"].size() == 2);
    b.events.clear();
    REQUIRE(b.session.run_motion(built));
    CHECK(b.end() == "");
    const Json result = b.result();
    CHECK(result["kind"] == "motion");
    CHECK(result["found"]["timed"] == false);
    const auto motion = b.session.result()->motion;
    REQUIRE(motion);
    REQUIRE(motion->count() == result["found"]["steps"].get<std::size_t>());
    const auto head = [&](std::size_t k) {
        const std::string packet = motion->frame(k, {"J"});
        std::uint32_t length = 0;
        std::memcpy(&length, packet.data() + 4, 4);
        return Json::parse(packet.substr(8, length))["head"];
    };
    CHECK(head(0)["time"] == 0);
    CHECK(head(motion->count() - 1)["time"] == 1);
    CHECK(head(motion->count() - 1)["cables"][0]["length_mm"].get<double>() == near(3.8, {.relative = 1e-5}));
    CHECK(head(0)["revision"] == built->revision);
}

TEST_CASE("one search runs at a time, and a cancelled one leaves no result") {
    const auto built = built_from(bar);
    SearchBench b;
    GoalOrder long_one = goal_at(1.5);
    for (int k = 0; k < 200; ++k) long_one.path_mm.push_back({4, 1.5, 1 + 0.002 * k});
    long_one.tolerance_mm = 1e-6;
    REQUIRE(b.session.find_inputs(built, *goal_task(*built, long_one)));
    CHECK(b.session.find_inputs(built, *goal_task(*built, long_one)).error().message ==
          "a search is running already; cancel it first");
    b.session.cancel();
    CHECK(b.end() == "");
    CHECK(b.session.result() == nullptr);
}

TEST_CASE("search orders are read, and refused with the key") {
    const auto goal = parse_goal_order(
        R"({"marker":"tip","path":[[1,2,3],[4,5,6]],"tolerance":0.1,"inputs":[{"name":"flexor","low":0.5,"high":1}]})");
    REQUIRE(goal);
    CHECK(goal->path_mm[1][2] == 6);
    CHECK(goal->inputs[0].low == 0.5);
    const auto identify =
        parse_identify_order(R"({"unknowns":["a.b"],"csv":"x\n","file":"m.csv","judge":"every-second"})");
    REQUIRE(identify);
    CHECK(identify->judge == "every-second");
    const std::pair<const char*, const char*> goals[] = {
        {"", "object"},
        {R"({"path":[[1,2,3]],"tolerance":1,"inputs":[{"name":"a","low":0,"high":1}]})", "marker"},
        {R"({"marker":"t","path":[],"tolerance":1,"inputs":[{"name":"a","low":0,"high":1}]})", "path"},
        {R"({"marker":"t","path":[[1,2]],"tolerance":1,"inputs":[{"name":"a","low":0,"high":1}]})", "path"},
        {R"({"marker":"t","path":[[1,2,1e300]],"tolerance":1,"inputs":[{"name":"a","low":0,"high":1}]})", "path"},
        {R"({"marker":"t","path":[[1,2,3]],"tolerance":0,"inputs":[{"name":"a","low":0,"high":1}]})", "tolerance"},
        {R"({"marker":"t","path":[[1,2,3]],"tolerance":1,"inputs":[]})", "inputs"},
        {R"({"marker":"t","path":[[1,2,3]],"tolerance":1,"inputs":[{"name":"a","low":"0"}]})", "inputs"}};
    for (const auto& [text, key] : goals) {
        const auto order = parse_goal_order(text);
        CHECK_MESSAGE((!order && holds(order.error().message, key)), text);
    }
    const std::pair<const char*, const char*> tables[] = {
        {R"({"unknowns":[],"csv":"x","file":"f"})", "unknowns"},
        {R"({"unknowns":[3],"csv":"x","file":"f"})", "unknowns"},
        {R"({"unknowns":["a"],"csv":"","file":"f"})", "csv"},
        {R"({"unknowns":["a"],"csv":"x"})", "file"},
        {R"({"unknowns":["a"],"csv":"x","file":"f","judge":"half"})", "judge"}};
    for (const auto& [text, key] : tables) {
        const auto order = parse_identify_order(text);
        CHECK_MESSAGE((!order && holds(order.error().message, key)), text);
    }
}
