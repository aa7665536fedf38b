#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/tet_writer.hpp"
#include "robot/bodies/build.hpp"
#include "robot/description/unused.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/build_model.hpp"
#include "simulation/scene/test_run.hpp"
#include "simulation/solver/equilibrium.hpp"

using namespace pliant;
using namespace pliant::robot;
using testing::build_text;
using testing::Built;
using testing::check_problem;
using testing::last_step;
using testing::problem;
using testing::run_text;

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
    return pliant::test::replaced(good, line, replacement);
}

}  // namespace

TEST_CASE("a valid robot file is read and built") {
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
    CHECK(mesh::volume(*mesh, 0) == near(1e-9 * (20 * 10 * 10 - 2 * 10 * 5), {.relative = 1e-12}));
    CHECK(mesh::volume(*mesh, 1) == near(1e-9 * 20 * 10 * 10, {.relative = 1e-12}));
    const Result<sim::Model> model = build_model(*robot, std::move(*mesh));
    REQUIRE_MESSAGE(model, (model ? "" : model.error().message));
    CHECK(model->description().cables[0].points.size() == 4);  // both ends, and both flanks of the notch
    const auto surfaces = body_surfaces(*robot, silent);
    REQUIRE(surfaces);
    CHECK(mesh::signed_volume((*surfaces)[0].surface_m) == near(1e-9 * (2000 - 100), {.relative = 1e-12}));
}

TEST_CASE("--set changes the number of gaps and the target") {
    const Result<Robot> robot =
        parse_robot(good, "bar.toml", {"parameters.gaps=2", "cable.flexor.target.length_ratio=0.9", "mesh.order=1"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
    REQUIRE(mesh);
    CHECK(mesh->order == 1);
    CHECK(mesh::volume(*mesh, 0) == near(1e-9 * (2000 - 200), {.relative = 1e-12}));
    CHECK(robot->cables[0].target.value == 0.9);
}

TEST_CASE("--set may create a table that the file does not have") {
    const Result<Robot> robot = parse_robot(with("[program]\nsteps = 3\n", ""), "bar.toml", {"program.steps=7"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->program.steps == 7);
    CHECK(problem(good, {"progam.steps=7"}) == "bar.toml: progam: unknown key; did you mean \"program\"?");
}

TEST_CASE("mistakes in the text are named with their line") {
    check_problem(with("geometry = { box", "geometri = { box"),
                  "bar.toml:23: body[1].geometri: unknown key; did you mean \"geometry\"?");
    check_problem(with("\"1 MPa\"", "1000000"),
                  "bar.toml:6: material.soft.youngs_modulus: 1000000 has no unit; write a pressure such as \"12 MPa\"");
    check_problem(with("\"1 MPa\"", "\"1 mm\""), "unknown unit \"mm\"; here the units are MPa");
    check_problem(with("length_unit = \"mm\"", ""), "\"length_unit\" is missing");
    check_problem(with("material = \"soft\"", "material = \"sofd\""), "did you mean \"soft\"?");
    check_problem(with("use = \"gap\"", "use = \"gab\""), "there is no [shape.gab]; did you mean \"gap\"?");
    check_problem(with("poisson_ratio = 0.4\n[material.hard]", "poisson_ratio = 0.5\n[material.hard]"),
                  "0.5 is not possible");
    check_problem(with("length_ratio = 0.97", "length_ratio = 12"), "12 is not possible: above 0, at most 10");
    check_problem(with("length_ratio = 0.97", "tension = \"-1 N\""), "must not be negative: a cable can only pull");
    check_problem(with("geometry = { box = [[20", "geometry = { boxx = [[20"), "is not a shape; did you mean \"box\"?");
    check_problem(good + "surplus = 1\n", "bar.toml:39: program.surplus: unknown key");
    check_problem(with("steps = 3", "steps = 0"), "between 1 and 100000");
    check_problem(with("name = \"right\"", "name = \"left\""), "two bodies named \"left\"");
}

TEST_CASE("a graded bar stretches as its layers in series") {
    // Without sideways strain, u = F / A int dx / E: with E rising straight from 1 to 5 MPa, ln 5 / 4 of what 1 MPa
    // gives.
    const testing::Built bar = testing::build(parse_robot(R"(name = "bar"
length_unit = "mm"
[material.soft]
youngs_modulus = "1 MPa"
poisson_ratio = 0
[material.hard]
youngs_modulus = "5 MPa"
poisson_ratio = 0
[[body]]
name = "bar"
geometry = { box = [[0, 0, 0], [40, 5, 5]] }
material = "soft"
blend = { material = "hard", from = [0, 0, 0], to = [40, 0, 0] }
[mesh]
size = "2.5 mm"
order = 2
[[fixed]]
name = "wall"
box = [[0, 0, 0], [0, 5, 5]]
[[load]]
name = "pull"
box = [[40, 0, 0], [40, 5, 5]]
force = ["0.025 N", "0 N", "0 N"]
[[marker]]
name = "tip"
box = [[40, 0, 0], [40, 5, 5]]
[program]
steps = 1
)",
                                                          "bar.toml"));
    const sim::Description& d = bar.model.description();
    CHECK(d.materials.size() > 15);
    CHECK(d.materials.size() <= 2 + 19);
    const double found = testing::run_to_the_end(bar).steps.back().markers[0].position_m.x - 0.04;
    CHECK(found == near(0.025 / 25e-6 / 1e6 * 0.04 * std::log(5.0) / 4, {.relative = 0.01}));
}

TEST_CASE("blends and exposures are read, and mistakes in them are named") {
    const auto body = [](const std::string& lines) {
        return with("material = \"soft\"\n", "material = \"soft\"\n" + lines + "\n");
    };
    const auto robot =
        parse_robot(body("exposure = \"7 s\"\nblend = { material = \"hard\", from = [20, 0, 0], to = [40, 0, "
                         "0], shares = [0.2, 0.4], cell = \"0.3 mm\" }"),
                    "bar.toml");
    REQUIRE_MESSAGE(robot.has_value(), (robot ? "" : robot.error().message));
    CHECK(robot->bodies[1].exposure_s == 7);
    REQUIRE(robot->bodies[1].blend.has_value());
    CHECK(robot->bodies[1].blend->material == 1);
    CHECK(robot->bodies[1].blend->shares == std::vector<double>{0.2, 0.4});
    CHECK(robot->bodies[1].blend->cell == near(0.3, {.relative = 1e-12}));
    check_problem(body("exposure = 7"), "7 has no unit; write a time such as");
    check_problem(body("blend = { material = \"hrd\", from = [0, 0, 0], to = [1, 0, 0] }"), "did you mean \"hard\"?");
    check_problem(body("blend = { material = \"hard\", from = [1, 0, 0], to = [1, 0, 0] }"),
                  "needs a way to change on");
    check_problem(body("blend = { material = \"hard\", from = [1, 0, 0], to = [2, 0, 0], shares = [2, 0] }"),
                  "two numbers or more from 0 to 1");
}

TEST_CASE("invalid shapes are refused") {
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

TEST_CASE("bodies apart by a rounding error are joined, unless the file says otherwise") {
    const std::string apart = with("[[20, 0, 0], [40", "[[20.005, 0, 0], [40");
    CHECK(problem(apart).empty());  // a thousandth of the mesh size is 0.006 mm
    CHECK(problem(apart, {"mesh.close_gaps=0 mm"}).find("connected to nothing that is fixed") != std::string::npos);
    CHECK(problem(apart, {"mesh.close_gaps=3 um"}).find("connected to nothing that is fixed") != std::string::npos);
    CHECK(problem(apart, {"mesh.close_gaps=-1 mm"}).find("must not be below zero") != std::string::npos);
}

TEST_CASE("values that do not fit the robot are refused with their line") {
    check_problem(with("geometry = { box = [[20,", "geometry = { box = [[-1,-1,-1],[50, 50, 50]] } #"),
                  "body \"left\" is empty: all of it belongs to later ones");
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
        CHECK(model->mesh().points[static_cast<std::size_t>(load.nodes[i])].x == near(0.04, {.relative = 1e-12}));
    }
    CHECK(sum == near(1, {.relative = 1e-12}));
    CHECK(
        problem(good +
                "[[load]]\nname = \"push\"\nbox = [[50, 0, 0], [60, 10, 10]]\nforce = [\"0 N\", \"0 N\", \"0.5 N\"]\n")
            .find("no face of the outer surface") != std::string::npos);
}

namespace {

std::string chamber(const std::string& air, const std::string& target) {
    return good + "[[chamber]]\nname = \"air\"\n" + air + "\ntarget = { " + target + " }\n";
}
const std::string room = "geometry = { box = [[24, 3, 3], [36, 7, 7]] }";  // 192 mm^3 inside the body "right"

/// The notched bar as a mesh file with the regions "left" and "right", gone when the test ends.
class MeshFile {
public:
    MeshFile() {
        const Result<Robot> robot = parse_robot(good, "bar.toml", {"mesh.order=1"});
        REQUIRE(robot);
        Progress silent;
        const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
        REQUIRE(mesh);
        REQUIRE(mesh::write_tet_mesh(path_, mesh::scaled(*mesh, 1000)));
    }

    /// A robot of this mesh; `bodies` are [[body]] tables.
    [[nodiscard]] std::string robot(const std::string& bodies) const {
        const std::size_t first = good.find("[shape.gap]");
        const std::size_t fixed = good.find("[[fixed]]");
        return good.substr(0, first) + bodies + "[mesh]\nfile = \"" + path_.string() + "\"\n" + good.substr(fixed);
    }

private:
    pliant::test::Folder folder_{"robot"};
    std::filesystem::path path_ = folder_ / "bar.vtu";
};

std::string region(const std::string& name, const std::string& material, const std::string& which) {
    return "[[body]]\nname = \"" + name + "\"\nmaterial = \"" + material + "\"\n" + which + "\n";
}

}  // namespace

TEST_CASE("a drawn chamber is cut out of the body and closed by its wall") {
    const Built built = build_text(chamber(room, "volume_ratio = 1.2"));
    CHECK(mesh::volume(built.model.mesh()) == near(1e-9 * (4000 - 100 - 192), {.relative = 1e-12}));
    REQUIRE(built.model.description().chambers.size() == 1);
    CHECK(built.robot.chambers[0].target.value == 1.2);
    Progress silent;
    const auto surfaces = body_surfaces(built.robot, silent);
    REQUIRE(surfaces);
    CHECK(mesh::signed_volume((*surfaces)[1].surface_m) == near(1e-9 * (2000 - 192), {.relative = 1e-12}));
    const sim::Step step = last_step(built);
    CHECK(step.chambers[0].volume_m3 == near(1.2 * 192e-9, {.relative = 1e-6}));
    CHECK(step.chambers[0].pressure_Pa > 0);
}

TEST_CASE("a cavity can be named by a point inside it") {
    const std::string hollow = with("geometry = { box = [[20, 0, 0], [40, 10, 10]] }",
                                    "geometry = { difference = [{ box = [[20, 0, 0], [40, 10, 10]] }, { box = [[24, 3, "
                                    "3], [36, 7, 7]] }] }");
    const std::string air = "[[chamber]]\nname = \"air\"\ninside = [30, 5, 5]\ntarget = { volume_ratio = 1.2 }\n";
    const Built built = build_text(hollow + air);
    CHECK(mesh::volume(built.model.mesh()) == near(1e-9 * (4000 - 100 - 192), {.relative = 1e-12}));
    const sim::Step found = last_step(built);
    CHECK(found.chambers[0].volume_m3 == near(1.2 * 192e-9, {.relative = 1e-6}));
    const sim::Step drawn = last_step(build_text(chamber(room, "volume_ratio = 1.2")));
    CHECK(found.chambers[0].pressure_Pa == near(drawn.chambers[0].pressure_Pa, {.relative = 0.05}));
    check_problem(good + air, "bar.toml:39: chamber \"air\": inside: the point (30, 5, 5) lies in the material");
    check_problem(hollow + air + "geometry = { box = [[0, 0, 0], [1, 1, 1]] }\n",
                  "leave geometry, surface and region out");
    check_problem(chamber(room + "\ncap = { box = [[0, 0, 0], [1, 1, 1]] }", "volume_ratio = 1.2"),
                  "inside = [x, y, z]");
}

TEST_CASE("a cavity with an opening is closed by a cap, and its rim must be held") {
    const std::string pot =
        with("geometry = { box = [[20, 0, 0], [40, 10, 10]] }",
             "geometry = { difference = [{ box = [[20, 0, 0], [40, 10, 10]] }, { box = [[24, 3, 3], "
             "[36, 7, 11]] }] }");
    const std::string air = "[[chamber]]\nname = \"air\"\ninside = [30, 5, 5]\ntarget = { pressure = \"1 kPa\" }\n";
    const std::string cap = "cap = { box = [[20, 0, 10], [40, 10, 11]] }\n";
    check_problem(pot + air, "open to the outside; close each mouth with cap");
    check_problem(pot + air + cap, "the chamber is open; close it with a body");
    const std::string held = "[[fixed]]\nname = \"flange\"\nbox = [[20, 0, 10], [40, 10, 10]]\n";
    const Built built = build_text(pot + air + cap + held);
    CHECK(mesh::volume(built.model.mesh()) == near(1e-9 * (4000 - 100 - 12 * 4 * 7), {.relative = 1e-12}));
    CHECK(last_step(built).chambers[0].volume_m3 == near(336e-9, {.relative = 0.01}));
}

TEST_CASE("a chamber takes one of four targets") {
    using Kind = sim::ChamberTarget::Kind;
    const auto target = [](const std::string& text) {
        const Result<Robot> robot = parse_robot(chamber(room, text), "bar.toml");
        REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
        return robot->chambers[0].target;
    };
    CHECK(target("volume_ratio = 1.25").kind == Kind::volume_ratio);
    CHECK(target("gas_ratio = 2").kind == Kind::gas_ratio);
    CHECK(target("pressure = \"40 kPa\"").kind == Kind::pressure_Pa);
    CHECK(target("pressure = \"40 kPa\"").value == near(40e3, {.relative = 1e-12}));
    CHECK(target("pressure = \"-40 kPa\"").value == near(-40e3, {.relative = 1e-12}));
    CHECK(target("volume_change = \"0.5 ml\"").kind == Kind::volume_change_m3);
    CHECK(target("volume_change = \"0.5 ml\"").value == near(0.5e-6, {.relative = 1e-12}));

    check_problem(chamber(room, "volume_ratio = 1.2, pressure = \"1 kPa\""),
                  "chamber[0].target: takes one of volume_ratio, volume_change, pressure and gas_ratio");
    CHECK(problem(chamber(room, "volume_change = \"-0.1 ml\"")).empty());
    check_problem(chamber(room, "volume_change = \"-0.3 ml\""), "cannot lose 0.3 ml, it holds 0.192 ml");
    CHECK(problem(chamber(room, "pressure = \"-90 kPa\"")).empty());
    check_problem(chamber(room, "pressure = \"-200 kPa\""),
                  "a pressure of -200 kPa is below a vacuum: the air around has 101.325 kPa");
    check_problem(chamber(room, "volume_change = \"-192 mm^3\""), "cannot lose 0.192 ml, it holds 0.192 ml");
    check_problem(chamber(room, "volume_ratio = 0"), "a ratio of 0 is not possible; it must be above zero");
    check_problem(chamber(room, "pressure = 40"), "40 has no unit; write a pressure such as");
    check_problem(chamber(room, "volume_change = \"5 mm\""), "unknown unit \"mm\"; here the units are ml");
    check_problem(chamber(room, "volume_ration = 1.2"), "did you mean \"volume_ratio\"?");
    check_problem(good + "[[chamber]]\nname = \"air\"\n" + room + "\n", "\"target\" is missing");
}

TEST_CASE("targets have an offset in their own unit, which acts from the first instant") {
    const auto robot = parse_robot(chamber(room, "pressure = \"40 kPa\", offset = \"-2 kPa\""), "bar.toml",
                                   {"cable.flexor.target.offset=0.5 mm"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->cables[0].target.offset == near(0.5e-3, {.relative = 1e-12}));
    CHECK(robot->chambers[0].target.offset == near(-2e3, {.relative = 1e-12}));
    const Built built = testing::build(robot);
    const sim::Equilibrium system(built.model);
    const double length = system.actuators()[0].rest_measure();
    CHECK(system.controls(0).drives[0].value == near(length, {.relative = 1e-12}));
    CHECK(system.controls(1).drives[0].value == near(0.97 * length + 0.5e-3, {.relative = 1e-12}));
    CHECK(system.controls(0).drives[1].value == 0);
    CHECK(system.controls(0.5).drives[1].value == near(-18e3, {.relative = 1e-12}));
    check_problem(chamber(room, "gas_ratio = 2, offset = \"1 kPa\""),
                  "offset: goes with pressure, volume_change and volume_ratio, not with a sealed chamber");
    check_problem(chamber(room, "volume_ratio = 1.2, offset = \"1 kPa\""), "unknown unit \"kPa\"");
}

TEST_CASE("what cannot change, because supports hold all of it, is refused") {
    const std::string held = chamber(room, "volume_ratio = 1.2");
    const std::string box = "box = [[0, 0, 0], [0, 10, 10]]";
    REQUIRE(held.find(box) != std::string::npos);
    const std::string all = pliant::test::replaced(held, box, "box = [[0, 0, 0], [40, 10, 10]]");
    check_problem(all, "cannot change its volume: all of its wall is in a [[fixed]]");
    check_problem(all, "cannot change its length: all of its points are fixed in space or in a [[fixed]]");
    check_problem(pliant::test::replaced(good, box, "box = [[0, 0, 0], [40, 10, 10]]"), "cannot change its length");
    CHECK(problem(pliant::test::replaced(with("length_ratio = 0.97", "tension = \"1 N\""), box,
                                         "box = [[0, 0, 0], [40, 10, 10]]"))
              .empty());
}

TEST_CASE("chambers without air, or not closed, are refused") {
    check_problem(chamber("", "volume_ratio = 1.2"), "chamber[0]: takes one of geometry");
    check_problem(chamber(room + "\nsurface = \"air.stl\"", "volume_ratio = 1.2"), "takes one of geometry");
    check_problem(chamber("surface = \"nowhere.stl\"", "volume_ratio = 1.2"), "there is no file nowhere.stl");
    check_problem(chamber("region = \"air\"", "volume_ratio = 1.2"), "needs a tet mesh; add file = ");
    check_problem(chamber("geometri = { box = [[24, 3, 3], [36, 7, 7]] }", "volume_ratio = 1.2"),
                  "did you mean \"geometry\"?");
    check_problem(chamber("geometry = { box = [[36, 3, 3], [40, 7, 7]] }", "volume_ratio = 1.2"),
                  "bar.toml:39: chamber \"air\":");
    check_problem(chamber("geometry = { box = [[36, 3, 3], [40, 7, 7]] }", "volume_ratio = 1.2"),
                  "the chamber is open; close it with a body");
    // The same mouth is closed where a support holds it still, and open again where the support turns.
    const std::string mouth = "geometry = { box = [[0, 3, 1], [6, 7, 4]] }";
    CHECK(problem(chamber(mouth, "volume_ratio = 1.2")).empty());
    const std::string box = "box = [[0, 0, 0], [0, 10, 10]]";
    std::string turning = chamber(mouth, "volume_ratio = 1.2");
    turning.insert(turning.find(box), "rotate = { angle = 5, axis = [1, 0, 0] }\n");
    check_problem(turning, "let its mouth lie in a [[fixed]] without move or rotate");
}

TEST_CASE("a misspelt material, parameter or shape in an assignment is an error, and an unused material a remark") {
    const auto set = [](const std::string& assignment) { return problem(good, {assignment}); };
    CHECK(set("material.softt.youngs_modulus=2 MPa") ==
          "--set material.softt: the file has no material \"softt\", and nothing would use it; did you mean "
          "\"soft\"?");
    CHECK(set("parameters.lenght=3").starts_with("--set parameters.lenght: the file has no parameter \"lenght\""));
    CHECK(set("shape.notch={ sphere = { center = [0, 0, 0], radius = 1 } }").starts_with("--set shape.notch: "));
    // What another assignment uses may be new.
    CHECK(problem(good, {"material.other.youngs_modulus=2 MPa", "body.0.material=other"}).empty());
    CHECK(problem(good, {"parameters.ratio=0.95", "cable.flexor.target.length_ratio== ratio"}).empty());
    CHECK(problem(good, {"material.\"ru.b\".youngs_modulus=2 MPa", "body.0.material=ru.b"}).empty());
    const auto robot = parse_robot(good + "[material.sofd]\nyoungs_modulus = \"2 MPa\"\n", "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(unused_materials(*robot) ==
          std::vector<std::string>{"no body uses material \"sofd\"; did you mean \"soft\"?"});
}

TEST_CASE("moduli and densities that overflow are refused at their key") {
    CHECK(problem(good, {"material.soft.youngs_modulus=1e300 GPa"}).find("material.soft.youngs_modulus: ") !=
          std::string::npos);
    CHECK(problem(good, {"material.soft.density=1e200 kg/m^3"})
              .find("material.soft.density: 1e+200 kg/m^3 is not "
                    "possible") != std::string::npos);
    CHECK(problem(good, {"material.soft={ law = \"yeoh\", c10 = \"1e300 Pa\" }"}).find("material.soft.c10: ") !=
          std::string::npos);
}

TEST_CASE("a number that is none is one problem") {
    const std::string found = problem(good, {"cable.flexor.target.length_ratio=nan"});
    CHECK(found.find("cable[0].target.length_ratio: is ") != std::string::npos);
    CHECK(found.find('\n') == std::string::npos);
}

TEST_CASE("a body's own size is used where it is larger than that of the mesh, or where the mesh has none") {
    const auto tets = [](const std::string& mesh, const std::string& size) {
        return build_text("name = \"two\"\nlength_unit = \"mm\"\n" + mesh +
                          "[material.soft]\nyoungs_modulus = \"1 MPa\"\n"
                          "[[body]]\nname = \"a\"\nmaterial = \"soft\"\n" +
                          size +
                          "geometry = { box = [[0, 0, 0], [20, 20, 20]] }\n"
                          "[[fixed]]\nname = \"c\"\nbox = [[0, 0, 0], [20, 20, 0]]\n")
            .model.mesh()
            .tet_count();
    };
    const std::size_t coarse = tets("mesh = { size = \"10 mm\" }\n", "");
    CHECK(tets("", "size = \"10 mm\"\n") == coarse);
    CHECK(tets("mesh = { size = \"4 mm\" }\n", "size = \"10 mm\"\n") < 2 * coarse);
    CHECK(tets("mesh = { size = \"4 mm\" }\n", "") > 4 * coarse);
}

TEST_CASE("loads that are too small to be carried beside a very stiff material are reported") {
    const auto pulled = [](const std::string& force) {
        return run_text(
            "name = \"two\"\nlength_unit = \"mm\"\nmesh = { size = \"4 mm\" }\n"
            "[material.hard]\nyoungs_modulus = \"200 GPa\"\n"
            "[material.soft]\nyoungs_modulus = \"1 kPa\"\n"
            "[[body]]\nname = \"a\"\nmaterial = \"hard\"\n"
            "geometry = { box = [[0, 0, 0], [10, 10, 10]] }\n"
            "[[body]]\nname = \"b\"\nmaterial = \"soft\"\n"
            "geometry = { box = [[10, 0, 0], [20, 10, 10]] }\n"
            "[[fixed]]\nname = \"c\"\nbox = [[0, 0, 0], [0, 10, 10]]\n"
            "[[load]]\nname = \"pull\"\nbox = [[20, 0, 0], [20, 10, 10]]\nforce = [\"" +
            force + "\", \"0 N\", \"0 N\"]\n[program]\nsteps = 1\n");
    };
    CHECK(pulled("20 mN").warnings.empty());
    const std::vector<std::string> warnings = pulled("1e-6 mN").warnings;
    REQUIRE(warnings.size() == 1);
    CHECK(warnings[0].starts_with("from step 1 on the loads are not carried: "));
}

TEST_CASE("what a target may not ask for, its keys, its offset and its range may not either") {
    const auto keyed = [](const std::string& name, const std::string& value) {
        return test::replaced(good, "steps = 3\n",
                              "steps = 3\n[[program.key]]\ntime = \"2 s\"\n" + name + " = \"" + value + "\"\n");
    };
    const auto air = [](const std::string& target) {
        return "[[chamber]]\nname = \"air\"\n" + room + "\ntarget = { " + target + " }\n";
    };
    check_problem(keyed("air", "-300 kPa") + air("pressure = \"1 kPa\""),
                  "chamber \"air\": program.key at 2 s: a pressure of -300 kPa is below a vacuum");
    check_problem(good + air("pressure = \"-100 kPa\", offset = \"-5 kPa\""),
                  "chamber \"air\": a pressure of -105 kPa with its offset is below a vacuum");
    check_problem(good + air("pressure = \"10 kPa\", offset = \"-105 kPa\"") + "range = [\"0 kPa\", \"10 kPa\"]\n",
                  "chamber \"air\": target.offset: a pressure of -105 kPa with its offset is below a vacuum");
    check_problem(keyed("air", "-200 mm^3") + air("volume_change = \"0 ml\""),
                  "chamber \"air\": program.key at 2 s: cannot lose 0.2 ml, it holds 0.192 ml");
    check_problem(good + air("volume_ratio = 0.5, offset = \"-100 mm^3\""),
                  "chamber \"air\": cannot lose 0.196 ml with its offset, it holds 0.192 ml");
    const auto cable = [](const std::string& text, const std::string& target) {
        return test::replaced(text, "target = { length_ratio = 0.97 }", "target = { " + target + " }");
    };
    check_problem(cable(keyed("flexor", "41 mm"), "shortening = \"1 mm\""),
                  "cable \"flexor\": program.key at 2 s: cannot be shortened by 41 mm, it is 40 mm long");
    check_problem(cable(good, "shortening = \"36 mm\", offset = \"-5 mm\""),
                  "cable \"flexor\": cannot be shortened by 41 mm with its offset, it is 40 mm long");
    check_problem(cable(good, "length_ratio = 0.1, offset = \"-5 mm\""),
                  "cable \"flexor\": cannot be shortened by 41 mm with its offset, it is 40 mm long");
    CHECK(problem(cable(keyed("flexor", "39 mm"), "shortening = \"1 mm\"")) == "");
    CHECK(problem(cable(good, "tension = \"1 N\", offset = \"-2 N\"")) == "");  // slack at first
}

TEST_CASE("a chamber outside every body, and chambers that overlap, are refused by name") {
    for (const char* target : {"volume_ratio = 1.2", "pressure = \"1 kPa\"", "gas_ratio = 2"}) {
        const std::string outside = chamber("geometry = { box = [[50, 3, 3], [56, 7, 7]] }", target);
        check_problem(outside, "bar.toml:39: chamber \"air\": lies outside every body");
    }
    const std::string second =
        "[[chamber]]\nname = \"more\"\ngeometry = { box = [[30, 4, 3], [38, 6, 6]] }\ntarget.volume_ratio = 1.1\n";
    check_problem(chamber(room, "volume_ratio = 1.2") + second,
                  "chamber \"air\": overlaps chamber \"more\", or touches it without a wall between them, between "
                  "(30, 4, 3) and (36, 6, 6)");
    check_problem(chamber(room, "volume_ratio = 1.2") + second, "chamber \"more\": overlaps chamber \"air\"");
}

TEST_CASE("a plane of symmetry closes a chamber: half a robot inflates like the whole one") {
    const auto balloon = [](const std::string& low, const std::string& supports) {
        return "name = \"balloon\"\nlength_unit = \"mm\"\nmesh = { size = \"4 mm\" }\n"
               "[material.soft]\nyoungs_modulus = \"1 MPa\"\n"
               "[[body]]\nname = \"skin\"\nmaterial = \"soft\"\ngeometry = { box = [[" +
               low + ", 0, 0], [20, 12, 12]] }\n" + supports +
               "[[fixed]]\nname = \"end\"\nbox = [[20, 0, 0], [20, 12, 12]]\n"
               "[[chamber]]\nname = \"air\"\ngeometry = { box = [[" +
               (low == "0" ? "0" : "-14") + ", 3, 3], [14, 9, 9]] }\ntarget = { pressure = \"60 kPa\" }\n" +
               "[[marker]]\nname = \"side\"\npoint = [0, 6, 12]\n[program]\nsteps = 2\n";
    };
    const std::string roller = "[[fixed]]\nname = \"middle\"\nplane = { point = [0, 0, 0], normal = [1, 0, 0] }\n";
    const std::string other_end = "[[fixed]]\nname = \"start\"\nbox = [[-20, 0, 0], [-20, 12, 12]]\n";
    const sim::Step half = last_step(build_text(balloon("0", roller + "directions = \"normal\"\n")));
    const sim::Step whole = last_step(build_text(balloon("-20", other_end)));
    const double grown = half.chambers[0].volume_ratio - 1;
    CHECK(grown > 0.05);
    CHECK(half.chambers[0].volume_m3 == near(0.5 * whole.chambers[0].volume_m3, {.relative = 0.02 * grown}));
    CHECK(half.markers[0].position_m.z - 12e-3 == near(whole.markers[0].position_m.z - 12e-3, {.relative = 0.03}));
    // A support that holds another direction does not close it.
    check_problem(balloon("0", roller + "directions = [\"y\"]\n"), "the chamber is open");
}

TEST_CASE("a pressure load acts on the faces in its box") {
    const std::string load = "[[load]]\nname = \"push\"\nbox = [[40, 0, 0], [40, 10, 10]]\n";
    const Built built = build_text(good + load + "pressure = \"2 kPa\"\n", {"cable.flexor.target.length_ratio=1"});
    CHECK(built.robot.loads[0].pressure_Pa == near(2e3, {.relative = 1e-12}));
    CHECK(built.model.description().loads.empty());
    REQUIRE(built.model.description().pressures.size() == 1);
    // 100 mm^2, pressed towards the clamp.
    CHECK(last_step(built).supports[0].force_N.x == near(0.2, {.relative = 0.01}));

    check_problem(good + load + "pressure = \"2 kPa\"\nforce = [\"0 N\", \"0 N\", \"1 N\"]\n",
                  "give either force or pressure");
    check_problem(good + load, "\"force\" is missing; it is a list such as [\"0 N\", \"0 N\", \"0.06 N\"] (or give");
    check_problem(good + load + "pressure = \"2 N\"\n", "unknown unit \"N\"");
}

TEST_CASE("a support rotates in degrees, about an axis through a point in the file's unit") {
    const std::string box = "box = [[0, 0, 0], [0, 10, 10]]";
    const Built built = build_text(with(box, box + "\nrotate = { angle = 90, axis = [2, 0, 0], center = [0, 5, 5] }"));
    const sim::Support& clamp = built.model.description().supports[0];
    const Vec3 turned = clamp.position({0, 0.010, 0.005}, 1);
    CHECK(norm(turned - Vec3{0, 0.005, 0.010}) < 1e-12);
    const Vec3 half = clamp.position({0, 0.010, 0.005}, 1.0 / 3);
    CHECK(half.z == near(0.005 + 0.005 * 0.5, {.relative = 1e-12}));  // sin 30
    CHECK(clamp.moves());

    check_problem(with(box, box + "\nrotate = { angle = 90 }"), "fixed[0].rotate: \"axis\" is missing");
    check_problem(with(box, box + "\nrotate = { axis = [1, 0, 0] }"), "fixed[0].rotate: \"angle\" is missing");
    check_problem(with(box, box + "\nrotate = { angle = 90, axis = [0, 0, 0] }"), "must not be zero");
    check_problem(with(box, box + "\nrotate = { angle = \"90 deg\", axis = [1, 0, 0] }"), "a finite number is needed");
    check_problem(with(box, box + "\nrotate = { angle = 90, axis = [1, 0, 0], centre = [0, 0, 0] }"),
                  "did you mean \"center\"?");
}

TEST_CASE("keys set what they name, with times in seconds; everything else ramps to its target") {
    const std::string keys = R"(duration = "4 s"
[[program.key]]
time = "1 s"
flexor = 0.9
[[program.key]]
time = "3 s"
flexor = 0.98
air = "10 kPa"
gravity = 0.5
)";
    const Built built =
        build_text(with("steps = 3\n", "steps = 3\ngravity = [0, 0, -9.81]\n" + keys) +
                   "[[chamber]]\nname = \"air\"\n" + room + "\ntarget = { pressure = \"40 kPa\" }\n" +
                   "[[load]]\nname = \"push\"\nbox = [[40, 0, 0], [40, 10, 10]]\npressure = \"2 kPa\"\n");
    CHECK(built.robot.program.duration == 4);
    const sim::Description& d = built.model.description();
    const auto flexor = [&](double t) { return d.cables[0].target.at(t); };
    CHECK(flexor(0) == near(1, {.relative = 1e-12}));
    CHECK(flexor(0.5) == near(0.95, {.relative = 1e-12}));
    CHECK(flexor(1) == near(0.9, {.relative = 1e-12}));
    CHECK(flexor(2) == near(0.94, {.relative = 1e-12}));
    CHECK(flexor(4) == near(0.98, {.relative = 1e-12}));  // stays where the last key left it
    CHECK(d.chambers[0].target.at(1.5) == near(5e3, {.relative = 1e-12}));
    CHECK(d.chambers[0].target.at(4) == near(10e3, {.relative = 1e-12}));
    CHECK(d.gravity_share.at(3) == near(0.5, {.relative = 1e-12}));
    CHECK(d.pressures[0].share.at(1) == near(0.25, {.relative = 1e-12}));  // no key names it
    CHECK(d.pressures[0].share.at(4) == near(1, {.relative = 1e-12}));
}

TEST_CASE("a program without duration ends with its last key") {
    const Result<Robot> robot =
        parse_robot(good + "[[program.key]]\ntime = \"0 s\"\nflexor = 0.99\n[[program.key]]\ntime = \"500 ms\"\n", "b");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->program.duration == 0.5);
    CHECK(robot->cables[0].target.at(0) == near(0.99, {.relative = 1e-12}));  // a key at time 0 says where it starts
}

TEST_CASE("mistakes in keys are named") {
    const auto key = [](const std::string& lines) { return good + "[[program.key]]\n" + lines + "\n"; };
    check_problem(key("time = \"1 s\"\nflexxor = 0.9"),
                  "program.key[0].flexxor: unknown key; did you mean \"flexor\"?");
    check_problem(key("flexor = 0.9"), "program.key[0]: \"time\" is missing");
    check_problem(key("time = 1\nflexor = 0.9"), "1 has no unit; write a time such as");
    check_problem(key("time = \"1 s\"\nflexor = 12"), "12 is not possible: above 0, at most 10");
    check_problem(key("time = \"1 s\"\nflexor = \"8 N\""), "a finite number is needed");
    check_problem(key("time = \"2 s\"\n[[program.key]]\ntime = \"1 s\""), "program.key[1].time: times must increase");
    check_problem(with("steps = 3\n", "steps = 3\nduration = \"1 s\"\n[[program.key]]\ntime = \"2 s\"\nflexor = 0.9\n"),
                  "duration: ends before the last key");
    check_problem(with("steps = 3\n", "steps = 3\nduration = \"0 s\"\n"), "duration: must be above zero");
    std::string twice = key("time = \"1 s\"\n[[program.key]]\ntime = \"2 s\"\nclamp = 0.9");
    const std::string name = "name = \"flexor\"";
    check_problem(twice.replace(twice.find(name), name.size(), "name = \"clamp\""),
                  "program.key[1].clamp: names two things; give them different names");
    const std::string air = "[[chamber]]\nname = \"air\"\n" + room + "\ntarget = { pressure = \"1 kPa\" }\n";
    check_problem(key("time = \"1 s\"\nair = 3") + air, "3 has no unit; write a pressure such as");
    check_problem(key("time = \"1 s\"\nair = \"3 N\"") + air, "unknown unit \"N\"");
    const std::string sealed = "[[chamber]]\nname = \"air\"\n" + room + "\ntarget = { gas_ratio = 2 }\n";
    check_problem(key("time = \"1 s\"\nair = 0") + sealed, "0 is not possible; it must be above zero");
}

TEST_CASE("bodies of a mesh file are regions, or parts of them in a box") {
    const MeshFile file;
    const Built whole = build_text(file.robot(region("all", "soft", "region = \"all\"")));
    const double total = mesh::volume(whole.model.mesh());
    CHECK(total == near(1e-9 * (4000 - 100), {.relative = 1e-12}));

    // The box takes its tets from the body before it.
    const std::string end = region("end", "hard", "region = \"right\"\nbox = [[30, -1, -1], [41, 11, 11]]");
    const Built split = build_text(
        file.robot(region("left", "hard", "region = \"left\"") + region("right", "soft", "region = \"right\"") + end));
    const mesh::TetMesh& mesh = split.model.mesh();
    CHECK(mesh::volume(mesh, 0) == near(1e-9 * (2000 - 100), {.relative = 1e-12}));
    CHECK(mesh::volume(mesh, 1) + mesh::volume(mesh, 2) == near(1e-9 * 2000, {.relative = 1e-12}));
    CHECK(mesh::volume(mesh, 2) == near(1e-9 * 1000, {.relative = 0.05}));  // to the nearest tet
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (mesh.region[t] == 0) continue;
        Vec3 centroid;
        for (std::size_t i = 0; i < 4; ++i) centroid += 0.25 * mesh.points[static_cast<std::size_t>(mesh.tet(t)[i])];
        CHECK((centroid.x > 0.030) == (mesh.region[t] == 2));
    }
    CHECK(split.model.description().material_of_region == std::vector<int>{1, 0, 1});

    const std::string left = region("left", "hard", "region = \"left\"");
    check_problem(file.robot(left), "no body names region \"right\" of the mesh");
    check_problem(file.robot(left + region("right", "soft", "region = \"wrong\"")),
                  "the mesh has no region \"wrong\"; it has");
    check_problem(file.robot(region("all", "soft", "region = \"all\"") +
                             region("end", "hard", "region = \"all\"\nbox = [[50, 0, 0], [60, 10, 10]]")),
                  "body \"end\": the box holds no centroid of a tetrahedron of the region");
    check_problem(file.robot(left + left), "two bodies named \"left\"");
    check_problem(file.robot(left + region("again", "soft", "region = \"left\"")),
                  "region \"left\" already belongs to body \"left\"");
    check_problem(file.robot(region("all", "soft", "geometry = { box = [[0, 0, 0], [1, 1, 1]] }")),
                  "with a mesh file a body names its region");
    check_problem(with("geometry = { box = [[20, 0, 0], [40, 10, 10]] }",
                       "geometry = { box = [[20, 0, 0], [40, 10, 10]] }\nbox = [[20, 0, 0], [40, 10, 10]]"),
                  "body[1].box: unknown key");
}

TEST_CASE("a geometry file given as a robot is recognised as one; a robot file with a mistake is not") {
    const pliant::test::Folder folder("robot_drawing");
    const auto message = [&](const std::string& name, const std::string& content) {
        std::ofstream(folder / name, std::ios::binary) << content;
        const auto robot = load_robot(folder / name);
        REQUIRE_FALSE(robot);
        return robot.error().message;
    };
    for (const char* content : {"solid x\nfacet normal 0 0 1\n", "ISO-10303-21;\n"})
        CHECK(message("part.stl", content).find("is geometry, not a robot file") != std::string::npos);
    CHECK(message("part.3mf", "PK\x03\x04...").find("is a zip archive, such as a job; a robot file is needed here") !=
          std::string::npos);
    std::string binary = std::string(80, ' ') + std::string("\x64\0\0\0", 4);  // 100 facets
    binary += std::string(100 * 50, '\0');
    CHECK(message("part.stl", binary).find("is geometry, not a robot file") != std::string::npos);
    CHECK(message("robot.toml", "# \u00e9l\u00e9phant\nname = \n").find("not valid TOML") != std::string::npos);
}

TEST_CASE("a guide point just outside the mesh is carried and counted, one farther away is refused") {
    const std::string outside = with("points = [[0, 5, 8], [40, 5, 8]]", "points = [[0, 5, 8], [40.4, 5, 8]]");
    const Built built = build_text(outside);
    const auto& notes = built.model.description().notes;
    REQUIRE(notes.size() == 1);
    // The cable's two ends, where it leaves the body, and the flanks of the notch.
    CHECK_MESSAGE(notes[0].find("1 of 5 guide points lie outside the mesh, by up to 0.4 mm") == 0, notes[0]);
    CHECK(problem(outside, {"mesh.point_reach=0 mm"}).find("lies outside every body, by 0.4 mm") != std::string::npos);
    CHECK(problem(outside, {"mesh.point_reach=0.5 mm"}).empty());
    CHECK(problem(outside, {"mesh.point_reach=-1 mm"}).find("must not be below zero") != std::string::npos);
    CHECK(build_text(good).model.description().notes.empty());
}

TEST_CASE("a note tells where supports hold every node of the bodies") {
    const std::string all = "fixed = [{ name = \"all\", box = [[-1, -1, -1], [9, 9, 9]] }]\n";
    const std::string bar = R"(name = "sheet"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.4 }
body = [{ name = "sheet", material = "soft", geometry = { box = [[0, 0, 0], [8, 8, 1]] } }]
mesh = { size = "3 mm", order = 1 }
)";
    const Built built = build_text(bar + all);
    const auto& notes = built.model.description().notes;
    REQUIRE(notes.size() == 1);
    CHECK(notes[0] == "the supports hold every node of the bodies: nothing in them can bend or move");
    const std::string bottom = "fixed = [{ name = \"bottom\", box = [[-1, -1, -1], [9, 9, 0.2]] }]\n";
    CHECK(build_text(bar + bottom).model.description().notes.empty());
}

TEST_CASE("a support along a line is refused at rest, and allowed as a pendulum in dynamics") {
    const std::string hinge = with("box = [[0, 0, 0], [0, 10, 10]]", "box = [[0, 0, 0], [0, 10, 0]]");
    check_problem(hinge, "bar.toml: body \"left\" can turn freely about the line through (0, ");
    CHECK(problem(hinge, {"program.time_step=0.01 s"}).find("turn freely") == std::string::npos);
}

TEST_CASE("an imperfection is read as a length") {
    const Result<Robot> robot = parse_robot(good, "bar.toml", {"program.imperfection=0.1 mm"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->program.imperfection_m == near(1e-4, {.relative = 1e-12}));
    CHECK(problem(good, {"program.imperfection=-1 mm"}).find("must not be below zero") != std::string::npos);
}
