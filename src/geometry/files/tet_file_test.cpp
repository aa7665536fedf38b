#include "geometry/files/tet_file.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cstdint>

#include "base/core/near.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/mesh/test_tets.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

TetMesh oddly_named_tets() {
    return mesh::test::two_tets("soft foam 50%", "grip");
}

std::string vtk_problem(std::string_view text) {
    const Result<TetMesh> mesh = parse_vtk(text, "a.vtk");
    return mesh ? "" : mesh.error().message;
}

template <class Number>
void put_big_endian(std::string& bytes, Number value) {
    std::array<char, sizeof(Number)> raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
    bytes.append(raw.rbegin(), raw.rend());  // big endian
}

const std::string head = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";

}  // namespace

TEST_CASE("linear and quadratic meshes are read back as written") {
    for (const TetMesh& mesh : {oddly_named_tets(), to_quadratic(oddly_named_tets())}) {
        const Result<TetMesh> back = parse_vtk(vtk_bytes(mesh, Encoding::text), "a.vtk");
        REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
        CHECK(back->order == mesh.order);
        CHECK(back->points.size() == mesh.points.size());
        CHECK(volume(*back) == near(volume(mesh), {.relative = 1e-12}));
        CHECK(back->region == mesh.region);
        CHECK(back->region_names == mesh.region_names);
        CHECK(back->notes.empty());
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            for (std::size_t a = 0; a < mesh.tet(t).size(); ++a)
                CHECK(back->points[back->tet(t)[a]] == mesh.points[mesh.tet(t)[a]]);
        }
    }
}

TEST_CASE("names of regions are read back, whatever their characters and length") {
    TetMesh mesh = oddly_named_tets();
    for (const std::string& name : {std::string("a, b"), std::string("100%,\n\xc3\xa9"), std::string(400, 'n')}) {
        mesh.region_names[1] = name;
        const Result<TetMesh> back = parse_vtk(vtk_bytes(mesh, Encoding::text), "a.vtk");
        REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
        CHECK(back->region_names == mesh.region_names);
    }
}

TEST_CASE("binary files, other cells, unused points and inverted tets are read") {
    std::string bytes = "# vtk DataFile Version 2.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n";
    for (const Vec3& p : {Vec3{9, 9, 9}, Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{8, 8, 8}}) {
        for (const double c : {p.x, p.y, p.z}) put_big_endian(bytes, c);
    }
    bytes += "\nCELLS 3 11\n";
    for (const std::int32_t i : {1, 0, 3, 1, 2, 3, 4, 1, 3, 2, 4})
        put_big_endian(bytes, i);  // vertex, triangle, inverted tet
    bytes += "\nCELL_TYPES 3\n";
    for (const std::int32_t type : {1, 5, 10}) put_big_endian(bytes, type);
    bytes += "\nCELL_DATA 3\nSCALARS material int 1\nLOOKUP_TABLE default\n";
    for (const std::int32_t value : {0, 0, 7}) put_big_endian(bytes, value);
    const Result<TetMesh> mesh = parse_vtk(bytes, "a.vtk");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->points.size() == 4);
    CHECK(mesh->tet_count() == 1);
    CHECK(volume(*mesh) == near(1.0 / 6, {.relative = 1e-12}));
    CHECK(mesh->region_names == std::vector<std::string>{"7"});
    CHECK(mesh->notes == std::vector<std::string>{"1 of 1 tets were inside out and were turned"});
}

TEST_CASE("version 5 files store offsets and connectivity separately") {
    const std::string text =
        "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"
        "METADATA\nINFORMATION 0\n\nCELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 "
        "3\nCELL_TYPES 1\n10\n";
    const Result<TetMesh> mesh = parse_vtk(text, "a.vtk");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume(*mesh) == near(1.0 / 6, {.relative = 1e-12}));
}

TEST_CASE("an inside-out quadratic tet keeps its mid-edge nodes at their edges") {
    TetMesh mesh = to_quadratic(oddly_named_tets());
    // Mirror the node order of a tet: corners 1 and 2, and the edges at them.
    std::swap(mesh.nodes[1], mesh.nodes[2]);
    std::swap(mesh.nodes[4], mesh.nodes[6]);
    std::swap(mesh.nodes[8], mesh.nodes[9]);
    const Result<TetMesh> back = parse_vtk(vtk_bytes(mesh, Encoding::text), "a.vtk");
    REQUIRE(back);
    for (std::size_t t = 0; t < back->tet_count(); ++t) {
        const auto n = back->tet(t);
        CHECK(signed_tet_volume(back->points[n[0]], back->points[n[1]], back->points[n[2]], back->points[n[3]]) > 0);
        for (std::size_t e = 0; e < 6; ++e) {
            const Vec3 middle = 0.5 * (back->points[n[edge_corners[e][0]]] + back->points[n[edge_corners[e][1]]]);
            CHECK(norm(back->points[n[4 + e]] - middle) < 1e-12);
        }
    }
}

TEST_CASE("damaged files give a reason with the line, and stated sizes are not trusted") {
    CHECK(vtk_problem("hello").find("not a legacy VTK file") != std::string::npos);
    CHECK(vtk_problem(head).find("holds no tetrahedra") != std::string::npos);
    CHECK(vtk_problem(head + "POINTS 4000000000000 double\n1 2 3\n").find("a.vtk:") == 0);
    CHECK(vtk_problem(head + "POINTS 2 double\n0 0 0 1 0\n").find("ends") != std::string::npos);
    CHECK(vtk_problem(head + "POINTS 1 double\n0 zero 0\n").find("\"zero\" is not a number") != std::string::npos);
    CHECK(vtk_problem(head + "POINTS 1 double\n0 inf 0\n").find("not finite") != std::string::npos);
    CHECK(vtk_problem(head + "POINTS 4 double\n0 0 0 1e200 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n")
              .find("point 1 lies at (1e+200, 0, 0): coordinates go up to 1e30") != std::string::npos);
    const std::string points = head + "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n";
    CHECK(vtk_problem(points + "CELLS 1 5\n4 0 1 2 9\nCELL_TYPES 1\n10\n").find("names point 9") != std::string::npos);
    CHECK(vtk_problem(points + "CELLS 1 5\n9 0 1 2 3\nCELL_TYPES 1\n10\n").find("runs past the end") !=
          std::string::npos);
    CHECK(vtk_problem(points + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n").find("has 3 nodes") != std::string::npos);
    CHECK(vtk_problem(points + "CELLS 1 5\n4 0 1 2 3\n").find("0 cell types") != std::string::npos);
    CHECK(vtk_problem(points + "GARBAGE\n").find("\"GARBAGE\" is not understood") != std::string::npos);
}

TEST_CASE("an unknown file extension is refused when writing") {
    CHECK(write_tet_mesh("/tmp/a.xyz", oddly_named_tets()).error().message.find(".vtk, .vtu, .msh, .mesh or .inp") !=
          std::string::npos);
}

TEST_CASE("unused attributes are ignored: colours, tables, texts, texture coordinates") {
    const std::string text = head +
                             "FIELD FieldData 2\nnotes 1 2 string\nfirst one\nsecond%20one\nTIME 1 1 double\n0.5\n"
                             "POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"
                             "POINT_DATA 4\nCOLOR_SCALARS c 3\n0 0 0 1 1 1 0 0 0 1 1 1\nTEXTURE_COORDINATES t 2 "
                             "float\n0 0 0 0 0 0 0 0\nSCALARS p float 1\nLOOKUP_TABLE mine\n1 2 3 4\nLOOKUP_TABLE mine "
                             "2\n0 0 0 1 1 1 1 1\nCELL_DATA 1\nSCALARS region int\nLOOKUP_TABLE default\n3\n";
    const Result<TetMesh> mesh = parse_vtk(text, "a.vtk");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->region_names == std::vector<std::string>{"3"});
}

TEST_CASE("names in binary files come with their length") {
    std::string bytes = "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\n";
    bytes += "region_names 1 2 string\n";
    bytes += static_cast<char>(0xC4);  // one byte: length 4
    bytes += "foam";
    bytes += std::string{static_cast<char>(0x80), static_cast<char>(0x46)};  // two bytes: length 70
    bytes += std::string(70, 'g') + "\nPOINTS 4 float\n";
    for (const float c : {0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F}) put_big_endian(bytes, c);
    bytes += "\nCELLS 1 5\n";
    for (const std::int32_t i : {4, 0, 1, 2, 3}) put_big_endian(bytes, i);
    bytes += "\nCELL_TYPES 1\n";
    put_big_endian(bytes, std::int32_t{10});
    bytes += "\nCELL_DATA 1\nSCALARS region int 1\nLOOKUP_TABLE default\n";
    put_big_endian(bytes, std::int32_t{1});
    const Result<TetMesh> mesh = parse_vtk(bytes, "a.vtk");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->region_names == std::vector<std::string>{std::string(70, 'g')});
    for (std::size_t length = 0; length < bytes.size(); ++length) (void)parse_vtk(bytes.substr(0, length), "a.vtk");
}
