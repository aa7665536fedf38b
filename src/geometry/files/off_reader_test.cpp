#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/files/test_surfaces.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::mesh::test::surface_problem;
using pliant::test::replaced;

namespace {

SurfaceFile read_off(std::string_view text) {
    Result<SurfaceFile> file = parse_surface(text, "a.off");
    REQUIRE_MESSAGE(file, (file ? "" : file.error().message));
    return *file;
}

/// A cube of edge 2: one face with four corners, the others split into triangles, comments and colours.
const std::string off = R"(# made by hand
OFF
# counts
8 7 18
0 0 0
2 0 0  # a corner
2 2 0

0 2 0
0 0 2
2 0 2
2 2 2
0 2 2
4 0 3 2 1
4 4 5 6 7 255 0 0
4  0 1 5 4  # side
4 1 2 6 5 0.5 0.5 0.5 1
4 2 3 7 6
3 3 0 4
3 3 4 7
)";

}  // namespace

TEST_CASE("OFF: polygons, colours and comments") {
    const SurfaceFile file = read_off(off);
    CHECK(file.mesh.points.size() == 8);
    CHECK(file.mesh.triangles.size() == 12);
    CHECK(file.warnings.empty());
    CHECK(check_closed(file.mesh));
    CHECK(signed_volume(file.mesh) == near(8, {.relative = 1e-12}));
    // Counts on the keyword's line, without the number of edges; other line ends; a byte order mark.
    CHECK(signed_volume(read_off(replaced(off, "OFF\n# counts\n8 7 18", "OFF 8 7")).mesh) ==
          near(8, {.relative = 1e-12}));
    for (const char* end : {"\r\n", "\r"}) {
        std::string text = "\xEF\xBB\xBF";
        for (const char c : off) text += c == '\n' ? std::string(end) : std::string(1, c);
        CHECK(signed_volume(read_off(text).mesh) == near(8, {.relative = 1e-12}));
    }
}

TEST_CASE("OFF: additional data of vertices are ignored") {
    const std::string tet = "4 4 6\n0 0 0 {}\n1 0 0 {}\n0 1 0 {}\n0 0 1 {}\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    for (const auto& [keyword, more] : {std::pair{"OFF", ""},
                                        {"COFF", "255 0 0 255"},
                                        {"NOFF", "0 0 1"},
                                        {"CNOFF", "0 0 1 1 1 1 1"},
                                        {"STOFF", "0.5 0.5"},
                                        {"STCNOFF", "0 0 1 1 1 1 1 0 1"}}) {
        CAPTURE(keyword);
        std::string text = std::string(keyword) + "\n" + tet;
        for (std::size_t at = text.find("{}"); at != std::string::npos; at = text.find("{}")) text.replace(at, 2, more);
        CHECK(signed_volume(read_off(text).mesh) == near(1.0 / 6, {.relative = 1e-12}));
    }
}

TEST_CASE("OFF: edges and points among the faces are counted, not read") {
    std::string text = replaced(off, "8 7 18", "8 9 18");
    const SurfaceFile file = read_off(text + "2 0 1\n1 0\n");
    REQUIRE(file.warnings.size() == 1);
    CHECK(file.warnings[0] == "a.off: 2 face(s) of fewer than three corners were passed over");
}

TEST_CASE("OFF: broken files give a reason with the line") {
    CHECK(surface_problem(replaced(off, "4 2 3 7 6", "4 2 3 7 8")) ==
          "a:18: a face names vertex 8, there are 8 (the first is 0)");
    CHECK(surface_problem(replaced(off, "4 2 3 7 6", "4 2 3 7 -1")).find("names vertex -1") != std::string::npos);
    CHECK(surface_problem(replaced(off, "2 2 0\n", "2 2 nan\n")).find("a:7: \"nan\" is not a finite number") == 0);
    CHECK(surface_problem(replaced(off, "8 7 18", "8000000000000 7 18")).find("more than the file can hold") !=
          std::string::npos);
    CHECK(surface_problem(replaced(off, "8 7 18", "8 8 18")).find("the file ends") != std::string::npos);
    CHECK(surface_problem(replaced(off, "4 2 3 7 6", "9000000000 2 3 7 6")).find("more than the file can hold") !=
          std::string::npos);
    CHECK(surface_problem("OFF BINARY\n\x01\x02").find("binary OFF") != std::string::npos);
    CHECK(surface_problem("OFF BINARY\n" + std::string(8, '\0')).find("binary OFF") != std::string::npos);
    CHECK(surface_problem("4OFF\n1 1 1\n").find("three dimensions") != std::string::npos);
    CHECK(surface_problem("nOFF 3\n1 1 1\n").find("three dimensions") != std::string::npos);
    CHECK(surface_problem("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n").find("holds no faces") != std::string::npos);
    CHECK(surface_problem("OFFICE\n").find("not a surface that Pliant reads") != std::string::npos);
    for (std::size_t length = 0; length < off.size() - 10; ++length)
        CHECK_FALSE(parse_surface(off.substr(0, length), "a"));
}
