#include "geometry/mesh/mesh_report.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/open/describe_file.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

TetMesh one_tet(const std::vector<Vec3>& points) {
    TetMesh mesh;
    mesh.points = points;
    mesh.nodes = {0, 1, 2, 3};
    mesh.region = {0};
    mesh.region_names = {"a"};
    return mesh;
}

/// The description of a file with this content, lengths times `factor`.
std::string described(std::string_view bytes, double factor = 1) {
    const pliant::test::Folder folder("mesh_report");
    REQUIRE(write_file(folder / "nameless", bytes));
    const Result<std::string> text = describe_mesh_file(folder / "nameless", factor);
    return text ? *text : text.error().message;
}

}  // namespace

TEST_CASE("a regular tet has quality 1 and dihedral angles of acos(1/3)") {
    const MeshReport report = report_on(one_tet({{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}));
    CHECK(report.worst_quality == near(1, {.relative = 1e-12}));
    CHECK(report.min_dihedral_deg == near(std::acos(1.0 / 3) * 180 / std::numbers::pi, {.relative = 1e-12}));
    CHECK(report.regions.front().volume == near(8.0 / 3, {.relative = 1e-12}));
}

TEST_CASE("a corner of a cube has angles of 90 degrees and acos(1/sqrt 3), and a longest edge of sqrt 2") {
    const MeshReport report = report_on(one_tet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    CHECK(report.worst_quality == near(0.5, {.relative = 1e-12}));  // 6 sqrt 2 (1/6) / (2 sqrt 2)
    CHECK(report.min_dihedral_deg == near(54.7356, {.relative = 1e-5}));
}

TEST_CASE("the text names size, regions and quality; an empty mesh has a report too") {
    const std::string text = report_text(report_on(one_tet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})));
    CHECK(text.find("4 nodes, 1 linear tet, 1 x 1 x 1") == 0);
    CHECK(text.find("region \"a\": 1 tet, volume 0.166667") != std::string::npos);
    CHECK(report_on({}).tets == 0);
}

TEST_CASE("a file is described by its content, with notes on what was wrong") {
    const TetMesh inside_out = one_tet({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}});
    const std::string tets = described(vtk_bytes(inside_out, Encoding::text));
    CHECK(tets.find("4 nodes, 1 linear tet, 1 x 1 x 1") == 0);
    CHECK(tets.find("\n  note: 1 of 1 tets were inside out and were turned") != std::string::npos);
    CHECK(described("v 0 0 0\nv 2 0 0\nv 0 3 0\nf 1 2 3\n").find("surface, 3 points, 1 triangle, volume unknown") == 0);
    const std::string open =
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    CHECK(described(open).find("note: ") != std::string::npos);
}

namespace {

/// Boxes as OFF, without the last `missing` triangles.
std::string boxes_off(const std::vector<Box3>& boxes, std::size_t missing = 0) {
    constexpr std::array<std::array<int, 3>, 12> faces = {{{0, 2, 1},
                                                           {0, 3, 2},
                                                           {4, 5, 6},
                                                           {4, 6, 7},
                                                           {0, 1, 5},
                                                           {0, 5, 4},
                                                           {1, 2, 6},
                                                           {1, 6, 5},
                                                           {2, 3, 7},
                                                           {2, 7, 6},
                                                           {3, 0, 4},
                                                           {3, 4, 7}}};
    const std::size_t count = 12 * boxes.size() - missing;
    std::string text = fmt::format("OFF\n{} {} 0\n", 8 * boxes.size(), count);
    for (const Box3& box : boxes) {
        for (int k = 0; k < 8; ++k)
            text += fmt::format("{} {} {}\n", (k + 1) / 2 % 2 == 0 ? box.low.x : box.high.x,
                                k / 2 % 2 == 0 ? box.low.y : box.high.y, k < 4 ? box.low.z : box.high.z);
    }
    for (std::size_t f = 0; f < count; ++f) {
        const int first = 8 * static_cast<int>(f / 12);
        const auto& [a, b, c] = faces[f % 12];
        text += fmt::format("3 {} {} {}\n", first + a, first + b, first + c);
    }
    return text;
}

bool has(const std::string& text, std::string_view words) {
    return text.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a surface that is open or flat has no volume, and one that cuts itself a doubtful one") {
    const Box3 box{{0, 0, 0}, {10, 8, 4}};
    CHECK(described(boxes_off({box})).find("surface, 8 points, 12 triangles, volume 320, 10 x 8 x 4") == 0);
    CHECK_FALSE(has(described(boxes_off({box})), "note: "));
    const std::string open = described(boxes_off({box}, 2));
    CHECK(has(open, "volume unknown"));
    CHECK(has(open,
              "note: the surface is open: 4 edges without a neighbour, and an area of about 32 is missing, of 272 "
              "in all; it has no volume"));
    const std::string flat = described(boxes_off({{{0, 0, 0}, {10, 8, 0}}}));
    CHECK(has(flat, "volume unknown"));
    CHECK(has(flat, "note: the surface is flat: it encloses no volume"));
    CHECK(has(described(boxes_off({box, {{7, 5, 1}, {12, 12, 9}}})),
              "note: the surface cuts or touches itself: the volume counts what lies in two of its parts twice"));
}

namespace {

/// A cube of edges 10 as OBJ: its faces, some left out, and others that are added. Corner 9 lies in the middle of the
/// edge from corner 1 to corner 2.
std::string cube_obj(std::size_t left_out, const std::string& added) {
    constexpr std::array<std::string_view, 12> faces = {"1 2 4", "1 4 3", "5 7 8", "5 8 6", "1 5 6", "1 6 2",
                                                        "3 4 8", "3 8 7", "1 3 7", "1 7 5", "2 6 8", "2 8 4"};
    std::string text;
    for (int k = 0; k < 8; ++k) text += fmt::format("v {} {} {}\n", k / 4 * 10, k / 2 % 2 * 10, k % 2 * 10);
    text += "v 0 0 5\n";
    for (std::size_t f = left_out; f < faces.size(); ++f) text += fmt::format("f {}\n", faces[f]);
    return text + added;
}

std::string all_again() {
    const std::string once = cube_obj(0, "");
    return cube_obj(0, once.substr(once.find('f')));
}

}  // namespace

TEST_CASE("damage that leaves the volume as it was drawn is named, and the volume told") {
    CHECK(has(described(cube_obj(0, "")), "volume 1000,"));
    CHECK_FALSE(has(described(cube_obj(0, "")), "note: "));
    const std::vector<std::pair<std::string, std::string>> damaged = {
        {all_again(), "is damaged (12 repeated triangles)"},
        {cube_obj(0, "f 1 2 4\n"), "is damaged (1 repeated triangle)"},
        {cube_obj(0, "f 1 9 2\n"), "is damaged (1 flat triangle)"},
        {cube_obj(0, "f 1 1 2\n"), "is damaged (1 flat triangle)"},
        {cube_obj(1, "f 1 9 4\nf 9 2 4\n"),
         "is damaged (3 open edges): no area is missing, but corners lie on edges of other triangles"}};
    for (const auto& [bytes, words] : damaged) {
        CHECK_MESSAGE(has(described(bytes), words), described(bytes));
        CHECK_MESSAGE(has(described(bytes), "volume 1000,"), described(bytes));
    }
    const std::string open = described(cube_obj(1, ""));
    CHECK_MESSAGE(has(open, "volume unknown"), open);
    CHECK_MESSAGE(has(open, "the surface is open: 3 edges"), open);
}

TEST_CASE("a report in another unit") {
    CHECK(has(described(boxes_off({{{0, 0, 0}, {10, 8, 4}}}), 25.4), "volume 5.24386e+06, 254 x 203.2 x 101.6"));
    const TetMesh tet = one_tet({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    CHECK(has(described(vtk_bytes(tet, Encoding::text), 10), "10 x 10 x 10"));
}

TEST_CASE("a file of unknown format is reported with all formats; a damaged one by its reader") {
    for (const std::string& junk : {std::string("hello"), std::string(200, 'x')}) {
        const std::string text = described(junk);
        CHECK(text.find("is not geometry that Pliant reads") != std::string::npos);
        for (const char* format : {".vtk", ".vtu", ".msh", ".stl", ".obj", ".ply"})
            CHECK_MESSAGE(text.find(format) != std::string::npos, format);
    }
    CHECK(described("").find("is empty") != std::string::npos);
    CHECK(described("# vtk DataFile Version 3.0\n").find("is no mesh") == std::string::npos);
    CHECK(described("solid a\nfacet\nnonsense\n").find("outer loop") != std::string::npos);
}
