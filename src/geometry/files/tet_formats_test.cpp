// The formats other than VTK: written and read back, read as other programs write them, and damaged.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/tet_format.hpp"
#include "geometry/files/tet_writer.hpp"
#include "geometry/mesh/test_tets.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::test::replaced;

namespace {

/// Region names that are difficult in every format, and a coordinate that needs all digits.
TetMesh difficult_tets() {
    TetMesh mesh = mesh::test::two_tets("soft foam, 50%", "grip");
    mesh.points[3].z = 0.1;
    return mesh;
}

/// Mid-edge nodes off the midpoints, so that a wrong order is detected.
TetMesh curved_tets() {
    TetMesh mesh = to_quadratic(difficult_tets());
    for (std::size_t i = 5; i < mesh.points.size(); ++i) mesh.points[i].x += 0.003 * static_cast<double>(i);
    return mesh;
}

std::string tet_problem(std::string_view bytes) {
    const Result<TetMesh> mesh = parse_tet_mesh(bytes, "a");
    return mesh ? "" : mesh.error().message;
}

void check_same(const Result<TetMesh>& back, const TetMesh& mesh) {
    REQUIRE_MESSAGE(back, (back ? "" : back.error().message));
    CHECK(back->order == mesh.order);
    CHECK(back->region == mesh.region);
    CHECK(back->region_names == mesh.region_names);
    REQUIRE(back->nodes.size() == mesh.nodes.size());
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        CHECK(back->points[back->nodes[i]] == mesh.points[mesh.nodes[i]]);
    CHECK(back->notes.empty());
}

const std::string tetgen_nodes = "# a cube's corner\n4 3 1 0\n0 0 0 0 7\n1 1 0 0 7\n2 0 1 0 7\n3 0 0 1 7\n";
const std::string tetgen_tets = "1 4 1\n0 0 1 2 3 -4\n# end\n";

const std::string deck = R"(** made by hand
*HEADING
anything
*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
4, 0., 0., 1.D0
9, 1., 1., 1.
*ELEMENT, TYPE=S3, ELSET=SKIN
7, 1, 2, 3
*Element, type=C3D4, elset=Left
10, 1, 2,
3, 4
*ELEMENT, TYPE=C3D4
20, 2, 3, 4, 9
*ELSET, ELSET=both, GENERATE
10, 20, 10
*ELSET, ELSET=Right side
20
*MATERIAL, NAME=M
*ELASTIC
1., .3
)";

}  // namespace

TEST_CASE("every format is read back as written: linear and quadratic, text and binary") {
    for (const TetMesh& mesh : {difficult_tets(), curved_tets()}) {
        for (const Encoding encoding : {Encoding::binary, Encoding::text}) {
            check_same(parse_tet_mesh(vtk_bytes(mesh, encoding), "a"), mesh);
            check_same(parse_tet_mesh(msh_bytes(mesh, encoding), "a"), mesh);
        }
        check_same(parse_tet_mesh(medit_text(mesh), "a"), mesh);
        check_same(parse_tet_mesh(inp_text(mesh), "a"), mesh);
    }
}

TEST_CASE("a file of tets of 4 and 10 nodes becomes one quadratic mesh that shares its mid-edge nodes") {
    const std::string text =
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 1, 1, 1\n"
        "12, .5, 0, 0\n23, .6, .6, 0\n13, 0, .5, 0\n14, 0, 0, .5\n24, .5, 0, .5\n34, 0, .5, .5\n"
        "*ELEMENT, TYPE=C3D4, ELSET=plain\n1, 2, 3, 4, 5\n"
        "*ELEMENT, TYPE=C3D10, ELSET=round\n2, 1, 2, 3, 4, 12, 23, 13, 14, 24, 34\n";
    const Result<TetMesh> mesh = parse_tet_mesh(text, "a");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->order == 2);
    CHECK(mesh->tet_count() == 2);
    CHECK(mesh->points.size() == 5 + 9);  // the two tets share three of their 12 edges
    REQUIRE(mesh->notes.size() == 1);
    CHECK(mesh->notes.front() == "1 of 2 tets have 4 nodes and the others 10: all were given 10");
    for (std::size_t t = 0; t < 2; ++t) {
        const auto n = mesh->tet(t);
        const std::string& name = mesh->region_names[static_cast<std::size_t>(mesh->region[t])];
        CHECK(name == (t == 0 ? "plain" : "round"));
        for (std::size_t e = 0; e < 6; ++e) {
            const Vec3 a = mesh->points[n[edge_corners[e][0]]];
            const Vec3 b = mesh->points[n[edge_corners[e][1]]];
            const bool bent = norm(a + b - Vec3{1, 1, 0}) < 1e-12 && a.z == 0;
            CHECK(mesh->points[n[4 + e]] == (bent ? Vec3{.6, .6, 0} : 0.5 * (a + b)));
        }
    }
    CHECK(boundary_faces(*mesh).size() == 6);
}

TEST_CASE("a file's extension decides how it is written, its content how it is read") {
    const pliant::test::Folder folder("formats");
    for (const char* name : {"a.vtk", "a.vtu", "a.msh", "a.mesh", "a.inp", "B.VTK", "B.Mesh"}) {
        REQUIRE(write_tet_mesh(folder / name, curved_tets()));
        std::filesystem::rename(folder / name, folder / "nameless");
        check_same(read_tet_mesh(folder / "nameless"), curved_tets());
    }
    REQUIRE(write_file(folder / "t.1.node", tetgen_nodes));
    CHECK(read_tet_mesh(folder / "t.1.node").error().message.find("t.1.ele") != std::string::npos);
    REQUIRE(write_file(folder / "t.1.ele", tetgen_tets));
    for (const char* name : {"t.1.node", "t.1.ele"}) {
        const Result<TetMesh> mesh = read_tet_mesh(folder / name);
        REQUIRE(mesh);
        CHECK(mesh->region_names == std::vector<std::string>{"-4"});
    }
}

TEST_CASE("whether an extension can be written is known before there is a mesh") {
    for (const char* name : {"a.vtk", "a.vtu", "a.msh", "a.mesh", "a.inp", "B.VTK"})
        CHECK(check_tet_ending(name, Encoding::binary));
    for (const char* name : {"a", "a.xyz", "vtk"}) CHECK_FALSE(check_tet_ending(name, Encoding::binary));
    CHECK(check_tet_ending("a.msh", Encoding::text));
    CHECK_FALSE(check_tet_ending("a.inp", Encoding::text));
}

TEST_CASE("a byte order mark in front of a text is no part of it") {
    const pliant::test::Folder folder("marked");
    const std::string mark = "\xEF\xBB\xBF";
    for (const char* name : {"a.vtk", "a.msh", "a.mesh", "a.inp"}) {
        const bool two_forms = check_tet_ending(name, Encoding::text).has_value();
        REQUIRE(write_tet_mesh(folder / name, curved_tets(), two_forms ? Encoding::text : Encoding::binary));
        check_same(parse_tet_mesh(mark + read_file(folder / name).value(), "a"), curved_tets());
    }
    REQUIRE(write_file(folder / "t.node", mark + tetgen_nodes));
    REQUIRE(write_file(folder / "t.ele", mark + tetgen_tets));
    CHECK(read_tet_mesh(folder / "t.node"));
}

TEST_CASE("formats are recognised by their first words") {
    CHECK(tet_format(tetgen_nodes) == TetFormat::tetgen_nodes);
    CHECK(tet_format(tetgen_tets) == TetFormat::tetgen_tets);
    CHECK(tet_format(deck) == TetFormat::inp);
    CHECK(tet_format("# c\n\nMESH dimension 3 ElemType Tetrahedra Nnode 4\n") == TetFormat::gid);
    CHECK(tet_format("MeshVersionFormatted 1\nDimension\n3\n") == TetFormat::medit);
    CHECK(tet_format("MESHVersionUnformatted 1\n") == TetFormat::medit);
    CHECK_FALSE(tet_format("v 0 0 0\nf 1 2 3\n"));
    CHECK_FALSE(tet_format("solid MESH\n"));
    CHECK_FALSE(tet_format("12 numbers\n"));
    CHECK_FALSE(tet_format(std::string_view("*HEADING\0binary", 15)));
    CHECK_FALSE(tet_format(""));
}

TEST_CASE("TetGen: points count from 0 or 1, the attribute is the region, mid-edge nodes go where they lie") {
    const Result<TetMesh> mesh = parse_tetgen(tetgen_nodes, "a.node", tetgen_tets, "a.ele");
    REQUIRE(mesh);
    CHECK(volume(*mesh) == near(1.0 / 6, {.relative = 1e-12}));
    // Corners (0,0,0) (1,0,0) (0,1,0) (0,0,1); mid-edge nodes in an order that no format uses.
    const std::string nodes =
        "10 3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 .5 .5\n6 .5 0 .5\n7 .5 .5 0\n8 0 0 .5\n9 0 .5 0\n10 .5 0 0\n";
    const Result<TetMesh> ten = parse_tetgen(nodes, "a.node", "1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n", "a.ele");
    REQUIRE(ten);
    for (std::size_t e = 0; e < 6; ++e) {
        const Vec3 middle =
            0.5 * (ten->points[ten->tet(0)[edge_corners[e][0]]] + ten->points[ten->tet(0)[edge_corners[e][1]]]);
        CHECK(ten->points[ten->tet(0)[4 + e]] == middle);
    }
    const auto message = [](const std::string& points, const std::string& tets) {
        const auto bad = parse_tetgen(points, "a.node", tets, "a.ele");
        return bad ? std::string() : bad.error().message;
    };
    CHECK(message(tetgen_nodes, "1 4 1\n0 0 1 2 9 1\n")
              .find("a.ele:2: a tetrahedron refers to node 9, which does not exist") == 0);
    CHECK(message("4000000000 3 0 0\n", tetgen_tets).find("a.node:1: 4000000000 are announced") == 0);
    CHECK(message("2 3\n0 0 0 0\n0 1 1 1\n", tetgen_tets).find("a.node:4: point 0 comes twice") == 0);
    CHECK(message("1 2\n0 0 0\n", tetgen_tets).find("dimension 2") != std::string::npos);
    CHECK(message(tetgen_nodes, "1 6 0\n").find("6 nodes") != std::string::npos);
    CHECK(message(tetgen_nodes, "1 4 1\n0 0 1 2").find("file ends") != std::string::npos);
}

TEST_CASE("Abaqus: sections, then sets of element cards, then the smallest set give the region") {
    const Result<TetMesh> mesh = parse_inp(deck, "a.inp");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->region_names == std::vector<std::string>{"Left", "Right side"});
    CHECK(volume(*mesh, 0) == near(1.0 / 6, {.relative = 1e-12}));
    const auto sectioned = parse_inp(deck + "*SOLID SECTION, ELSET=BOTH, MATERIAL=M\n1.\n", "a.inp");
    REQUIRE(sectioned);
    CHECK(sectioned->region_names == std::vector<std::string>{"both"});
    const auto nested = parse_inp(deck + "*ELSET, ELSET=outer\nboth, outer\n*SOLID SECTION, ELSET=outer\n", "a.inp");
    REQUIRE(nested);
    CHECK(nested->region_names == std::vector<std::string>{"outer"});
}

TEST_CASE("Abaqus: long chains of element sets with sections are followed once; ranges may begin anywhere") {
    std::string chained = deck;
    constexpr int sets = 60000;
    for (int k = 0; k < sets; ++k)
        chained += fmt::format("*ELSET, ELSET=s{0}\n{1}\n*SOLID SECTION, ELSET=s{0}\n", k,
                               k + 1 < sets ? fmt::format("s{}", k + 1) : "both");
    const auto begin = std::chrono::steady_clock::now();
    const auto mesh = parse_inp(chained, "a.inp");
    REQUIRE(mesh);
    CHECK(mesh->region_names == std::vector<std::string>{"s0"});
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(10));
    const auto far = parse_inp(deck +
                                   "*ELSET, ELSET=all, GENERATE\n-9223372036854775808, 9223372036854775807, 2\n"
                                   "*SOLID SECTION, ELSET=all\n",
                               "a.inp");
    REQUIRE(far);
    CHECK(far->region_names == std::vector<std::string>{"all"});
}

TEST_CASE("Abaqus: node numbers at both ends of what a number can hold") {
    const auto far = parse_inp(
        "*NODE\n-9223372036854775808, 0, 0, 0\n9223372036854775807, 1, 0, 0\n-9223372036854775807, 0, 1, 0\n7, 0, 0, "
        "1\n"
        "*ELEMENT, TYPE=C3D4\n1, -9223372036854775808, 9223372036854775807, -9223372036854775807, 7\n",
        "a.inp");
    REQUIRE_MESSAGE(far, (far ? "" : far.error().message));
    CHECK(volume(*far) == near(1.0 / 6, {.relative = 1e-12}));
}

TEST_CASE("Abaqus: errors name the line") {
    CHECK(tet_problem(replaced(deck, "20, 2, 3, 4, 9", "20, 2, 3, 4, 5"))
              .find("a:16: element 20 refers to node 5, which does not exist") == 0);
    CHECK(tet_problem(replaced(deck, "20, 2, 3, 4, 9", "20, 2, 3, 4")).find("a:16: an element of 4 nodes has 3") == 0);
    CHECK(tet_problem(replaced(deck, "3, 4\n*ELEMENT", "*ELEMENT")).find("a:14: the nodes of an element are missing") ==
          0);
    CHECK(tet_problem(replaced(deck, "1.D0", "nan")).find("a:8: \"nan\" is not a finite number") == 0);
    const std::string long_number = "1." + std::string(70, '0') + "e-3";
    CHECK(tet_problem(replaced(deck, "1.D0", long_number)).find("a:8: \"1.000") == 0);
    CHECK(tet_problem(replaced(deck, "9, 1., 1., 1.", "4, 1., 1., 1.")).find("a:9: node 4 comes twice") == 0);
    CHECK(tet_problem(replaced(deck, "*MATERIAL, NAME=M", "*INCLUDE, INPUT=b.inp")).find("*INCLUDE") !=
          std::string::npos);
    for (const char* card :
         {"*Node, INPUT=b.inp", "*ELEMENT, TYPE=C3D4, ELSET=B, input=b.inp", "*ELSET, ELSET=B, INPUT=b.inp"})
        CHECK(tet_problem(replaced(deck, "*MATERIAL, NAME=M", card)).find("with INPUT=FILE is not followed") !=
              std::string::npos);
    CHECK(tet_problem(replaced(deck, "*MATERIAL, NAME=M", "*ELEMENT, TYPE=S3, INPUT=b.inp")).empty());
    CHECK(tet_problem(replaced(deck, "*MATERIAL, NAME=M", "*ELGEN, ELSET=BOTH")).find("*elgen makes nodes") !=
          std::string::npos);
    CHECK(tet_problem(replaced(deck, "*NODE", "*NODE, SYSTEM=C")).find("another system of coordinates") !=
          std::string::npos);
    CHECK(tet_problem(replaced(deck, "*NODE", "*NODE, SYSTEM=R")).empty());
    CHECK(tet_problem(replaced(deck, "TYPE=C3D4", "\n TYPE=C3D4")).empty());
    CHECK(tet_problem(replaced(deck, "10, 20, 10", "10, 20, 0")).find("GENERATE") != std::string::npos);
    CHECK(tet_problem("*HEADING\n").find("holds no tetrahedra") != std::string::npos);
    CHECK(tet_problem(deck.substr(0, deck.find("3, 4\n*ELEM"))).find("ends in the middle") != std::string::npos);
}

TEST_CASE("Medit: unknown keywords are ignored; P2 and references are read") {
    const std::string text =
        "MeshVersionFormatted 2\n# a remark\nDimension\n3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
        "Triangles 1\n1 2 3 9\nTetrahedra\n1\n1 2 3 4 12\nCorners 1\n1\nEnd\n";
    const Result<TetMesh> mesh = parse_medit(text, "a.mesh");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->region_names == std::vector<std::string>{"12"});
    CHECK(tet_problem(replaced(text, "1 2 3 4 12", "1 2 3 5 12")).find("a:15: a tetrahedron refers to node 5") == 0);
    CHECK(tet_problem(replaced(text, "Tetrahedra\n1", "Tetrahedra\n99999999")).find("a:14: 99999999 are announced") ==
          0);
    CHECK(tet_problem(replaced(text, "0 0 1 0", "0 0 inf 0")).find("a:10: \"inf\"") == 0);
    CHECK(tet_problem(replaced(text, "Dimension\n3", "Dimension\n2")).find("dimension 2") != std::string::npos);
    CHECK(tet_problem(replaced(text, "1 2 3 4 12", "1 2 3 4 12\n1 2 3 4 12")).find("a:16: there is more") == 0);
    CHECK(tet_problem("MeshVersionFormatted 1\nDimension 3\n").find("holds no tetrahedra") != std::string::npos);
}

TEST_CASE("GiD: several blocks, materials and block names are read") {
    const std::string text =
        "MESH \"left part\" dimension 3 ElemType Tetrahedra Nnode 4\nCoordinates\n 1 0 0 0\n 2 1 0 0\n 3 0 1 0\n"
        " 4 0 0 1\n 5 1 1 1\nEnd Coordinates\nElements\n1 1 2 3 4\nEnd Elements\n"
        "MESH \"skin\" dimension 3 ElemType Triangle Nnode 3\nCoordinates\nend coordinates\nElements\n7 1 2 3\n"
        "end elements\nMESH dimension 3 ElemType Tetrahedra Nnode 4\nCoordinates\nEnd Coordinates\nElements\n"
        "2 2 3 4 5 31\nEnd Elements\n";
    const Result<TetMesh> mesh = parse_gid(text, "a.gid");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->region_names == std::vector<std::string>{"left part", "31"});
    CHECK(tet_problem(replaced(text, "1 1 2 3 4", "1 1 2 3 8")).find("a:10: a tetrahedron refers to node 8") == 0);
    CHECK(tet_problem(replaced(text, "Nnode 4", "Nnode 5")).find("a:2: tetrahedra of 5 nodes") == 0);
    CHECK(tet_problem(replaced(text, " 3 0 1 0", " 3 0 one 0")).find("a:5: \"one\"") == 0);
    CHECK(tet_problem(text.substr(0, text.find("End Coordinates"))).find("file ends") != std::string::npos);
}

TEST_CASE("binary .msh: both byte orders are read; wrong counts and cut files are refused") {
    const std::string bytes = msh_bytes(curved_tets(), Encoding::binary);
    for (std::size_t cut = 20; cut < bytes.size() - 14; cut += 7) CHECK_FALSE(parse_msh(bytes.substr(0, cut), "a"));
    std::string lying = bytes;
    const std::size_t nodes = lying.find("$Nodes\n") + 7;
    lying[nodes + 32 + 12 + 6] = 0x7f;  // the count of the first block, above 2^54
    CHECK(tet_problem(lying).find("are announced, more than the file can hold") != std::string::npos);
    std::string order = bytes;
    order[order.find(" 8\n") + 3] = 2;
    CHECK(tet_problem(order).find("in either byte order") != std::string::npos);
    std::string nan = bytes;
    const std::size_t first_x = nodes + 32 + 12 + 8 + 8 * curved_tets().points.size();
    std::fill_n(nan.begin() + static_cast<std::ptrdiff_t>(first_x), 8, '\xff');
    CHECK(tet_problem(nan).find("not finite") != std::string::npos);
}
