// Bodies from files, what touches, and the notches that cables cross.
#include <doctest/doctest.h>
#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_variable.hpp"
#include "base/zip/zip_file.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesher/mesher.hpp"
#include "robot/bodies/body_notes.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/scene/build_model.hpp"
#include "simulation/scene/test_run.hpp"

using namespace pliant;
using namespace pliant::robot;
using namespace pliant::robot::testing;
namespace fs = std::filesystem;

namespace {

struct Folder : pliant::test::Folder {
    [[nodiscard]] std::string file(const std::string& name) const { return (*this / name).string(); }
};

const std::string head = R"(name = "bar"
length_unit = "mm"
[material.soft]
youngs_modulus = "1 MPa"
poisson_ratio = 0.4
[mesh]
size = "5 mm"
order = 1
[[fixed]]
name = "clamp"
box = [[0, 0, 0], [0, 10, 10]]
)";

std::string body(const std::string& name, const std::string& geometry) {
    return fmt::format("[[body]]\nname = \"{}\"\nmaterial = \"soft\"\n{}\n", name, geometry);
}

/// A bar of 40 x 10 x 10 with two V notches, 4 mm wide at the top and 5 mm deep; `gap` is what fills one.
const std::string notch = "{ prism = [[-0.2, 5], [0.2, 5], [2, 10], [-2, 10]], plane = \"xz\", from = 0, to = 10 }";
const std::string two_notches =
    "{ repeat = 2, step = [14, 0, 0], of = { translate = [13, 0, 0], of = " + notch + " } }";
const double notch_mm3 = 0.5 * (0.4 + 4) * 5 * 10;

std::string notched(const std::string& cables) {
    return head +
           body("bar", "geometry = { difference = [{ box = [[0, 0, 0], [40, 10, 10]] }, " + two_notches + "] }") +
           "[[marker]]\nname = \"tip\"\npoint = [40, 5, 5]\n[program]\nsteps = 3\n" + cables;
}

std::string cable(const std::string& name, const std::string& points, const std::string& rest) {
    return fmt::format(
        "[[cable]]\nname = \"{}\"\npoints = {}\ntarget = {{ length_ratio = 0.96 }}\nmodel = \"gap-elements\"\n{}\n",
        name, points, rest);
}

double volume_mm3(const mesh::TetMesh& mesh, int region) {
    return 1e9 * mesh::volume(mesh, region);
}

/// Nodes that two regions have in common.
std::size_t shared_nodes(const mesh::TetMesh& mesh, int one, int other) {
    std::set<int> of_one;
    std::set<int> both;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (mesh.region[t] == one) of_one.insert(mesh.tet(t).begin(), mesh.tet(t).end());
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const int n : mesh.tet(t)) {
            if (mesh.region[t] == other && of_one.contains(n)) both.insert(n);
        }
    }
    return both.size();
}

/// Two cubes of 10 mm of two materials that share a face, as a 3MF file in inches.
void write_3mf(const std::string& path) {
    const auto object = [](int id, const std::string& name, int material, double from_mm) {
        std::string text =
            fmt::format("<object id=\"{}\" name=\"{}\" pid=\"1\" pindex=\"{}\"><mesh><vertices>", id, name, material);
        for (int i = 0; i < 8; ++i)
            text += fmt::format("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>", (from_mm + 10 * (i & 1)) / 25.4,
                                10 * (i >> 1 & 1) / 25.4, 10 * (i >> 2) / 25.4);
        text += "</vertices><triangles>";
        const int corners[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
        for (const auto& t : corners)
            text += fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>", t[0], t[1], t[2]);
        return text + "</triangles></mesh></object>";
    };
    const std::string model =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"inch\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><resources><basematerials id=\"1\">"
        "<base name=\"firm\" displaycolor=\"#FF0000\"/><base name=\"pliable\" "
        "displaycolor=\"#00FF00\"/></basematerials>" +
        object(2, "root", 0, 0) + object(3, "tip", 1, 10) +
        "</resources><build><item objectid=\"2\"/><item objectid=\"3\"/></build></model>";
    Result<ZipWriter> zip = ZipWriter::create(path);
    REQUIRE(zip);
    const auto add = [&](const std::string& name, const std::string& bytes) {
        REQUIRE(zip->add(name, bytes, ZipWriter::Method::deflate));
    };
    add("[Content_Types].xml",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Types "
        "xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
        "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
        "<Default Extension=\"model\" "
        "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>");
    add("_rels/.rels",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships "
        "xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
        "Target=\"/3D/3dmodel.model\" "
        "Id=\"rel0\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>");
    add("3D/3dmodel.model", model);
    REQUIRE(zip->close());
}

}  // namespace

TEST_CASE("notches that a cable crosses are filled on request, as if the gaps were drawn") {
    const std::string path = "[[0, 5, 9], [40, 5, 9]]";
    const Built filled = build_text(notched(cable("flexor", path, "fill_notches = true")));
    REQUIRE(filled.robot.gaps.size() == 1);
    const mesh::TetMesh& mesh = filled.model.mesh();
    REQUIRE(mesh.region_names.size() == 3);  // the bar and one region for each notch
    CHECK(volume_mm3(mesh, 0) == near(4000 - 2 * notch_mm3, {.relative = 1e-12}));
    CHECK(volume_mm3(mesh, 1) == near(notch_mm3, {.relative = 1e-12}));
    CHECK(volume_mm3(mesh, 2) == near(notch_mm3, {.relative = 1e-12}));
    CHECK(shared_nodes(mesh, 0, 1) > 10);
    REQUIRE(filled.model.description().growths.size() == 2);
    CHECK(filled.model.description().growths[0].direction.x == near(1, {.relative = 1e-12}));
    CHECK(filled.model.description().growths[0].material != filled.model.description().growths[1].material);

    const Built drawn =
        build_text(notched(cable("flexor", path, "") + "[[gap]]\nname = \"drawn\"\ngeometry = " + two_notches + "\n"));
    const sim::Step with_filled = last_step(filled);
    const sim::Step with_drawn = last_step(drawn);
    CHECK(with_filled.cables[0].length_ratio == near(0.96, {.relative = 1e-3}));
    const Vec3 tip = with_drawn.markers[0].position_m;
    CHECK(std::fabs(tip.z - 5e-3) > 1e-3);  // it has bent
    CHECK(norm(with_filled.markers[0].position_m - tip) < 0.1 * std::fabs(tip.z - 5e-3));

    Progress silent;
    const auto printed = body_surfaces(filled.robot, silent);
    REQUIRE(printed);
    CHECK(1e9 * mesh::signed_volume((*printed)[0].surface_m) == near(4000 - 2 * notch_mm3, {.relative = 1e-12}));
}

TEST_CASE("two cables share the notches that both cross, and each closes them along its own path") {
    const Built built = build_text(notched(cable("left", "[[0, 3, 9], [40, 3, 9]]", "fill_notches = true") +
                                           cable("right", "[[0, 7, 9], [22, 7, 9]]", "fill_notches = true")));
    CHECK(built.model.mesh().region_names.size() == 3);
    const auto& growths = built.model.description().growths;
    REQUIRE(growths.size() == 3);
    CHECK(growths[2].actuator == 1);
    CHECK(growths[2].material == growths[0].material);
}

TEST_CASE("gap elements take the weight of their gap, otherwise that of their cable") {
    const std::string path = "[[0, 5, 9], [40, 5, 9]]";
    const auto weight_Pa = [](const Built& built) { return built.model.description().growths.front().weight_Pa; };
    const double usual = weight_Pa(build_text(notched(cable("flexor", path, "fill_notches = true"))));
    const double twice = weight_Pa(build_text(notched(cable("flexor", path, "fill_notches = true\nweight = 0.2"))));
    CHECK(twice == near(2 * usual, {.relative = 1e-12}));
    const std::string gap = "[[gap]]\nname = \"drawn\"\ngeometry = " + two_notches + "\n";
    const double of_gap =
        weight_Pa(build_text(notched(cable("flexor", path, "weight = 0.2") + gap + "weight = 0.4\n")));
    CHECK(of_gap == near(4 * usual, {.relative = 1e-12}));
    check_problem(notched(cable("flexor", path, "fill_notches = true\nweight = 0")), "above 0 and at most 1000");
    check_problem(notched(cable("flexor", path, "fill_notches = true\nfriction = 0.1")), "has no guides");
    std::string length = notched(cable("flexor", path, "weight = 1"));
    length.replace(length.find("gap-elements"), 12, "length");
    check_problem(length, "act with model = \"gap-elements\" only");
}

TEST_CASE("air elements bend a robot nearly as far as air does; their weight is checked") {
    const auto hollow = [](const std::string& rest) {
        return head + body("bar", "geometry = { box = [[0, 0, 0], [30, 10, 10]] }") +
               "[[chamber]]\nname = \"air\"\ngeometry = { box = [[4, 2, 2], [26, 8, 5]] }\n"
               "target = { volume_ratio = 1.3 }\n" +
               rest + "[[marker]]\nname = \"tip\"\npoint = [30, 5, 5]\n[program]\nsteps = 3\n";
    };
    const auto tip = [&](const std::string& rest) {
        const sim::Step step = last_step(build_text(hollow(rest)));
        CHECK(step.chambers[0].volume_ratio == near(1.3, {.relative = 1e-4}));
        return step.markers[0].position_m - Vec3{30e-3, 5e-3, 5e-3};
    };
    const Vec3 air = tip(""), elements = tip("model = \"elements\"\n");
    CHECK(norm(elements - air) < 0.1 * norm(air));
    check_problem(hollow("model = \"elements\"\nweight = -1\n"), "above 0 and at most 1000");
    check_problem(hollow("weight = 1\n"), "act with model = \"elements\" only");
}

TEST_CASE("fill_notches reports what it cannot do") {
    const std::string flexor = "[[0, 5, 9], [40, 5, 9]]";
    check_problem(notched(cable("flexor", "[[0, 5, 2], [40, 5, 2]]", "fill_notches = true")), "finds none");
    std::string length = notched(cable("flexor", flexor, "fill_notches = true"));
    length.replace(length.find("gap-elements"), 12, "length");
    check_problem(length, "act with model = \"gap-elements\" only");
    check_problem(notched(cable("flexor", flexor, "")), "fill_notches = true makes one of the notches");
    check_problem(notched(cable("flexor", flexor, "fill_notches = true") +
                          "[[gap]]\nname = \"notches\"\ngeometry = " + two_notches + "\n"),
                  "belongs to what fill_notches fills");
    check_problem(notched(cable("flexor", flexor, "fill_notches = true") +
                          "[[gap]]\nname = \"drawn\"\ngeometry = " + two_notches + "\n"),
                  "is drawn as a [[gap]] or a chamber already");
}

TEST_CASE("materials of a 3MF file become bodies with a common face, in the file's own unit") {
    const Folder folder;
    const std::string path = folder.file("two.3mf");
    write_3mf(path);
    const std::string geometry = "geometry = \"" + path + "\"\n";
    const Built built =
        build_text(head + body("root", geometry + "part = \"firm\"") + body("tip", geometry + "part = \"tip\""));
    CHECK(volume_mm3(built.model.mesh(), 0) == near(1000, {.relative = 1e-12}));
    CHECK(volume_mm3(built.model.mesh(), 1) == near(1000, {.relative = 1e-12}));
    CHECK(shared_nodes(built.model.mesh(), 0, 1) >= 9);
    check_problem(head + body("root", geometry), "has several materials; one [[body]] each, with part = one of");
    check_problem(head + body("root", geometry + "part = \"lid\""), "has no part \"lid\"");
    check_problem(head + body("root", "geometry = { box = [[0, 0, 0], [1, 1, 1]] }\npart = \"lid\""),
                  "chooses from a STEP or 3MF file");
}

TEST_CASE("a body from STEP touches an STL body and a drawn one; a drawn chamber is cut out of both") {
    const Folder folder;
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::model::occ::addBox(0, 0, 0, 20, 10, 10);
    gmsh::model::occ::synchronize();
    gmsh::write(folder.file("root.step"));
    gmsh::finalize();
    const std::string drawn_tip = "geometry = { box = [[20, 0, 0], [40, 10, 10]] }";
    const std::string root = body("root", "geometry = \"" + folder.file("root.step") + "\"");
    Progress silent;
    const Result<Robot> only_tip = parse_robot(head + body("tip", drawn_tip), "bar.toml");
    REQUIRE(only_tip);
    const auto surfaces = body_surfaces(*only_tip, silent);
    REQUIRE(surfaces);
    REQUIRE(mesh::write_stl(folder.file("tip.stl"), mesh::scaled((*surfaces)[0].surface_m, 1000)));
    const std::string chamber =
        "[[chamber]]\nname = \"air\"\ngeometry = { box = [[15, 3, 3], [25, 7, 7]] }\ntarget = { volume_ratio = 1.1 }\n";
    for (const std::string& tip : {drawn_tip, "geometry = \"" + folder.file("tip.stl") + "\""}) {
        const Built built = build_text(head + root + body("tip", tip) + chamber);
        CHECK(volume_mm3(built.model.mesh(), 0) == near(2000 - 80, {.relative = 1e-12}));
        CHECK(volume_mm3(built.model.mesh(), 1) == near(2000 - 80, {.relative = 1e-12}));
        CHECK(shared_nodes(built.model.mesh(), 0, 1) >= 8);
        const auto printed = body_surfaces(built.robot, silent);
        REQUIRE(printed);
        for (const BodySurface& one : *printed)
            CHECK(1e9 * mesh::signed_volume(one.surface_m) == near(1920, {.relative = 1e-12}));
    }
    check_problem(head + body("root", "geometry = \"" + folder.file("root.step") + "\"\npart = \"lid\""),
                  "has no solid \"lid\"");
}

TEST_CASE(
    "notes on what is allowed but hardly meant: a cut beside the body, a size beyond it, a gap that nobody sees") {
    const auto notes_of = [](const std::string& bodies, const std::vector<std::string>& set) {
        const Result<Robot> robot = parse_robot(head + bodies, "bar.toml", set);
        REQUIRE(robot);
        Progress silent;
        const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
        REQUIRE(mesh);
        std::string notes;
        for (const std::string& note : mesh->notes) notes += note + "\n";
        return notes;
    };
    const auto has = [](const std::string& notes, std::string_view words) {
        return notes.find(words) != std::string::npos;
    };
    const std::string bar = body("bar", "geometry = { box = [[0, 0, 0], [40, 10, 10]] }");
    CHECK_FALSE(has(notes_of(bar, {}), "as long as the robot"));
    CHECK(has(notes_of(bar, {"mesh.size=5 m"}), "mesh.size, 5e+03, is 125 times as long as the robot, 40"));
    const auto cut = [&](const std::string& at) {
        return notes_of(body("bar", "geometry = { difference = [{ box = [[0, 0, 0], [40, 10, 10]] }, { box = [[" + at +
                                        ", 2, 2], [50, 8, 8]] }] }"),
                        {});
    };
    CHECK(has(cut("45"), "body \"bar\": a shape of a difference lies outside of what it is cut from"));
    CHECK_FALSE(has(cut("35"), "cut from"));
    const auto beside = [&](const std::string& x) {
        return bar + body("next", "geometry = { box = [[" + x + ", 0, 0], [60, 10, 10]] }");
    };
    CHECK(has(notes_of(beside("40.01"), {}), "body \"bar\" and \"next\" are 0.01 apart"));
    CHECK_FALSE(has(notes_of(beside("40.05"), {}), "apart"));
    CHECK_FALSE(has(notes_of(beside("40.01"), {"mesh.close_gaps=0 mm"}), "apart"));
}

TEST_CASE("an error of the mesher names the body concerned, otherwise the robot file") {
    const auto problem_of = [](const std::string& bodies) {
        const Result<Robot> robot = parse_robot(head + bodies, "bar.toml", {"mesh.size=0.8 mm"});
        REQUIRE(robot);
        Progress silent;
        const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
        REQUIRE_FALSE(mesh);
        return mesh.error().message;
    };
    const std::string bar = body("bar", "geometry = { box = [[0, 0, 0], [40, 10, 10]] }");
    const std::string lost = body("lost", "geometry = { box = [[1, 1, 1], [2, 2, 2]] }");
    CHECK(problem_of(lost + bar) == "bar.toml:12: body \"lost\" is empty: all of it belongs to later ones");
    const std::string apart = body("apart", "geometry = { box = [[50, 0, 0], [60, 10, 10]] }");
    CHECK(problem_of(apart + lost + bar).starts_with("bar.toml:16: body \"lost\" is empty"));
    const pliant::test::Variable soon("PLIANT_MESH_SECONDS", "1e-6");
    CHECK(problem_of(bar).starts_with("bar.toml: meshing took longer than 1e-06 s and was ended"));
}

namespace {

/// A box from `low` to `high`, every triangle with points of its own.
void add_box(mesh::TriMesh& soup, const Vec3& low, const Vec3& high, bool outwards) {
    const int corners[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (const auto& t : corners) {
        const int n = static_cast<int>(soup.points.size());
        for (const int i : t)
            soup.points.push_back(
                {(i & 1) != 0 ? high.x : low.x, (i >> 1 & 1) != 0 ? high.y : low.y, (i >> 2) != 0 ? high.z : low.z});
        soup.triangles.push_back(outwards ? std::array{n, n + 1, n + 2} : std::array{n, n + 2, n + 1});
    }
}

}  // namespace

TEST_CASE("an STL body with jittered corners and an inverted cavity is meshed; its chamber may be inverted too") {
    const Folder folder;
    mesh::TriMesh bar;
    add_box(bar, {0, 0, 0}, {40, 10, 10}, true);
    add_box(bar, {10, 3, 3}, {30, 7, 7}, true);
    for (std::size_t i = 0; i < bar.points.size(); i += 5)
        bar.points[i].x = static_cast<double>(std::nextafter(static_cast<float>(bar.points[i].x), 100.0F));
    REQUIRE(mesh::write_stl(folder.file("bar.stl"), bar));
    mesh::TriMesh air;
    add_box(air, {10, 3, 3}, {30, 7, 7}, false);
    REQUIRE(mesh::write_stl(folder.file("air.stl"), air));
    const std::string text = head + body("bar", fmt::format("geometry = \"{}\"", folder.file("bar.stl"))) +
                             fmt::format(
                                 "[[chamber]]\nname = \"air\"\nsurface = \"{}\"\n"
                                 "target = {{ volume_ratio = 1.1 }}\n",
                                 folder.file("air.stl"));
    const Result<Robot> robot = parse_robot(text, "bar.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume_mm3(*mesh, 0) == near(4000 - 320, {.relative = 1e-5}));
    REQUIRE(mesh->notes.size() >= 3);
    CHECK(mesh->notes[0].find("body \"bar\": ") == 0);
    CHECK(mesh->notes[0].find("were joined to it") != std::string::npos);
    CHECK(mesh->notes[1].find("turned into cavities") != std::string::npos);
    CHECK(mesh->notes.back().find("chamber \"air\": ") == 0);
    CHECK(mesh->notes.back().find("1 shell(s) inside out were turned outwards") != std::string::npos);
    CHECK(build_model(*robot, *mesh));
    const auto printed = body_surfaces(*robot, silent);
    REQUIRE(printed);
    CHECK((*printed)[0].notes.size() == 2);
    CHECK(1e9 * mesh::signed_volume((*printed)[0].surface_m) == near(3680, {.relative = 1e-5}));
}

TEST_CASE("who prints a round STL body gets the air of its chamber with it") {
    const Folder folder;
    const auto ball = [](double radius) {
        return std::make_shared<const mesh::SolidNode>(mesh::SolidNode{mesh::SphereSolid{{0, 0, 0}, radius}});
    };
    const Result<mesh::TriMesh> surface = mesh::tessellate(ball(20), 0.05);
    REQUIRE(surface);
    REQUIRE(mesh::write_stl(folder.file("ball.stl"), *surface));
    const Result<Robot> robot =
        parse_robot(head + body("ball", fmt::format("geometry = \"{}\"", folder.file("ball.stl"))) +
                        "[[chamber]]\nname = \"air\"\ngeometry = { sphere = { center = [0, 0, 0], radius = 10 } }\n"
                        "target = { volume_ratio = 1.1 }\n[[chamber]]\nname = \"far\"\ngeometry = { sphere = { center "
                        "= [0, 0, 90], "
                        "radius = 10 } }\ntarget = { volume_ratio = 1.1 }\n",
                    "ball.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const auto printed = body_surfaces(*robot, silent);
    REQUIRE_MESSAGE(printed, (printed ? "" : printed.error().message));
    REQUIRE((*printed)[0].air_m.size() == 1);
    CHECK(1e9 * mesh::signed_volume((*printed)[0].air_m[0]) == near(4000 * std::numbers::pi / 3, {.relative = 0.01}));
}

TEST_CASE("drawn bodies that overlap are told to who prints them in the words of the mesh") {
    const std::string block = head + body("block", "geometry = { box = [[0, 0, 0], [12, 12, 4]] }");
    const auto peg = [](double from) {
        return body(
            "peg",
            fmt::format("geometry = {{ cylinder = {{ from = [6, 6, {}], to = [6, 6, 8], radius = 3 }} }}", from));
    };
    const Result<Robot> robot = parse_robot(block + peg(0), "peg.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    Progress silent;
    const std::vector<std::string> notes = overlap_notes(*robot, silent);
    REQUIRE(notes.size() == 1);  // 9 pi x 4 mm^3
    CHECK(notes[0] ==
          "\"block\" and \"peg\" overlap in a volume of 113.097 (in the file's unit, cubed), which belongs to \"peg\", "
          "the later one");
    const Result<mesh::TetMesh> mesh = build_mesh(*robot, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(std::ranges::count(mesh->notes, notes[0]) == 1);
    const auto surfaces = body_surfaces(*robot, silent);
    REQUIRE(surfaces);
    CHECK((*surfaces)[0].chord_m == near(10e-6, {.relative = 1e-12}));
    const Result<Robot> touching = parse_robot(block + peg(4), "peg.toml");
    REQUIRE(touching);
    CHECK(overlap_notes(*touching, silent).empty());
}
