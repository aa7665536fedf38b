#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "geometry/files/tet_file.hpp"

using namespace pliant;
using namespace pliant::mesh;
using pliant::test::replaced;

namespace {

std::string msh_problem(std::string_view text) {
    const Result<TetMesh> mesh = parse_msh(text, "a.msh");
    return mesh ? "" : mesh.error().message;
}

/// Two tets of two physical volumes, one triangle; node numbers with gaps, one node that no tet uses.
const std::string version_2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 9 "skin"
3 1 "soft foam"
3 2 "grip"
$EndPhysicalNames
$Nodes
6
10 0 0 0
20 1 0 0
30 0 1 0
40 0 0 1
50 1 1 1
60 7 7 7
$EndNodes
$Elements
3
1 2 2 9 1 10 20 30
2 4 2 2 1 10 20 30 40
3 4 3 1 2 0 20 40 30 50
$EndElements
$NodeData
whatever it holds
$EndNodeData
)";

const std::string version_4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
3 7 "body"
$EndPhysicalNames
$Entities
1 0 1 2
1 0 0 0 0
1 0 0 0 1 1 1 0 0
1 0 0 0 1 1 1 1 7 0
2 0 0 0 1 1 1 0 0
$EndEntities
$Nodes
2 5 1 5
0 1 0 1
1
0 0 0
3 1 0 4
2
3
4
5
1 0 0
0 1 0
0 0 1
1 1 1
$EndNodes
$Elements
3 3 1 3
2 1 2 1
1 1 2 3
3 1 4 1
2 1 2 3 4
3 2 4 1
3 2 4 3 5
$EndElements
)";

}  // namespace

TEST_CASE("version 2: physical volumes are regions with their names; all else is ignored") {
    const Result<TetMesh> mesh = parse_tet_mesh(version_2, "a.msh");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->points.size() == 5);
    CHECK(mesh->region_names == std::vector<std::string>{"grip", "soft foam"});
    CHECK(volume(*mesh, 0) == near(1.0 / 6, {.relative = 1e-12}));
    CHECK(volume(*mesh, 1) == near(1.0 / 3, {.relative = 1e-12}));  // it was inverted in the file
}

TEST_CASE("version 4: groups follow from the volumes that belong to them") {
    const Result<TetMesh> mesh = parse_tet_mesh(version_4, "a.msh");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->region_names == std::vector<std::string>{"body", "0"});  // the second volume is in no group
    CHECK(volume(*mesh) == near(0.5, {.relative = 1e-12}));
    const Result<TetMesh> plain = parse_msh(replaced(version_4, "1 1 1 1 7 0", "1 1 1 0 0"), "a.msh");
    REQUIRE(plain);
    CHECK(plain->region_names == std::vector<std::string>{"1", "2"});
}

TEST_CASE("quadratic tets: the last two mid-edge nodes change places") {
    std::string text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n5 1 0 0\n"
        "6 1 1 0\n7 0 1 0\n8 0 0 1\n9 0 1 1\n10 1 0 1\n$EndNodes\n$Elements\n1\n"
        "1 11 2 0 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n";
    const Result<TetMesh> mesh = parse_msh(text, "a.msh");
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(mesh->order == 2);
    const auto n = mesh->tet(0);
    for (std::size_t e = 0; e < 6; ++e)
        CHECK(mesh->points[n[4 + e]] ==
              0.5 * (mesh->points[n[edge_corners[e][0]]] + mesh->points[n[edge_corners[e][1]]]));
}

TEST_CASE("damaged files give a reason with the line, and stated sizes are not trusted") {
    CHECK(msh_problem("$MeshFormat\n4.1 1 8\n$EndMeshFormat\n").find("a.msh: byte 24: the whole number 1 is needed") ==
          0);
    CHECK(msh_problem("$MeshFormat\n1.0 0 8\n$EndMeshFormat\n").find("version \"1.0\"") != std::string::npos);
    CHECK(msh_problem("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n").find("holds no tetrahedra") != std::string::npos);
    CHECK(msh_problem(replaced(version_2, "$Nodes\n6", "$Nodes\n6000000000000")).find("more than the file can hold") !=
          std::string::npos);
    CHECK(msh_problem(replaced(version_2, "40 0 0 1\n", "40 0 zero 1\n")) ==
          "a.msh:15: \"zero\" is not a finite number");
    CHECK(msh_problem(replaced(version_2, "40 0 0 1\n", "30 0 0 1\n")).find("node 30 comes twice") !=
          std::string::npos);
    CHECK(msh_problem(replaced(version_2, "10 20 30 40", "10 20 30 41"))
              .find("refers to node 41, which does not exist") != std::string::npos);
    CHECK(msh_problem(replaced(version_2, "10 20 30 40", "10 20 30 30")).find("twice") != std::string::npos);
    CHECK(msh_problem(replaced(version_2, "\"grip\"", "grip")).find("a name in quotes") != std::string::npos);
    CHECK(
        msh_problem(replaced(version_4, "0 1 0 1\n1\n", "0 1 0 999999999\n1\n")).find("more than the file can hold") !=
        std::string::npos);
    CHECK(msh_problem(replaced(version_4, "$Entities\n1 0 1 2", "$Entities\n1 0 1 2000000000")).find("a.msh:") == 0);
    for (const std::string& whole : {version_2, version_4}) {
        for (std::size_t length = 0; length < whole.size(); ++length) (void)parse_msh(whole.substr(0, length), "a.msh");
    }
}
