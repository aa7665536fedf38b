// The 3MF files of the reference data, compared with the expectations in their README.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "base/core/near.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/repair/surface_check.hpp"
#include "geometry/threemf/read_3mf.hpp"

using namespace pliant;
using namespace pliant::threemf;
namespace fs = std::filesystem;

namespace {

/// Read at run time: without the variable these tests are skipped, but others in this program run.
fs::path folder() {
    return fs::path(std::getenv("PLIANT_REFERENCE_DATA")) / "3mf";
}

ThreeMf read_reference(const std::string& file) {
    const auto result = read_3mf(folder() / file);
    REQUIRE_MESSAGE(result.has_value(), file << ": " << (result ? "" : result.error().message));
    return *result;
}

std::string refused_reference(const std::string& file) {
    const auto result = read_3mf(folder() / file);
    REQUIRE_MESSAGE(!result.has_value(), file << " was read");
    return result.error().message;
}

double volume(const ThreeMf& file) {
    double sum = 0;
    for (const Body& body : file.bodies) sum += mesh::signed_volume(body.mesh_mm);
    return sum;
}

double stack_volume(const Body& body) {
    double sum = 0;
    for (const Slice& slice : body.slices) {
        for (const Contour& c : slice.contours) {
            double twice = 0;
            for (std::size_t i = 0; i < c.size(); ++i) {
                const auto& [x0, y0] = c[i];
                const auto& [x1, y1] = c[(i + 1) % c.size()];
                twice += x0 * y1 - x1 * y0;
            }
            sum += twice / 2 * (slice.top_mm - slice.bottom_mm);
        }
    }
    return sum;
}

}  // namespace

TEST_CASE("synthetic files have their bodies, materials and volumes") {
    struct Expected {
        const char* file;
        std::size_t bodies, materials;
        double volume;
    };
    for (const Expected& e : {Expected{"two_halves", 2, 2, 2000},
                              {"overlap_cubes", 2, 2, 2000},
                              {"gap_10um", 2, 2, 1999},
                              {"stack4", 4, 4, 3200},
                              {"alternating_bands", 10, 2, 4000},
                              {"checker8", 32, 8, 4000}}) {
        const ThreeMf file = read_reference(fmt::format("synthetic/{}.3mf", e.file));
        CHECK(file.bodies.size() == e.bodies);
        std::map<std::string, double> volume_of;
        for (const Body& b : file.bodies) volume_of[b.material] += mesh::signed_volume(b.mesh_mm);
        CHECK(volume_of.size() == e.materials);
        CHECK(volume(file) == near(e.volume, {.relative = 1e-9}));
        CHECK(file.warnings.empty());
        if (std::string(e.file) == "checker8") {
            for (const auto& [name, mm3] : volume_of) CHECK(mm3 == near(500, {.relative = 1e-12}));
        }
    }
}

TEST_CASE("consortium files: core, units, colours and production have their volumes") {
    CHECK(volume(read_reference("consortium/core_box.3mf")) == near(6000, {.relative = 1e-12}));
    CHECK(volume(read_reference("consortium/core_sphere.3mf")) == near(4172.803, {.relative = 1e-6}));
    const ThreeMf cylinders = read_reference("consortium/core_multiple_cylinders.3mf");
    CHECK(cylinders.bodies.size() == 6);
    CHECK(cylinders.bodies[0].material == "BaseMaterial");
    CHECK(volume(cylinders) == near(6 * 6198.102, {.relative = 1e-5}));
    const ThreeMf gears = read_reference("consortium/core_cube_gears.3mf");
    CHECK(gears.bodies.size() == 17);
    CHECK(volume(gears) == near(112366.3, {.relative = 1e-6}));
    CHECK(volume(read_reference("consortium/core_heartgears.3mf")) == near(120179.298, {.relative = 1e-6}));
    const ThreeMf colours = read_reference("consortium/material_rhombicuboctahedron_color.3mf");
    CHECK(colours.bodies.size() == 1);
    CHECK(volume(colours) == near(1089262.183, {.relative = 1e-6}));
    REQUIRE(colours.warnings.size() == 1);
    CHECK(colours.warnings[0].find("do not bound volumes") != std::string::npos);
    CHECK(volume(read_reference("consortium/material_multiprop-opaque.3mf")) == near(1e6, {.relative = 1e-12}));
    // Its objects are in other parts of the package.
    const ThreeMf production = read_reference("consortium/production_cube_gears_prod_req.3mf");
    CHECK(production.bodies.size() == 17);
    CHECK(volume(production) == near(112366.3, {.relative = 1e-6}));
}

TEST_CASE("consortium: slice stacks have the volume of the bodies they were made from") {
    const ThreeMf box = read_reference("consortium/slices_box_sliced.3mf"),
                  sphere = read_reference("consortium/slices_sphere_sliced.3mf");
    REQUIRE(box.bodies.size() == 1);
    CHECK(stack_volume(box.bodies[0]) == near(6173.54, {.relative = 1e-5}));
    CHECK(stack_volume(sphere.bodies[0]) == near(4303.07, {.relative = 1e-5}));
    CHECK(box.bodies[0].slices.size() == 379);
    CHECK(box.bodies[0].slices.back().contours.empty());
}

TEST_CASE("objects that must not be built are refused by name") {
    CHECK(refused_reference("consortium/beam_lattice_pyramid.3mf").find("requires the extension b") !=
          std::string::npos);
    CHECK(refused_reference("consortium/material_multiprop-metallic.3mf").find(":62: ") != std::string::npos);
}

TEST_CASE("conformance: every file that must pass opens, every file that must fail is refused") {
    for (const auto& entry : fs::directory_iterator(folder() / "consortium/mustpass")) {
        const auto result = read_3mf(entry.path());
        CHECK_MESSAGE(result.has_value(), entry.path().filename().string()
                                              << ": " << (result ? "" : result.error().message));
    }
    int refusals = 0;
    for (const auto& entry : fs::directory_iterator(folder() / "consortium/mustfail")) {
        const auto result = read_3mf(entry.path());
        if (result && entry.path().stem() == "Chapter3.4.1a_MissingMetadataName") {  // a remark must not affect any
                                                                                     // body
            REQUIRE(result->warnings.size() == 1);
            CHECK(result->warnings[0].find("section 3.4.1") != std::string::npos);
            continue;
        }
        REQUIRE_MESSAGE(!result.has_value(), entry.path().filename().string());
        CHECK(result.error().message.find('\n') == std::string::npos);
        ++refusals;
    }
    CHECK(refusals == 18);
}

TEST_CASE("files of other programs are read") {
    const ThreeMf pyramids = read_reference("mit_models/pyramids.3mf");
    CHECK(pyramids.bodies.size() >= 9);
    const ThreeMf two = read_reference("mit_models/cube_and_sphere_same_name.3mf");
    REQUIRE(two.bodies.size() == 2);
    CHECK(two.bodies[0].material == "Green");
    CHECK(two.bodies[1].material == "#00A0E8");
    CHECK(mesh::signed_volume(two.bodies[0].mesh_mm) == near(63993.6, {.relative = 1e-6}));
    CHECK(mesh::signed_volume(two.bodies[1].mesh_mm) == near(33438.305, {.relative = 1e-6}));
}

TEST_CASE("closed bodies are meshed without a dihedral angle under 5 degrees") {
    for (const char* file :
         {"synthetic/two_halves.3mf", "synthetic/overlap_cubes.3mf", "synthetic/stack4.3mf", "synthetic/gap_10um.3mf",
          "synthetic/alternating_bands.3mf", "synthetic/checker8.3mf", "consortium/material_multiprop-opaque.3mf",
          "consortium/core_box.3mf", "consortium/core_sphere.3mf", "consortium/core_multiple_cylinders.3mf",
          "consortium/mustpass/Chapter4.2_Components.3mf", "consortium/material_rhombicuboctahedron_color.3mf",
          "mit_models/pyramids.3mf", "mit_models/cube_and_sphere_same_name.3mf"}) {
        CAPTURE(file);
        for (const Body& body : read_reference(file).bodies) {
            CAPTURE(body.name);
            REQUIRE(mesh::check_closed(body.mesh_mm));
            const Vec3 d = mesh::bounds(body.mesh_mm).size();
            Progress silent;
            const Result<mesh::TetMesh> mesh =
                mesh::mesh_bodies(std::vector<mesh::BodyGeometry>{{body.name, body.mesh_mm}},
                                  {.size = std::max({d.x, d.y, d.z}) / 8, .order = 1}, silent);
            REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
            CHECK(mesh::smallest_dihedral_deg(*mesh) >= 5);
        }
    }
}
