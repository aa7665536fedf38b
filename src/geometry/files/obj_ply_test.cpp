#include <doctest/doctest.h>

#include <bit>
#include <cstdint>

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

/// A cube of edge 2 with square faces.
const std::string obj = R"(# a cube
mtllib none.mtl
o cube
v 0 0 0
v 2 0 0
v 2 2 0 1.0
v 0 2 0
v 0 0 2
v 2 0 2
v 2 2 2
v 0 2 2
vn 0 0 1
f 1 4 3 2
f 5//1 6//1 7//1 8//1
f 1/1/1 2/1/1 6/1/1 5/1/1
f 2 3 7 6 # side
f 3 4 8 7
f -8 -4 -1 -5
)";

const std::string ply_head = R"(element vertex 4
property float x
property float y
property uchar red
property double z
element edge 1
property list uchar short ends
element face 4
property list uchar int vertex_indices
end_header
)";

/// A tetrahedron of volume 1/6.
const std::string ply = "ply\nformat ascii 1.0\ncomment made by hand\n" + ply_head +
                        "0 0 255 0\n1 0 255 0\n0 1 255 0\n0 0 255 1\n2 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

template <class Number>
void put(std::string& bytes, Number value, bool big_endian) {
    const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    if (big_endian)
        bytes.append(raw.rbegin(), raw.rend());
    else
        bytes.append(raw.begin(), raw.end());
}

std::string binary_ply(bool big_endian) {
    std::string bytes =
        std::string("ply\nformat binary_") + (big_endian ? "big" : "little") + "_endian 1.0\n" + ply_head;
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        put(bytes, static_cast<float>(p.x), big_endian);
        put(bytes, static_cast<float>(p.y), big_endian);
        put(bytes, std::uint8_t{255}, big_endian);
        put(bytes, p.z, big_endian);
    }
    put(bytes, std::uint8_t{2}, big_endian);
    for (const std::int16_t end : {0, 1}) put(bytes, end, big_endian);
    for (const auto& face : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
        put(bytes, std::uint8_t{3}, big_endian);
        for (const std::int32_t corner : face) put(bytes, corner, big_endian);
    }
    return bytes;
}

}  // namespace

TEST_CASE("OBJ: polygons and all kinds of corners are read, and everything else is ignored") {
    const Result<SurfaceFile> file = parse_surface(obj, "a.obj");
    REQUIRE_MESSAGE(file, (file ? "" : file.error().message));
    CHECK(file->mesh.points.size() == 8);
    CHECK(file->mesh.triangles.size() == 12);
    CHECK(check_closed(file->mesh));
    CHECK(signed_volume(file->mesh) == near(8, {.relative = 1e-12}));
}

TEST_CASE("OBJ: a backslash continues a line, but not a comment or a name") {
    std::string text = replaced(obj, "f 1 4 3 2", "f 1 4 \\\n 3\\\n2");
    text = replaced(text, "v 2 2 0 1.0", "v 2 \\\r\n 2 0 \\\n 1.0");
    text = replaced(text, "# a cube", "# from C:\\drawings\\");
    text = replaced(text, "o cube", "o C:\\cube\\");
    text = replaced(text, "# side", "# side \\");
    const Result<SurfaceFile> file = parse_surface(text, "a.obj");
    REQUIRE_MESSAGE(file, (file ? "" : file.error().message));
    CHECK(file->mesh.triangles.size() == 12);
    CHECK(signed_volume(file->mesh) == near(8, {.relative = 1e-12}));
    // Lines are counted correctly after a continuation.
    CHECK(surface_problem(replaced(text, "f 3 4 8 7", "f 3 4 8 9")) ==
          "a:21: a face names vertex 9, there are 8 so far");
    std::string old_mac;
    for (const char c : obj) old_mac += c == '\n' ? '\r' : c;
    CHECK(signed_volume(parse_surface(old_mac, "a.obj")->mesh) == near(8, {.relative = 1e-12}));
    CHECK(surface_problem("v 1 2 3\\").find("not a finite number") != std::string::npos);
    CHECK(surface_problem("v 0 0 0\nf 1 1 \\\n").find("a face has 2 corners") != std::string::npos);
}

TEST_CASE("OBJ: broken files give a reason with the line") {
    CHECK(surface_problem(replaced(obj, "f 2 3 7 6", "f 2 3 7 9")) ==
          "a:16: a face names vertex 9, there are 8 so far");
    CHECK(surface_problem(replaced(obj, "f 2 3 7 6", "f 2 3 7 0")).find("names vertex 0") != std::string::npos);
    CHECK(surface_problem(replaced(obj, "f 2 3 7 6", "f 2 3 7 -9")).find("names vertex -9") != std::string::npos);
    CHECK(surface_problem(replaced(obj, "f 2 3 7 6", "f 2 3")).find("a face has 2 corners") != std::string::npos);
    CHECK(surface_problem(replaced(obj, "f 2 3 7 6", "f 2 3 x")).find("\"x\" is not a corner") != std::string::npos);
    CHECK(surface_problem(replaced(obj, "v 2 0 0", "v 2 0 nan")).find("a:5: \"nan\" is not a finite number") == 0);
    CHECK(surface_problem("v 1 2 3\n").find("holds no faces") != std::string::npos);
}

TEST_CASE("PLY: text and bytes of both orders give the same surface") {
    for (const std::string& bytes : {ply, binary_ply(false), binary_ply(true)}) {
        const Result<SurfaceFile> file = parse_surface(bytes, "a.ply");
        REQUIRE_MESSAGE(file, (file ? "" : file.error().message));
        CHECK(file->mesh.points.size() == 4);
        CHECK(check_closed(file->mesh));
        CHECK(signed_volume(file->mesh) == near(1.0 / 6, {.relative = 1e-12}));
    }
}

TEST_CASE("PLY: damaged files give a reason, and stated sizes are not trusted") {
    CHECK(surface_problem(replaced(ply, "face 4", "face 4000000000000")).find("more than the file can hold") !=
          std::string::npos);
    CHECK(surface_problem(replaced(ply, "face 4", "face 5")).find("the file ends") != std::string::npos);
    CHECK(surface_problem(replaced(ply, "3 1 2 3", "3 1 2 4")).find("face 2 names vertex 4, there are 4") !=
          std::string::npos);
    CHECK(surface_problem(replaced(ply, "3 1 2 3", "2 1 2 3")).find("face 2 has 2 corners") != std::string::npos);
    CHECK(surface_problem(replaced(ply, "double z", "quad z")).find("unknown type \"quad\"") != std::string::npos);
    CHECK(surface_problem(replaced(ply, "format ascii 1.0\n", "")).find("names no format") != std::string::npos);
    CHECK(surface_problem(replaced(ply, "end_header\n", "end\n")).find("unknown keyword \"end\" in the PLY header") !=
          std::string::npos);
    CHECK(surface_problem(replaced(ply, "list uchar int", "list float int")).find("whole numbers") !=
          std::string::npos);
    const std::string bytes = binary_ply(false);
    for (std::size_t length = 4; length < bytes.size(); ++length)
        CHECK_FALSE(parse_surface(std::string_view(bytes).substr(0, length), "a.ply"));
}
