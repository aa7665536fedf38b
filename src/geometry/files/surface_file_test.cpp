#include "geometry/files/surface_file.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "base/core/near.hpp"
#include "geometry/files/test_surfaces.hpp"
#include "geometry/mesh/test_shapes.hpp"
#include "geometry/repair/surface_check.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::mesh::test::binary_stl;
using pliant::mesh::test::tetrahedron;

namespace {

std::string stl_problem(std::string_view bytes) {
    const Result<SurfaceFile> file = parse_stl(bytes, "a.stl");
    return file ? "" : file.error().message;
}

const std::string ascii = R"(solid name with facet normal vertex
facet normal nan nan nan
 outer loop
  vertex 0 0 0
  vertex 0 1.0e+0 0
  vertex 1 0 0
 endloop
endfacet
endsolid
)";

}  // namespace

TEST_CASE("a binary file is read back as written, with equal points joined") {
    const Result<SurfaceFile> file = parse_stl(binary_stl(tetrahedron()), "a.stl");
    REQUIRE(file);
    CHECK(file->warnings.empty());
    CHECK(file->mesh.points.size() == 4);
    CHECK(file->mesh.triangles.size() == 4);
    CHECK(signed_volume(file->mesh) == near(1.0 / 6, {.relative = 1e-12}));
    CHECK(check_closed(file->mesh));
}

TEST_CASE("binary files with small faults are read with a warning; others are refused with a reason") {
    std::string bytes = binary_stl(tetrahedron());
    std::string wrong_count = bytes;
    wrong_count[80] = 20;
    REQUIRE(parse_stl(wrong_count, "a.stl"));
    CHECK(parse_stl(wrong_count, "a.stl")->warnings.size() == 1);
    CHECK(parse_stl(wrong_count, "a.stl")->mesh.triangles.size() == 4);
    CHECK(parse_stl(bytes + std::string(37, 'x'), "a.stl")->warnings.size() == 1);
    std::string says_solid = bytes;
    std::memcpy(says_solid.data(), "solid box", 9);
    CHECK(parse_stl(says_solid, "a.stl")->mesh.triangles.size() == 4);
    std::string nan = bytes;
    const float value = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(nan.data() + 84 + 50 + 12, &value, 4);
    CHECK(stl_problem(nan) == "a.stl: facet 2: vertex 1 is not finite");
    CHECK(stl_problem("") == "a.stl: the file is empty");
    CHECK(stl_problem(std::string(84, '\0')).find("no facets") != std::string::npos);
    CHECK(stl_problem(bytes.substr(0, bytes.size() - 20)).find("announces 4 facets and has room for 3") !=
          std::string::npos);
    CHECK(stl_problem("hello").find("not an STL") != std::string::npos);
    CHECK(stl_problem(std::string(5000, 'h')).find("not an STL") != std::string::npos);
}

TEST_CASE("text STL is read in any case and with any line ends; errors name the line") {
    REQUIRE(parse_stl(ascii, "a.stl"));
    CHECK(parse_stl(ascii, "a.stl")->mesh.triangles.size() == 1);
    std::string shouting;
    for (const char c : ascii)
        shouting += c == '\n' ? std::string("\r\n") : std::string(1, static_cast<char>(std::toupper(c)));
    CHECK(parse_stl(shouting, "a.stl")->mesh.triangles.size() == 1);
    CHECK(parse_stl(ascii + ascii, "a.stl")->mesh.triangles.size() == 2);
    std::string missing = ascii;
    missing.replace(missing.find("  vertex 1 0 0\n"), 15, "");
    CHECK(stl_problem(missing) == "a.stl:6: \"vertex\" is needed here, a facet has three; found \"endloop\"");
    std::string word = ascii;
    word.replace(word.find("1.0e+0"), 6, "one");
    CHECK(stl_problem(word) == "a.stl:5: \"one\" is not a finite number");
    CHECK(stl_problem("solid empty\nendsolid empty\n").find("no facets") != std::string::npos);
    CHECK(stl_problem("solid x\n<html>").find("has no place here") != std::string::npos);
    CHECK(stl_problem(ascii.substr(0, 60)).find("a.stl:") == 0);
}

TEST_CASE("text STL with other line ends, on one line, or with words after endfacet is read") {
    const auto with_ends = [](const std::string& text, const char* end) {
        std::string result;
        for (const char c : text) result += c == '\n' ? std::string(end) : std::string(1, c);
        return result;
    };
    CHECK(parse_stl(with_ends(ascii + ascii, "\r"), "a.stl")->mesh.triangles.size() == 2);
    CHECK(parse_stl(with_ends(ascii, "\r"), "a.stl")->warnings.empty());
    std::string missing = ascii;
    missing.replace(missing.find("  vertex 1 0 0\n"), 15, "");
    for (const char* end : {"\r", "\r\n"})
        CHECK(stl_problem(with_ends(missing, end)) ==
              "a.stl:6: \"vertex\" is needed here, a facet has three; found \"endloop\"");
    std::string one_line = ascii.substr(ascii.find("facet normal nan"));
    one_line = "solid\n" + with_ends(one_line, " ") + with_ends(one_line, " ");
    one_line.replace(one_line.find("endsolid"), 8, "");
    CHECK(parse_stl(one_line, "a.stl")->mesh.triangles.size() == 2);
    std::string stray = ascii;
    stray.replace(stray.find("endfacet\n"), 9, "endfacet 7 attributes\n");
    const Result<SurfaceFile> file = parse_stl(stray + stray, "a.stl");
    REQUIRE(file);
    CHECK(file->mesh.triangles.size() == 2);
    REQUIRE(file->warnings.size() == 1);
    CHECK(file->warnings[0] == "a.stl: 4 word(s) after \"endfacet\" were passed over");
    stray.replace(stray.find(" attributes"), 1, "\n");
    CHECK(stl_problem(stray) == "a.stl:9: \"attributes\" has no place here; this is not a complete STL file");
}

TEST_CASE("open, inverted, doubled and empty surfaces are refused with the reason") {
    TriMesh open = tetrahedron();
    open.triangles.pop_back();
    CHECK(check_closed(open).error().message.find("3 edges have no neighbour") != std::string::npos);
    TriMesh inverted = tetrahedron();
    for (auto& t : inverted.triangles) std::swap(t[0], t[1]);
    CHECK(check_closed(inverted).error().message.find("inside out") != std::string::npos);
    TriMesh twice = tetrahedron();
    twice.triangles.push_back(twice.triangles.front());
    CHECK_FALSE(check_closed(twice));
    CHECK_FALSE(check_closed(TriMesh{}));
}
