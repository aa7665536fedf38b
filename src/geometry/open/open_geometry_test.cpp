#include "geometry/open/open_geometry.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

const TriMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

std::filesystem::path write(const test::Folder& folder, const std::string& name, const std::string& content) {
    std::ofstream(folder.path() / name, std::ios::binary) << content;
    return folder.path() / name;
}

}  // namespace

TEST_CASE("a file is what it holds, not what it is called") {
    const test::Folder folder("open_geometry");
    const auto stl = folder.path() / "part.step";
    REQUIRE(write_stl(stl, tetrahedron));
    const Result<Geometry> surface = open_geometry(stl);
    REQUIRE(surface);
    REQUIRE(std::holds_alternative<SurfaceFile>(*surface));
    CHECK(std::get<SurfaceFile>(*surface).mesh.triangles.size() == 4);

    const auto medit = write(folder, "part.stl",
                             "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
                             "Tetrahedra\n1\n1 2 3 4 7\nEnd\n");
    const Result<Geometry> tets = open_geometry(medit);
    REQUIRE(tets);
    REQUIRE(std::holds_alternative<TetMesh>(*tets));
    CHECK(std::get<TetMesh>(*tets).tet_count() == 1);

    const auto step = write(folder, "part.obj", "ISO-10303-21;\nHEADER;\n");
    const Result<Geometry> solids = open_geometry(step);
    REQUIRE(solids);
    CHECK(std::get<StepPath>(*solids).path == step);

    CHECK(geometry_kind_of(stl) == GeometryKind::surface);
    CHECK(geometry_kind_of(medit) == GeometryKind::tets);
    CHECK(geometry_kind_of(step) == GeometryKind::step);
    CHECK(geometry_kind("PK\3\4...") == GeometryKind::threemf);
    CHECK(geometry_kind_of(folder.path() / "nowhere") == GeometryKind::unknown);
}

TEST_CASE("what no reader knows is told with what they know") {
    const test::Folder folder("open_geometry");
    const auto letter = write(folder, "letter.txt", "Dear reader,\nthis is no mesh.\n");
    const Result<Geometry> unknown = open_geometry(letter);
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().message.find(letter.string() + ": is no geometry that Pliant reads") == 0);
    CHECK(open_geometry(write(folder, "empty.stl", "")).error().message.ends_with("empty.stl: the file is empty"));
    CHECK_FALSE(open_geometry(folder.path() / "nowhere.stl"));
}
