// Supports in single directions, springs, loads by any selector, and meshes from files that are placed.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using namespace pliant::robot;
using pliant::test::replaced;
using testing::build_text;
using testing::Built;
using testing::check_problem;
using testing::last_step;

namespace {

const std::string block_head = R"(name = "block"
length_unit = "mm"
material.soft = { youngs_modulus = "100 kPa", poisson_ratio = 0.4 }
)";

/// An eighth of a block on three planes of symmetry, drawn out by a fifth.
const std::string eighth = block_head + R"(mesh = { size = "5 mm" }
body = [{ name = "block", material = "soft", geometry = { box = [[0, 0, 0], [10, 10, 10]] } }]
fixed = [
  { name = "x", plane = { point = [0, 0, 0], normal = [1, 0, 0] }, directions = "normal" },
  { name = "y", box = [[0, 0, 0], [10, 0, 10]], directions = ["y"] },
  { name = "z", box = [[0, 0, 0], [10, 10, 0]], directions = [[0, 0, -2]] },
  { name = "end", box = [[10, 0, 0], [10, 10, 10]], directions = ["x"], move = [2, 0, 0] },
]
marker = [{ name = "corner", point = [10, 10, 10] }]
program = { steps = 2, tolerance = 1e-6 }
)";

}  // namespace

TEST_CASE("rollers and symmetry planes hold single directions: a stretched block becomes thinner") {
    const sim::Step last = last_step(build_text(eighth));
    const Vec3 corner = last.markers[0].position_m;
    CHECK(corner.x == near(0.012, {.relative = 1e-9}));
    CHECK(corner.y == near(corner.z, {.relative = 1e-6}));
    CHECK(corner.y < 0.0096);
    CHECK(corner.y > 0.0090);
    CHECK(last.supports[3].force_N.x == near(-last.supports[0].force_N.x, {.relative = 1e-9}));
    CHECK(std::fabs(last.supports[3].force_N.y) < 1e-12);  // a roller has no force across
}

TEST_CASE("node numbers are those of the written mesh, with the air of a chamber, which no robot has") {
    const std::string cushion = block_head + R"(mesh = { size = "5 mm" }
body = [
  { name = "base", material = "soft", geometry = { box = [[0, 0, 0], [10, 10, 10]] } },
  { name = "end", material = "soft", geometry = { box = [[10, 0, 0], [20, 10, 10]] } },
]
chamber = [{ name = "air", geometry = { box = [[2, 2, 2], [18, 8, 8]] }, target = { volume_ratio = 1.1 } }]
fixed = [{ name = "clamp", nodes = [0] }]
program = { steps = 1 }
)";
    const Result<Robot> robot = parse_robot(cushion, "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const Result<mesh::TetMesh> whole = build_mesh(*robot, silent);
    REQUIRE_MESSAGE(whole, (whole ? "" : whole.error().message));
    std::vector<bool> has_material(whole->points.size(), false);
    for (std::size_t t = 0; t < whole->tet_count(); ++t) {
        for (const int node : whole->tet(t))
            if (whole->region[t] < 2) has_material[static_cast<std::size_t>(node)] = true;
    }
    const auto numbers_where = [&](const auto& wanted) {
        std::vector<std::size_t> numbers;
        for (std::size_t n = 0; n < whole->points.size(); ++n)
            if (wanted(n)) numbers.push_back(n);
        REQUIRE_FALSE(numbers.empty());
        return numbers;
    };
    const auto holding = [&](const std::vector<std::size_t>& numbers) {
        return replaced(cushion, "nodes = [0]", fmt::format("nodes = [{}]", fmt::join(numbers, ", ")));
    };
    const auto of_end = numbers_where([&](std::size_t n) { return has_material[n] && whole->points[n].x > 0.011; });
    const Built built = build_text(holding(of_end));
    const sim::Description& description = built.model.description();
    const std::vector<int>& held = description.supports.at(0).nodes;
    REQUIRE(held.size() == of_end.size());
    double farthest = 0;
    for (std::size_t i = 0; i < held.size(); ++i) {
        const Vec3& p = description.mesh.points[static_cast<std::size_t>(held[i])];
        farthest = std::max(farthest, norm(p - whole->points[of_end[i]]));
    }
    CHECK(farthest == 0);
    check_problem(holding(numbers_where([&](std::size_t n) { return !has_material[n]; })),
                  "lies in the air of a chamber or gap only");
    check_problem(holding({whole->points.size()}),
                  fmt::format("does not exist, the mesh has {}", whole->points.size()));
}

TEST_CASE("invalid directions are refused with their line") {
    check_problem(replaced(eighth, "directions = [\"y\"]", "directions = [\"w\"]"),
                  "bar.toml:8: fixed[1].directions: is \"normal\" or a list");
    check_problem(replaced(eighth, "directions = [\"y\"]", "directions = []"), "is \"normal\" or a list");
    check_problem(replaced(eighth, "directions = [\"y\"]", "directions = [[0, 0, 0]]"), "is \"normal\" or a list");
    check_problem(replaced(eighth, "directions = [\"y\"]", "directions = \"normal\""), "\"normal\" is that of a plane");
    check_problem(
        replaced(eighth, "directions = [\"x\"],", "directions = [\"x\"], rotate = { angle = 5, axis = [1,0,0] },"),
        "has no meaning together with rotate");
}

TEST_CASE("a spring holds a block against a load") {
    const std::string slider = replaced(eighth, "directions = [\"x\"], move = [2, 0, 0]", "directions = [\"x\"]");
    const std::string loose = replaced(slider, "  { name = \"x\", plane", "  # { name = \"x\", plane");
    const std::string sprung =
        replaced(loose, "  { name = \"end\"", "  # { name = \"end\"") +
        "[[spring]]\nname = \"s\"\npoints = [[10, 5, 5], [30, 5, 5]]\nanchor = \"last\"\nstiffness = \"0.05 N/mm\"\n"
        "[[load]]\nname = \"pull\"\nplane = { point = [0, 0, 0], normal = [1, 0, 0] }\nforce = [\"-0.1 N\", \"0 N\", "
        "\"0 N\"]\n";
    const sim::Step last = last_step(build_text(sprung));
    REQUIRE(last.springs.size() == 1);
    CHECK(last.springs[0].force_N == near(0.1, {.relative = 1e-5}));
    CHECK(last.springs[0].length_m == near(0.022, {.relative = 1e-5}));
    check_problem(replaced(sprung, "\"0.05 N/mm\"", "\"0.05 N\""), "unknown unit \"N\"; here the units are N/mm");
    check_problem(replaced(sprung, "anchor = \"last\"", "anchor = \"first\""), "point 2 at (30, 5, 5) lies outside");
    check_problem(replaced(sprung, "anchor", "free_length = \"-1 mm\"\nanchor"), "must not be negative");
}

TEST_CASE("a load acts on the outer faces that its selector chooses") {
    const std::string pull = "[[load]]\nname = \"pull\"\nforce = [\"0.1 N\", \"0 N\", \"0 N\"]\n";
    const auto nodes = [&](const std::string& place) {
        return build_text(eighth + pull + place).model.description().loads.at(0).nodes;
    };
    const auto box = nodes("box = [[10, 0, 0], [10, 10, 10]]\n");
    CHECK(nodes("plane = { point = [10, 0, 0], normal = [-1, 0, 0] }\n") == box);
    CHECK(nodes("sphere = { center = [17, 5, 5], radius = 9.95 }\n") == box);
    CHECK(nodes("sphere = { center = [0, 0, 0], radius = 100 }\n").size() > box.size());
    check_problem(eighth + pull + "sphere = { center = [5, 5, 5], radius = 1 }\n", "no face of the outer surface");
    check_problem(eighth + pull,
                  "names no place; add box, plane, sphere, surface, nodes, point, points, line, plate or object");
    check_problem(eighth + pull + "surface = \"nowhere.stl\"\n", "there is no file");
}

TEST_CASE("a load leaves out the walls of chambers and cavities, unless its selector holds nothing else") {
    const auto all_at = [](const std::string& body, const std::string& chamber, const std::string& load,
                           double height) {
        const std::string text = block_head + R"(mesh = { size = "4 mm", order = 1 }
fixed = [{ name = "floor", box = [[0, 0, 0], [10, 10, 0]] }]
body = [{ name = "block", material = "soft", geometry = )" +
                                 body + " }]\n" + chamber + "load = [{ name = \"l\", pressure = \"1 kPa\", " + load +
                                 " }]\n";
        const Built built = build_text(text);
        const sim::Description& d = built.model.description();
        const sim::Wall& wall = d.pressures.at(0).wall;
        return std::ranges::all_of(wall.points, [&](const sim::Attachment& point) {
            const Vec3& p = d.mesh.points[static_cast<std::size_t>(point.nodes.at(0))];
            const double from_middle = std::max({std::fabs(p.x - 5e-3), std::fabs(p.y - 5e-3), std::fabs(p.z - 5e-3)});
            return std::fabs(from_middle - height) < 1e-9;
        });
    };
    const std::string solid = "{ box = [[0, 0, 0], [10, 10, 10]] }", hole = "{ box = [[3, 3, 3], [7, 7, 7]] }";
    const std::string hollow = "{ difference = [" + solid + ", " + hole + "] }";
    const std::string drawn =
        "chamber = [{ name = \"air\", target = { pressure = \"0 kPa\" }, geometry = " + hole + " }]\n";
    const std::string inside =
        "chamber = [{ name = \"air\", target = { pressure = \"0 kPa\" }, inside = [5, 5, 5] }]\n";
    const auto check = [&](const std::string& body, const std::string& chamber) {
        CHECK(all_at(body, chamber, "box = [[-1, -1, -1], [11, 11, 11]]", 5e-3));
        CHECK(all_at(body, chamber, "box = [[2, 2, 2], [8, 8, 8]]", 2e-3));
    };
    check(solid, drawn);
    check(hollow, inside);
    check(hollow, "");
}

TEST_CASE("mesh and surface files can be scaled, mirrored, rotated, moved and repeated") {
    const test::Folder folder("placed");
    const Built once = build_text(eighth);
    mesh::TetMesh unit = mesh::scaled(once.model.mesh(), 100);  // a cube of side 1 in the file's unit
    unit.region_names = {"block"};
    REQUIRE(mesh::write_tet_mesh(folder.path() / "cube.vtk", unit));
    const std::string place =
        "place = { scale = 10, mirror = { normal = [1, 0, 0] }, rotate = { angle = 90, axis = [0, 0, 1] }, "
        "move = [0, 0, 5], repeat = { count = 3, move = [20, 0, 0] } }";
    const std::string text = block_head + "mesh = { file = \"cube.vtk\", order = 1, " + place + " }\n" +
                             "body = [{ name = \"block\", material = \"soft\", region = \"all\" }]\n" +
                             "fixed = [{ name = \"floor\", box = [[-10, -10, 5], [100, 0, 5]] }]\n";
    const auto read = [&](const std::string& t) { return parse_robot(t, folder.path() / "block.toml"); };
    const Built built = testing::build(read(text));
    CHECK(mesh::volume(built.model.mesh()) == near(3e-6, {.relative = 1e-12}));
    Box3 box;
    for (const Vec3& p : built.model.mesh().points) box.add(p);
    // x -> -x, a quarter turn: (x, y) -> (-y, -x); three of them.
    CHECK(norm(box.low - Vec3{-0.01, -0.01, 0.005}) < 1e-9);
    CHECK(norm(box.high - Vec3{0.04, 0, 0.015}) < 1e-9);
    const auto message = [&](const std::string& t) {
        const auto robot = read(t);
        return robot ? std::string() : robot.error().message;
    };
    CHECK(message(replaced(text, "scale = 10", "scale = 0")).find("must be above zero") != std::string::npos);
    CHECK(message(replaced(text, "count = 3, move = [20, 0, 0]", "count = 3")).find("needs move or rotate") !=
          std::string::npos);
    CHECK(message(replaced(text, "count = 3", "count = 100000")).find("1 to 1000 are possible") != std::string::npos);
    CHECK(message(replaced(eighth, "[10, 10, 10]] } }]", "[10, 10, 10]] }, place = { scale = 2 } }]"))
              .find("a shape is placed by translate, rotate and repeat") != std::string::npos);
}

TEST_CASE("an obstacle that is a sheet is told, as are repairs in the files of obstacles and selectors") {
    const test::Folder folder("sheet");
    mesh::TriMesh lid = mesh::test::cube();
    REQUIRE(mesh::write_stl(folder.path() / "cube.stl", lid));
    for (auto& t : lid.triangles) std::swap(t[1], t[2]);
    REQUIRE(mesh::write_stl(folder.path() / "inverted.stl", lid));
    lid.triangles.resize(lid.triangles.size() - 1);
    REQUIRE(mesh::write_stl(folder.path() / "open.stl", lid));
    const std::string text = block_head + R"(mesh = { size = "10 mm", order = 1 }
body = [{ name = "block", material = "soft", geometry = { box = [[0, 0, 0], [1, 1, 1]] } }]
fixed = [{ name = "floor", surface = "inverted.stl" }]
obstacle = [{ name = "lid", surface = "cube.stl", place = { move = [0, 0, 2] } }]
)";
    const auto notes = [&](const std::string& file) {
        const Result<Robot> robot = parse_robot(replaced(text, "cube.stl", file), folder.path() / "block.toml");
        REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
        Progress silent;
        const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        return fmt::format("{}", fmt::join(mesh->notes, "\n"));
    };
    CHECK(notes("cube.stl").find("fixed \"floor\": ") != std::string::npos);
    CHECK(notes("cube.stl").find("obstacle") == std::string::npos);
    CHECK(notes("inverted.stl").find("obstacle \"lid\": ") != std::string::npos);
    CHECK(notes("inverted.stl").find("not closed") == std::string::npos);
    CHECK(notes("open.stl").find("obstacle \"lid\": its surface is not closed: 3 edges have no neighbour") !=
          std::string::npos);
}

TEST_CASE("surfaces of chambers and obstacles can be placed too") {
    const test::Folder folder("placed");
    REQUIRE(mesh::write_stl(folder.path() / "cube.stl", mesh::test::cube()));
    const std::string text = block_head + R"(mesh = { size = "4 mm", order = 1 }
body = [{ name = "block", material = "soft", geometry = { difference = [
    { box = [[0, 0, 0], [10, 10, 10]] }, { box = [[3, 3, 3], [7, 7, 7]] }] } }]
fixed = [{ name = "floor", box = [[0, 0, 0], [10, 10, 0]] }]
chamber = [{ name = "air", surface = "cube.stl", place = { scale = 0.4, move = [3, 3, 3] }, target = { volume_ratio = 1.1 } }]
obstacle = [{ name = "lid", surface = "cube.stl", place = { rotate = { angle = 90, axis = [1, 0, 0] }, move = [0, 10, 12] } }]
)";
    const std::string filled = replaced(text, "{ box = [[3, 3, 3], [7, 7, 7]] }", "{ box = [[3, 3, 3], [4, 4, 4]] }");
    const Result<Robot> robot = parse_robot(filled, folder.path() / "block.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const auto mesh = build_mesh(*robot, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    const auto refused = build_model(*robot, *mesh);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("98 % of the space in its surface is material") != std::string::npos);
    const Built built = testing::build(parse_robot(text, folder.path() / "block.toml"));
    const sim::Description& d = built.model.description();
    const sim::Wall& wall = d.chambers.at(0).wall;
    std::vector<double> x;
    for (const Vec3& p : d.mesh.points) x.insert(x.end(), {p.x, p.y, p.z});
    Box3 air;
    for (const sim::Attachment& point : wall.points) air.add(sim::position(point, x));
    CHECK(norm(air.low - Vec3{3e-3, 3e-3, 3e-3}) < 1e-9);
    CHECK(norm(air.high - Vec3{7e-3, 7e-3, 7e-3}) < 1e-9);
    const auto& lid = std::get<mesh::TriMesh>(d.contact->obstacles.at(0).body.shape);
    // (x, y, z) -> (x, -z, y), then moved.
    CHECK(norm(mesh::bounds(lid).low - Vec3{0, 0, 12e-3}) < 1e-9);
    CHECK(norm(mesh::bounds(lid).high - Vec3{10e-3, 10e-3, 22e-3}) < 1e-9);
}
