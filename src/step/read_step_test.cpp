#include "step/read_step.hpp"

#include <doctest/doctest.h>
#include <gmsh.h>

#include <cstdlib>
#include <numbers>

#include "core/files.hpp"

using namespace pliant;
using namespace pliant::step;
namespace fs = std::filesystem;

namespace {

struct Folder {
    fs::path path;
    Folder() {
        std::string name = (fs::temp_directory_path() / "pliant_step_XXXXXX").string();
        REQUIRE(mkdtemp(name.data()) != nullptr);
        path = name;
    }
    ~Folder() { fs::remove_all(path); }
};

/// A drilled block of 20 x 10 x 5 mm with a hole of radius 2 mm, and a ball of radius 3 mm beside it.
void write_example(const fs::path& path) {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    const int block = gmsh::model::occ::addBox(0, 0, 0, 20, 10, 5);
    const int hole = gmsh::model::occ::addCylinder(10, 5, -1, 0, 0, 7, 2);
    gmsh::vectorpair out;
    std::vector<gmsh::vectorpair> map;
    gmsh::model::occ::cut({{3, block}}, {{3, hole}}, out, map);
    gmsh::model::occ::addSphere(40, 0, 0, 3);
    gmsh::model::occ::synchronize();
    gmsh::write(path.string());
    gmsh::finalize();
}

}  // namespace

TEST_CASE("solids of a STEP file have the volume of their formulas") {
    const Folder folder;
    const fs::path path = folder.path / "parts.step";
    write_example(path);
    CHECK(looks_like_step(read_file(path).value()));
    const auto file = read_step(path);
    REQUIRE_MESSAGE(file.has_value(), (file ? "" : file.error().message));
    CHECK(file->solids == 2);
    constexpr double pi = std::numbers::pi;
    const double wanted = 20 * 10 * 5 - pi * 4 * 5 + 4.0 / 3 * pi * 27;
    CHECK(file->volume_mm3 == doctest::Approx(wanted).epsilon(1e-9));
    CHECK(mesh::signed_volume(file->surface_mm) == doctest::Approx(wanted).epsilon(1e-3));
}

TEST_CASE("what is no STEP file, or holds no solid, is refused") {
    const Folder folder;
    const fs::path path = folder.path / "bad.step";
    for (const char* text : {"", "ISO-10303-21;\n",
                             "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=NOTHING();\nENDSEC;\nEND-ISO-10303-21;\n"}) {
        REQUIRE(write_file(path, text).has_value());
        CHECK(!read_step(path).has_value());
    }
    CHECK(!read_step(folder.path / "none.step").has_value());
}
