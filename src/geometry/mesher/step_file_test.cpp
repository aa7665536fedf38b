#include "geometry/mesher/step_file.hpp"

#include <doctest/doctest.h>
#include <gmsh.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <regex>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/mesher/mesher.hpp"

using namespace pliant;
using namespace pliant::mesh;
namespace fs = std::filesystem;

namespace {

/// A plate of 20 x 20 x 5 mm with a ball of radius 3 beside it, written by Gmsh with Open CASCADE.
fs::path written(const pliant::test::Folder& folder) {
    const fs::path path = folder / "drawing.step";
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::model::add("drawing");
    gmsh::model::occ::addBox(0, 0, 0, 20, 20, 5);
    gmsh::model::occ::addSphere(40, 10, 2, 3);
    gmsh::model::occ::synchronize();
    gmsh::write(path.string());
    gmsh::finalize();
    return path;
}

double volume_of(const Solid& solid) {
    const Result<double> volume = solid_volume(solid);
    REQUIRE_MESSAGE(volume, (volume ? "" : volume.error().message));
    return *volume;
}

}  // namespace

TEST_CASE("solids of a STEP file: exact volumes, in the caller's unit, one or all of them") {
    const pliant::test::Folder folder("step");
    const fs::path path = written(folder);
    const double ball = 4.0 / 3 * std::numbers::pi * 27;
    const Result<Solid> all = read_step(path, "", 1);
    REQUIRE_MESSAGE(all, (all ? "" : all.error().message));
    CHECK(volume_of(*all) == near(2000 + ball, {.relative = 1e-9}));
    const Result<Solid> metres = read_step(path, "", 1e-3);
    REQUIRE(metres);
    // A scaled ball becomes a spline, whose volume Open CASCADE integrates to 1e-4.
    CHECK(volume_of(*metres) == near((2000 + ball) * 1e-9, {.relative = 1e-4}));
    CHECK(bounds(*metres).high.x == near(0.043, {.relative = 1e-12}));
    CHECK(contains(*all, {1, 1, 1}));
    CHECK(contains(*all, {40, 10, 4.5}));
    CHECK_FALSE(contains(*all, {30, 10, 2}));

    const Result<Solid> none = read_step(path, "lid", 1);
    REQUIRE_FALSE(none);
    const std::string& said = none.error().message;
    CHECK(said.find("has no solid \"lid\"; it has ") != std::string::npos);
    const std::size_t quote = said.find("it has ") + 7;
    const std::string name = said.substr(quote, said.find(" and ", quote) - quote);
    std::string bare;
    for (const char c : name) bare += c == '"' ? "" : std::string(1, c);
    const Result<Solid> first = read_step(path, bare, 1);
    REQUIRE_MESSAGE(first, (first ? "" : first.error().message));
    CHECK(volume_of(*first) == near(2000, {.relative = 1e-9}));
    const Result<Solid> in_cm = read_step(path, bare, 0.1);  // a solid has its name in any unit
    REQUIRE_MESSAGE(in_cm, (in_cm ? "" : in_cm.error().message));
    CHECK(volume_of(*in_cm) == near(2, {.relative = 1e-9}));
    CHECK(bounds(*in_cm).high.x == near(2, {.relative = 1e-12}));
    CHECK(contains(*in_cm, {1.9, 1.9, 0.4}));
    CHECK_FALSE(contains(*in_cm, {1.9, 1.9, 0.6}));
}

TEST_CASE("a part is asked of a STEP file whose solids have no names: the message says so") {
    const pliant::test::Folder folder("step");
    const fs::path path = written(folder);
    const Result<std::string> whole = read_file(path);
    REQUIRE(whole);
    const std::regex name("'Open CASCADE STEP translator [^']*'");
    REQUIRE(write_file(path, std::regex_replace(*whole, name, "''")));
    const Result<Solid> none = read_step(path, "lid", 1);
    REQUIRE_FALSE(none);
    INFO(none.error().message);
    CHECK(none.error().message.ends_with(
        "drawing.step: has no solid \"lid\"; its solids have no names: leave out the part, and all are taken"));
}

TEST_CASE("a STEP body is joined to bodies it touches, and its curved faces stay curved") {
    const pliant::test::Folder folder("step");
    const fs::path path = written(folder);
    const Result<Solid> drawn = read_step(path, "", 1);
    REQUIRE(drawn);
    const Solid lid = std::make_shared<const SolidNode>(SolidNode{BoxSolid{{0, 0, 5}, {20, 20, 8}}});
    Progress silent;
    const std::vector<BodyGeometry> bodies = {{"drawn", *drawn}, {"lid", lid}};
    const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = 4, .order = 2}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume(*mesh, 1) == near(1200, {.relative = 1e-9}));
    CHECK(boundary_faces(*mesh).size() < region_faces(*mesh, 0).size() + region_faces(*mesh, 1).size());
    const Result<TriMesh> surface = tessellate(*drawn, 0.005);
    REQUIRE(surface);
    CHECK(signed_volume(*surface) == near(2000 + 4.0 / 3 * std::numbers::pi * 27, {.relative = 1e-3}));
}

TEST_CASE("a STEP file that is cut off, of another kind, or without a solid is refused by name") {
    const pliant::test::Folder folder("step");
    const fs::path path = written(folder);
    const Result<std::string> whole = read_file(path);
    REQUIRE(whole);
    const auto refused = [&](const std::string& text) {
        REQUIRE(write_file(path, text));
        const Result<Solid> solid = read_step(path, "", 1);
        REQUIRE_FALSE(solid);
        CHECK(solid.error().message.find("drawing.step") != std::string::npos);
        return solid.error().message;
    };
    CHECK(refused(whole->substr(0, whole->size() / 2)).find("cut off") != std::string::npos);
    CHECK(refused("solid cube").find("no STEP file") != std::string::npos);
    std::string strange = *whole;  // entities unknown to Open CASCADE, in a place where it follows pointers
    for (std::size_t at = 0; (at = strange.find("= DIRECTION", at)) != std::string::npos;) strange[at + 2] = 'X';
    CHECK(refused(strange).find("is damaged") != std::string::npos);
    (void)refused("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n");
    (void)refused("ISO-10303-21;\n\x01\xff\nEND-ISO-10303-21;\n");
}

TEST_CASE("a STEP file of a surface alone is refused once, with its name") {
    const pliant::test::Folder folder("step");
    const fs::path path = folder / "sheet.step";
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::model::occ::addRectangle(0, 0, 0, 10, 10);
    gmsh::model::occ::synchronize();
    gmsh::write(path.string());
    gmsh::finalize();
    const Result<Solid> solid = read_step(path, "", 1);
    REQUIRE_FALSE(solid);
    CHECK(solid.error().message == path.string() + ": holds no solid");
}
