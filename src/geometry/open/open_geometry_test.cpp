#include "geometry/open/open_geometry.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <fstream>

#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/test_shapes.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

std::filesystem::path write(const pliant::test::Folder& folder, const std::string& name, const std::string& content) {
    std::ofstream(folder.path() / name, std::ios::binary) << content;
    return folder.path() / name;
}

}  // namespace

TEST_CASE("a file is recognised by its content, not by its name") {
    const pliant::test::Folder folder("open_geometry");
    const auto stl = folder.path() / "part.step";
    REQUIRE(write_stl(stl, mesh::test::tetrahedron()));
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

TEST_CASE("a STEP file is recognised by its first bytes, and read by the STEP reader only") {
    const pliant::test::Folder folder("open_geometry");
    const auto step = write(folder, "huge.step", "ISO-10303-21;\nHEADER;\n");
    std::filesystem::resize_file(step, std::uintmax_t{5} << 30);  // a sparse file, larger than read_file() accepts
    const Result<Geometry> solids = open_geometry(step);
    REQUIRE_MESSAGE(solids, (solids ? "" : solids.error().message));
    CHECK(std::holds_alternative<StepPath>(*solids));
}

TEST_CASE("long comments before the first keyword do not hide the format") {
    const pliant::test::Folder folder("open_geometry");
    std::string comments;
    while (comments.size() < 20000) comments += "# exported by a program that says much about itself\n";
    const auto obj = write(folder, "part.obj", comments + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    CHECK(geometry_kind_of(obj) == GeometryKind::surface);
    CHECK(open_geometry(obj));
}

TEST_CASE("a pipe is refused at once, without reading it") {
    const pliant::test::Folder folder("open_geometry");
    const auto pipe = folder.path() / "pipe.stl";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(geometry_kind_of(pipe) == GeometryKind::unknown);
    const Result<Geometry> refused = open_geometry(pipe);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message == pipe.string() + ": is not a regular file");
}

TEST_CASE("an unknown format is reported with the list of known ones") {
    const pliant::test::Folder folder("open_geometry");
    const auto letter = write(folder, "letter.txt", "Dear reader,\nthis is no mesh.\n");
    const Result<Geometry> unknown = open_geometry(letter);
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().message.find(letter.string() + ": is not geometry that Pliant reads") == 0);
    CHECK(open_geometry(write(folder, "empty.stl", "")).error().message.ends_with("empty.stl: the file is empty"));
    CHECK_FALSE(open_geometry(folder.path() / "nowhere.stl"));
}
