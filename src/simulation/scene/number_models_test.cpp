// Gradients with respect to numbers of a drawing, against programs on meshes with larger changes.
#include "simulation/scene/number_models.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/gradient/program_gradient.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_model.hpp"

using namespace pliant;
using namespace pliant::robot;
using pliant::test::holds;

namespace {

/// A finger with a notch, a cable, a chamber's worth of air and a load that all follow its parameters.
const char* const finger_text = R"(
name = "finger"
length_unit = "mm"
parameters = { height = 12, depth = 5, place = 20, angle = 8, radius = 2.5, ratio = 0.96 }
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, density = "1100 kg/m^3" }
material.firm = { youngs_modulus = "4 MPa", poisson_ratio = 0.4 }
mesh = { order = ORDER, size = "6 mm" }
[[body]]
name = "root"
material = "firm"
geometry = { box = [[0, 0, 0], ["= place - 8", 10, "= height"]] }
[[body]]
name = "finger"
material = "soft"
geometry = { difference = [{ box = [["= place - 8", 0, 0], [50, 10, "= height"]] }, { rotate = "= angle", axis = [0, 1, 0], center = ["= place", 0, "= height"], of = { box = [["= place - 2", -1, "= height - depth"], ["= place + 2", 11, 20]] } }, { cylinder = { from = [40, -1, "= height / 2"], to = [40, 11, "= height / 2"], radius = "= radius" } }] }
[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, 10, "= height"]]
[[marker]]
name = "tip"
point = [50, 5, "= height / 2"]
[[load]]
name = "push"
box = [[50, 0, 0], [50, 10, "= height"]]
force = ["0 N", "0.05 N", "0 N"]
[[cable]]
name = "flexor"
points = [[0, 5, "= height - 6"], ["= place", 5, "= height - 6"], [50, 5, "= height - 6"]]
target = { length_ratio = "= ratio" }
[program]
steps = 2
gravity = [0, 0, -9.81]
tolerance = 1e-10
)";

struct Case {
    std::string text;
    Robot robot;
    mesh::TetMesh mesh;

    explicit Case(int order) : text(finger_text) {
        text.replace(text.find("ORDER"), 5, std::to_string(order));
        robot = *read({});
        Progress silent;
        mesh = build_mesh(robot, silent).value();
    }
    [[nodiscard]] Result<Robot> read(const std::vector<std::string>& changes) const {
        auto read = parse_robot(text, "finger.toml", changes);
        REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
        return read;
    }
    [[nodiscard]] Result<NumberModels> around(const std::string& name, double value) const {
        return number_models([&](const auto& changes) { return read(changes); }, robot, mesh, name, value);
    }
};

sim::Objective wanted() {
    sim::Objective objective;
    objective.measures = sim::along_axes({sim::Measure::Kind::marker, 0});
    objective.measures.push_back({sim::Measure::Kind::tension, 0});
    objective.measures.push_back({sim::Measure::Kind::length, 0});
    objective.measures.push_back({sim::Measure::Kind::reaction, 0, {0.3, -0.5, 0.8}});
    objective.judge = [](int, std::span<const double> at) {
        return sim::squared_distance(at, std::vector<double>{0.05, 0.004, 0.01, 0.5, 0.05, 0.1},
                                     std::vector<double>{1e4, 2e4, 1e4, 0.5, 1e3, 2});
    };
    return objective;
}

double value_on(const sim::Model& model, const Program& program) {
    Progress silent;
    const auto of =
        sim::program_gradient(model, program, wanted(), {.by = {.inputs = false, .parameters = false}}, silent);
    REQUIRE_MESSAGE(of, (of ? "" : of.error().message));
    return of->value;
}

}  // namespace

TEST_CASE("derivatives by a number of the drawing include everything that follows from it") {
    double worst = 0;
    for (const int order : {1, 2}) {
        const Case c(order);
        const auto model = build_model(c.robot, c.mesh);
        REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
        for (const auto& [name, value] : std::vector<std::pair<std::string, double>>{
                 {"height", 12}, {"depth", 5}, {"place", 20}, {"angle", 8}, {"radius", 2.5}, {"ratio", 0.96}}) {
            const auto around = c.around(name, value);
            REQUIRE_MESSAGE(around, (around ? "" : around.error().message));
            const sim::Equilibrium more(around->more), less(around->less);
            sim::GradientOptions options;
            options.by.numbers = {{&more, &less, around->step}};
            Progress silent;
            const auto of = sim::program_gradient(*model, c.robot.program, wanted(), options, silent);
            REQUIRE_MESSAGE(of, (of ? "" : of.error().message));
            // The same mesh, moved along its motion by steps that are large beside the tolerance of the states.
            const auto at = [&](double change) {
                mesh::TetMesh moved = c.mesh;
                for (std::size_t n = 0; n < moved.points.size(); ++n)
                    moved.points[n] = moved.points[n] + change * around->motion[n];
                const auto robot = c.read({fmt::format("parameters.{}={:.17g}", name, value + change)});
                const auto there = build_model(*robot, std::move(moved));
                REQUIRE_MESSAGE(there, (there ? "" : there.error().message));
                return value_on(*there, robot->program);
            };
            const double h = 4e-3 * value;
            const double by = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
            CHECK_MESSAGE(of->by.numbers[0] == near(by, {.relative = 5e-6}), name << " of order " << order);
            worst = std::max(worst, std::fabs(of->by.numbers[0] / by - 1));
        }
    }
    MESSAGE("largest error " << worst);
}

namespace {

/// A bar whose cable and spring end in eyelets on faces of its tets.
const char* const eyelet_text = R"(
name = "bar"
length_unit = "mm"
parameters = { L = 60 }
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.4 }
mesh = { order = 2, size = "4 mm", elements_through_wall = 0 }
[[body]]
name = "bar"
material = "soft"
geometry = { box = [[0, 0, 0], [8, 8, "= L"]] }
[[fixed]]
name = "base"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[cable]]
name = "pull"
points = [[1, 4, 0], [1, 4, "= L / 4"]]
eyelet_radius = "2 mm"
target = { tension = "0.5 N" }
[[spring]]
name = "back"
points = [[4, 7, 0], [4, 7, "= L / 4"]]
eyelet_radius = "2 mm"
stiffness = "0.1 N/mm"
free_length = "10 mm"
[[marker]]
name = "tip"
point = [4, 4, "= L"]
[program]
steps = 2
tolerance = 1e-10
)";

}  // namespace

TEST_CASE("eyelets on faces of tets stay attached to the same nodes while a number changes") {
    const auto read = [](const std::vector<std::string>& changes) {
        return parse_robot(eyelet_text, "bar.toml", changes);
    };
    const Result<Robot> robot = read({});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const mesh::TetMesh mesh = build_mesh(*robot, silent).value();
    sim::KeptPatches kept;
    const auto model = build_model(*robot, mesh, &kept);
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    kept.close();
    const auto around = number_models(read, *robot, mesh, "L", 60);
    REQUIRE_MESSAGE(around, (around ? "" : around.error().message));
    const sim::Equilibrium more(around->more), less(around->less);
    for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        const auto of = [&](const sim::Model& there, const Robot& with, std::vector<sim::NumberChange> numbers) {
            sim::GradientOptions options{.by = {.inputs = false, .parameters = false}};
            options.by.numbers = std::move(numbers);
            auto found = sim::program_gradient(
                there, with.program, sim::at_end({sim::Measure::Kind::marker, 0, direction}, 2), options, silent);
            REQUIRE_MESSAGE(found, (found ? "" : found.error().message));
            return *std::move(found);
        };
        const double by_number = of(*model, *robot, {{&more, &less, around->step}}).by.numbers[0];
        // The same nodes carry the eyelets over steps that are large beside the tolerance of the states.
        const auto at = [&](double change) {
            mesh::TetMesh stretched = mesh;
            for (Vec3& p : stretched.points) p.z *= 1 + change / 60;
            const Result<Robot> longer = read({fmt::format("parameters.L={:.17g}", 60 + change)});
            const auto there = build_model(*longer, std::move(stretched), &kept);
            REQUIRE_MESSAGE(there, (there ? "" : there.error().message));
            return of(*there, *longer, {}).value;
        };
        const double h = 0.02;
        const double by = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
        CHECK(by_number == near(by, {.relative = 1e-5, .absolute = 1e-9}));
    }
}

TEST_CASE("a number has no derivative if it changes which nodes are held or loaded, nor over friction or dynamics") {
    const std::string fixed = "box = [[0, 0, 0], [0, 10, \"= height\"]]";
    Case c(1);
    c.text.replace(c.text.find(fixed), fixed.size(), "box = [[0, 0, 0], [0, 10, 12]]");
    c.robot = *c.read({});
    const auto lost = c.around("height", 12);
    REQUIRE_FALSE(lost);
    CHECK(holds(lost.error().message, "parameter height has no derivative: it decides which nodes \"clamp\" holds"));
    // Boxes that do not follow the root's end, at x = 12, lose the nodes there.
    const std::string top = "box = [[0, 0, 12], [12, 10, 12]]";
    for (const auto& [added, blame] :
         {std::pair("[[load]]\nname = \"lid\"\npressure = \"1 kPa\"\n" + top, "load \"lid\" acts"),
          std::pair("[[load]]\nname = \"lid\"\nforce = [\"0 N\", \"0 N\", \"1 N\"]\n" + top, "load \"lid\" acts"),
          std::pair("[[plate]]\nname = \"lid\"\n" + top, "plate \"lid\" holds")}) {
        CAPTURE(added);
        Case loaded(1);
        loaded.text += added + "\n";
        loaded.robot = *loaded.read({});
        const auto lost_load = loaded.around("place", 20);
        REQUIRE_FALSE(lost_load);
        CHECK(holds(lost_load.error().message, blame));
    }
    const Case good(1);
    const auto around = good.around("ratio", 0.96);
    REQUIRE(around);
    const sim::Equilibrium more(around->more), less(around->less);
    sim::GradientOptions options;
    options.by.numbers = {{&more, &less, around->step}};
    Program in_time = good.robot.program;
    in_time.dynamics.emplace();
    const auto model = build_model(good.robot, good.mesh);
    Progress silent;
    const auto of = sim::program_gradient(*model, in_time, wanted(), options, silent);
    REQUIRE_FALSE(of);
    CHECK(holds(of.error().message, "no derivative over motion in time"));
    // Through the tether that holds what no support does.
    const auto refusal = [&](const std::string& added) {
        Case of_one(1);
        of_one.text.insert(of_one.text.find("[program]"), added);
        of_one.robot = *of_one.read({});
        const auto with = build_model(of_one.robot, of_one.mesh);
        REQUIRE_MESSAGE(with, (with ? "" : with.error().message));
        const auto refused = sim::program_gradient(*with, of_one.robot.program, wanted(), options, silent);
        REQUIRE_FALSE(refused);
        return refused.error().message;
    };
    CHECK(holds(refusal("[[object]]\nname = \"weight\"\nmass = \"2 g\"\n"
                        "geometry = { box = [[55, 0, 0], [60, 5, 5]] }\n"
                        "[[joint]]\nname = \"hook\"\nkind = \"hinge\"\nbetween = [\"weight\", \"world\"]\n"
                        "point = [55, 2, 2]\naxis = [0, 1, 0]\n"),
                "no derivative where there is an object (\"weight\")"));
}
