// Parameter sweeps: results of a program over one or two numbers.
#include "studio/search/sweep.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/scene.hpp"
#include "studio/base/test_events.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using studio::test::bar;
using studio::test::Json;

namespace {

Progress unwatched;

std::size_t column(const Sweep& sweep, const std::string& key) {
    const auto found = std::ranges::find(sweep.columns, key, &SweepColumn::key);
    REQUIRE_MESSAGE(found != sweep.columns.end(), key);
    return static_cast<std::size_t>(found - sweep.columns.begin());
}

RobotText source(Accuracy accuracy = Accuracy::preview) {
    return {"bar.toml", bar, accuracy};
}

/// Tension at the end of the program, as `pliant simulate --set` has it.
double simulated_tension(const std::vector<std::string>& assignments) {
    Result<robot::Robot> robot = robot::parse_robot(bar, "bar.toml", assignments);
    REQUIRE(robot);
    const Result<robot::Scene> scene = robot::build_scene(std::move(*robot), unwatched);
    REQUIRE(scene);
    return sim::run(scene->model, scene->robot.program, unwatched).steps.back().cables[0].tension_N;
}

}  // namespace

TEST_CASE("two axes that set one number, however they write it, are refused") {
    const SweepAxis by_name{"cable.flexor.friction", "", {0, 0.5}}, by_index{"cable[0].friction", "", {0.1, 0.2}};
    const Status refused = check_axes(source(), {{by_name, by_index}});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message ==
          "sweep: cable[0].friction sets what cable.flexor.friction sets; only one of them may");
    CHECK(check_axes(source(), {{by_name, {"material.soft.youngs_modulus", "MPa", {1}}}}));
}

TEST_CASE("a target that keys of the program say is refused, and the key is named") {
    const std::string keys = "[[program.key]]\ntime = \"1 s\"\nflexor = \"0.1 mm\"\n";
    const RobotText keyed{"bar.toml", bar + ("\n" + keys), Accuracy::preview};
    const Status refused = check_axes(keyed, {{{"cable[0].target.shortening", "mm", {0.1, 0.2}}}});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message ==
          "sweep: cable[0].target.shortening changes nothing, since keys of the program drive cable \"flexor\" and say "
          "its targets; set program.key[0].flexor instead");
    CHECK(check_axes(keyed, {{{"program.key[0].flexor", "mm", {0.1, 0.2}}}}));
}

TEST_CASE("a run of a sweep says why not to trust it") {
    // A pressure far below a vacuum: no pump reaches such a volume.
    const RobotText vacuum{"cube.toml", R"(name = "cube"
length_unit = "mm"
material.soft = { youngs_modulus = "10 MPa", poisson_ratio = 0.45 }
body = [{ name = "cube", material = "soft", geometry = { difference = [{ box = [[0, 0, 0], [4, 4, 4]] },
                                                                      { box = [[1, 1, 1], [3, 3, 3]] }] } }]
fixed = [{ name = "base", box = [[0, 0, 0], [4, 4, 0]] }]
chamber = [{ name = "air", inside = [2, 2, 2], target = { volume_ratio = 0.99 } }]
mesh = { size = "1 mm", order = 1 }
program.steps = 2
)",
                           Accuracy::preview};
    const SweepOrder order{{{"chamber.air.target.volume_ratio", "", {1, 0.9}}}};
    const auto sweep = run_sweep(vacuum, order, unwatched);
    REQUIRE_MESSAGE(sweep, (sweep ? "" : sweep.error().message));
    CHECK(sweep->runs[0].warning == "");
    CHECK(sweep->runs[1].why == "");
    CHECK(holds(sweep->runs[1].warning, "below a vacuum"));
    CHECK(Json::parse(sweep_json(order, *sweep))["runs"][1]["warning"] == sweep->runs[1].warning);
}

TEST_CASE("each run of a sweep is the program with --set, and the tension is proportional to the modulus") {
    const SweepOrder order{{{"material.soft.youngs_modulus", "MPa", {1, 2, 4}}}};
    const auto sweep = run_sweep(source(), order, unwatched);
    REQUIRE(sweep);
    REQUIRE(sweep->runs.size() == 3);
    const std::size_t tension = column(*sweep, "flexor_tension_N");
    CHECK(sweep->columns[tension].unit == "N");
    for (std::size_t k = 0; k < 3; ++k) {
        CHECK(sweep->runs[k].inputs == std::vector<double>{order.axes[0].values[k]});
        // For the same displacements, forces are proportional to the modulus.
        CHECK(sweep->runs[k].results[tension] ==
              near(order.axes[0].values[k] * sweep->runs[0].results[tension], {.relative = 1e-3}));
    }
    CHECK(sweep->runs[2].results[tension] ==
          near(simulated_tension({"mesh.order=1", "material.soft.youngs_modulus=4 MPa"}), {.relative = 1e-9}));
    CHECK(sweep->runs[1].results[column(*sweep, "flexor_shortening_mm")] == near(0.2, {.relative = 1e-5}));
}

TEST_CASE("two keys give every combination, the second one fastest; if the mesh changes it is built again") {
    const SweepOrder order{{{"cable.flexor.target.shortening", "mm", {0.1, 0.2}}, {"mesh.size", "mm", {1.5, 1}}}};
    const auto sweep = run_sweep(source(), order, unwatched);
    REQUIRE(sweep);
    REQUIRE(sweep->runs.size() == 4);
    CHECK(sweep->runs[1].inputs == std::vector<double>{0.1, 1});
    CHECK(sweep->runs[2].inputs == std::vector<double>{0.2, 1.5});
    const std::size_t tension = column(*sweep, "flexor_tension_N");
    const std::vector<std::string> fine = {"mesh.order=1", "mesh.size=1 mm", "cable.flexor.target.shortening=0.1 mm"};
    CHECK(sweep->runs[1].results[tension] == near(simulated_tension(fine), {.relative = 1e-9}));
    CHECK_FALSE(sweep->runs[0].results[tension] == near(simulated_tension(fine), {.relative = 1e-3}));
    CHECK(sweep->runs[3].results[tension] ==
          near(simulated_tension({"mesh.order=1", "mesh.size=1 mm"}), {.relative = 1e-9}));
    const Json json = Json::parse(sweep_json(order, *sweep));
    CHECK(json["axes"][1]["key"] == "mesh.size");
    CHECK(json["runs"][3]["inputs"][1] == 1);
}

TEST_CASE("keys that do not change shapes keep the mesh") {
    for (const char* key : {"material.soft.youngs_modulus", "program.gravity", "cable.flexor.target.shortening",
                            "cable.flexor.friction", "chamber.air.target.pressure", "load.push.force"})
        CHECK_MESSAGE(!changes_mesh(key), key);
    for (const char* key : {"parameters.width", "mesh.size", "body.bar.geometry.box", "cable.flexor.points", "gap.a.x"})
        CHECK_MESSAGE(changes_mesh(key), key);
}

TEST_CASE("an impossible value gives its reason; only a sweep without any valid value is an error") {
    const SweepOrder order{{{"material.soft.poisson_ratio", "", {0.45, 0.6}}}};
    const auto sweep = run_sweep(source(), order, unwatched);
    REQUIRE(sweep);
    CHECK(sweep->runs[0].why.empty());
    CHECK(sweep->runs[1].results.empty());
    CHECK(holds(sweep->runs[1].why, "poisson_ratio"));
    const auto none = run_sweep(source(), {{{"material.soft.nothing", "", {1, 2}}}}, unwatched);
    REQUIRE_FALSE(none);
    CHECK(holds(none.error().message, "nothing"));
    struct Stop final : Progress {
        [[nodiscard]] bool cancelled() const override { return true; }
    } stop;
    const auto given_up = run_sweep(source(), order, stop);
    REQUIRE_FALSE(given_up);
    CHECK(given_up.error().cause == Cause::cancelled);
}

TEST_CASE("orders of sweeps and workspaces are read, and refused with the key") {
    const auto order = parse_sweep_order(R"({"axes":[{"key":"a.b","unit":"kg/m^3","values":[1,2.5]}]})");
    REQUIRE(order);
    CHECK(order->axes[0].values == std::vector<double>{1, 2.5});
    const std::pair<const char*, const char*> wrong[] = {
        {"[]", "object"},
        {R"({"axes":[]})", "axes"},
        {R"({"axes":[3]})", "axes"},
        {R"({"axes":[{"key":"a","values":[]}]})", "axes"},
        {R"({"axes":[{"key":"a=b","values":[1]}]})", "axes"},
        {R"({"axes":[{"key":"a","unit":"../../x","values":[1]}]})", "axes"},
        {R"({"axes":[{"key":"a","unit":"m\"","values":[1]}]})", "axes"},
        {R"({"axes":[{"key":"a","values":["1"]}]})", "axes"},
        {R"({"axes":[{"key":"a","values":[1]},{"key":"a","values":[1]}]})", "is named twice"},
        {R"({"axes":[{"key":"a","values":[1]},{"key":"b","values":[1]},{"key":"c","values":[1]}]})", "axes"}};
    for (const auto& [text, key] : wrong) {
        const auto refused = parse_sweep_order(text);
        CHECK_MESSAGE((!refused && holds(refused.error().message, key)), text);
    }
    Json many = {{"axes", Json::array()}};
    for (const char* key : {"a", "b"}) many["axes"].push_back({{"key", key}, {"values", std::vector<double>(21, 1)}});
    CHECK(holds(parse_sweep_order(many.dump()).error().message, "441 runs are more than 400"));

    const auto workspace = parse_workspace_order(R"({"inputs":[{"name":"a","low":0,"high":1}],"side":5})");
    REQUIRE(workspace);
    CHECK(workspace->side == 5);
    CHECK(workspace->between == 50);
    for (const char* text : {R"({"inputs":[]})", R"({"inputs":[{"name":"a","low":0,"high":1}],"side":1})",
                             R"({"inputs":[{"name":"a","low":0,"high":1}],"side":2.5})",
                             R"({"inputs":[{"name":"a","low":0,"high":1}],"between":-1})"})
        CHECK_MESSAGE(!parse_workspace_order(text), text);
}
