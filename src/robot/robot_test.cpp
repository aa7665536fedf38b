#include "robot/robot.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "robot/build.hpp"

using namespace pliant;
using namespace pliant::robot;

namespace {

/// A bar of two materials with one notch, a cable and a marker; every line below may be replaced by a test.
const std::string good = R"(name = "bar"
length_unit = "mm"
[parameters]
gaps = 1
[material.soft]
youngs_modulus = "1 MPa"
poisson_ratio = 0.4
[material.hard]
youngs_modulus = "5 MPa"
poisson_ratio = 0.4
resin = "rigid"
[shape.gap]
repeat = "= gaps"
step = [8, 0, 0]
of = { box = [[9, -1, 5], [11, 11, 11]] }
[[body]]
name = "left"
material = "hard"
geometry = { difference = [{ box = [[0, 0, 0], [20, 10, 10]] }, { use = "gap" }] }
[[body]]
name = "right"
material = "soft"
geometry = { box = [[20, 0, 0], [40, 10, 10]] }
[mesh]
size = "6 mm"
[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, 10, 10]]
[[cable]]
name = "flexor"
points = [[0, 5, 8], [40, 5, 8]]
guides = "crossings"
target = { length_ratio = 0.97 }
[[marker]]
name = "tip"
point = [40, 5, 5]
[program]
steps = 3
)";

std::string with(const std::string& line, const std::string& replacement) {
    std::string text = good;
    const std::size_t at = text.find(line);
    REQUIRE_MESSAGE(at != std::string::npos, line);
    return text.replace(at, line.size(), replacement);
}

/// What is wrong with a text, whether that shows on reading or on building.
std::string problem(const std::string& text, const std::vector<std::string>& assignments = {}) {
    const Result<Robot> robot = parse_robot(text, "bar.toml", assignments);
    if (!robot) return robot.error().message;
    Progress silent;
    Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
    if (!mesh) return mesh.error().message;
    const Result<sim::Model> model = build_model(*robot, std::move(*mesh));
    return model ? "" : model.error().message;
}

void check_problem(const std::string& text, const std::string& wanted) {
    const std::string found = problem(text);
    CHECK_MESSAGE(found.find(wanted) != std::string::npos, "found \"", found, "\", wanted \"", wanted, "\"");
}

}  // namespace

TEST_CASE("a good robot file is read and built") {
    const Result<Robot> robot = parse_robot(good, "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->materials.size() == 2);
    CHECK(robot->materials[0].resin == "soft");
    CHECK(robot->materials[1].resin == "rigid");
    CHECK(robot->program.tolerance == 1e-4);
    Progress silent;
    Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->order == 2);
    CHECK(mesh::volume(*mesh, 0) == doctest::Approx(1e-9 * (20 * 10 * 10 - 2 * 10 * 5)));
    CHECK(mesh::volume(*mesh, 1) == doctest::Approx(1e-9 * 20 * 10 * 10));
    const Result<sim::Model> model = build_model(*robot, std::move(*mesh));
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    CHECK(model->description().cables[0].points.size() == 4);  // both ends, and both flanks of the notch
    const auto surfaces = body_surfaces(*robot, silent);
    REQUIRE(surfaces);
    CHECK(mesh::signed_volume((*surfaces)[0].surface_m) == doctest::Approx(1e-9 * (2000 - 100)));
}

TEST_CASE("--set changes the number of gaps and the target") {
    const Result<Robot> robot =
        parse_robot(good, "bar.toml", {"parameters.gaps=2", "cable.flexor.target.length_ratio=0.9", "mesh.order=1"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
    REQUIRE(mesh);
    CHECK(mesh->order == 1);
    CHECK(mesh::volume(*mesh, 0) == doctest::Approx(1e-9 * (2000 - 200)));
    CHECK(robot->cables[0].target.value == 0.9);
}

TEST_CASE("--set reaches tables that the file leaves out") {
    const Result<Robot> robot = parse_robot(with("[program]\nsteps = 3\n", ""), "bar.toml", {"program.steps=7"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->program.steps == 7);
    CHECK(problem(good, {"progam.steps=7"}) == "bar.toml: progam: nobody reads this key; did you mean \"program\"?");
}

TEST_CASE("slips in the text are named with their line") {
    check_problem(with("geometry = { box", "geometri = { box"),
                  "bar.toml:23: body[1].geometri: nobody reads this key; did you mean \"geometry\"?");
    check_problem(with("\"1 MPa\"", "1000000"),
                  "bar.toml:6: material.soft.youngs_modulus: 1000000 has no unit; write a pressure such as \"12 MPa\"");
    check_problem(with("\"1 MPa\"", "\"1 mm\""), "unknown unit \"mm\"; here the units are MPa");
    check_problem(with("length_unit = \"mm\"", ""), "\"length_unit\" is missing");
    check_problem(with("material = \"soft\"", "material = \"sofd\""), "did you mean \"soft\"?");
    check_problem(with("use = \"gap\"", "use = \"gab\""), "there is no [shape.gab]; did you mean \"gap\"?");
    check_problem(with("poisson_ratio = 0.4\n[material.hard]", "poisson_ratio = 0.5\n[material.hard]"),
                  "0.5 is not possible");
    check_problem(with("length_ratio = 0.97", "length_ratio = 1.2"), "a cable gets shorter");
    check_problem(with("geometry = { box = [[20", "geometry = { boxx = [[20"), "is no shape; did you mean \"box\"?");
    check_problem(good + "surplus = 1\n", "bar.toml:39: program.surplus: nobody reads this key");
    check_problem(with("steps = 3", "steps = 0"), "between 1 and 100000");
    check_problem(with("name = \"right\"", "name = \"left\""), "two bodies named \"left\"");
}

TEST_CASE("shapes that make no sense are refused") {
    check_problem(with("{ box = [[20, 0, 0], [40, 10, 10]] }", "{ box = [[40, 0, 0], [20, 10, 10]] }"),
                  "must be above the first");
    check_problem(with("{ box = [[20, 0, 0], [40, 10, 10]] }", "{ sphere = { center = [30, 5, 5], radius = 0 } }"),
                  "radius: must be above zero");
    check_problem(
        with("{ box = [[20, 0, 0], [40, 10, 10]] }", "{ prism = [[0,0],[1,1],[1,0],[0,1]], from = 0, to = 1 }"),
        "crosses or touches itself");
    check_problem(with("{ box = [[20, 0, 0], [40, 10, 10]] }",
                       "{ difference = [{ box = [[20,0,0],[40,10,10]] }, { box = [[0,-1,-1],[50,11,11]] }] }"),
                  "empty");
    check_problem(with("of = { box = [[9, -1, 5], [11, 11, 11]] }", "of = { use = \"gap\" }"), "uses itself");
    check_problem(with("\"= gaps\"", "5000"), "1 to 1000 are possible");
}

TEST_CASE("what does not fit the robot is refused with its line") {
    check_problem(with("geometry = { box = [[20,", "geometry = { box = [[18,"),
                  "bar.toml:20: body: bodies \"left\" and \"right\" overlap in a volume of 200");
    check_problem(with("points = [[0, 5, 8], [40, 5, 8]]", "points = [[0, 5, 8], [40, 5, 30]]"),
                  "lies outside every body");
    check_problem(with("box = [[0, 0, 0], [0, 10, 10]]", "box = [[-9, 0, 0], [-5, 10, 10]]"),
                  "bar.toml:26: fixed \"clamp\": catches no node");
    check_problem(with("[[fixed]]\nname = \"clamp\"\nbox = [[0, 0, 0], [0, 10, 10]]", ""), "nothing is fixed");
    check_problem(with("point = [40, 5, 5]", "point = [50, 5, 5]"),
                  "marker \"tip\": the point (50, 5, 5) lies outside every body");
    check_problem(with("length_ratio = 0.97", "shortening = \"50 mm\""), "it is 40 mm long");
    check_problem(with("geometry = { box = [[20, 0, 0], [40, 10, 10]] }", "geometry = \"nothere.stl\""),
                  "there is no file");
    check_problem(with("[[20, 0, 0], [40", "[[21, 0, 0], [40"), "connected to nothing that is fixed");
    check_problem(with("size = \"6 mm\"", "size = \"0.01 mm\""), "tetrahedra, more than");
}

TEST_CASE("supports can be chosen by plane, sphere and nodes") {
    for (const char* selector : {"plane = { point = [0, 0, 0], normal = [1, 0, 0] }",
                                 "sphere = { center = [0, 5, 5], radius = 7.2 }", "nodes = [0, 1, 2, 3]"}) {
        CHECK(problem(with("box = [[0, 0, 0], [0, 10, 10]]", selector)).empty());
    }
    check_problem(with("box = [[0, 0, 0], [0, 10, 10]]", "nodes = [99999]"), "node 99999 does not exist");
    check_problem(with("box = [[0, 0, 0], [0, 10, 10]]", "nodes = [0]\nsphere = { center = [0,0,0], radius = 1 }"),
                  "takes only one of");
}

TEST_CASE("a load is spread over the outer surface in its box") {
    const std::string text =
        good + "[[load]]\nname = \"push\"\nbox = [[40, 0, 0], [40, 10, 10]]\nforce = [\"0 N\", \"0 N\", \"0.5 N\"]\n";
    const Result<Robot> robot = parse_robot(text, "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const Result<sim::Model> model = build_model(*robot, *build_mesh(*robot, silent));
    REQUIRE(model);
    const sim::Load& load = model->description().loads.at(0);
    double sum = 0;
    for (std::size_t i = 0; i < load.nodes.size(); ++i) {
        sum += load.shares[i];
        CHECK(model->mesh().points[static_cast<std::size_t>(load.nodes[i])].x == doctest::Approx(0.04));
    }
    CHECK(sum == doctest::Approx(1));
    CHECK(
        problem(good +
                "[[load]]\nname = \"push\"\nbox = [[50, 0, 0], [60, 10, 10]]\nforce = [\"0 N\", \"0 N\", \"0.5 N\"]\n")
            .find("no face of the outer surface") != std::string::npos);
}
