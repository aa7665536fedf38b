// Meshes of real soft robots (softrobots/README.md and 3mf/README.md of the reference data).
#include <doctest/doctest.h>

#include <cstdlib>

#include "mesh/mesh_report.hpp"
#include "mesh/mesher.hpp"
#include "mesh/surface_check.hpp"
#include "mesh/surface_file.hpp"
#include "mesh/tet_file.hpp"

using namespace pliant;
using namespace pliant::mesh;

namespace {

std::string folder(const std::string& name) {
    return std::string(std::getenv("PLIANT_REFERENCE_DATA")) + "/" + name;
}

}  // namespace

TEST_CASE("tet meshes: counts, volume and quality of the published table") {
    struct Row {
        const char* file;
        std::size_t tets;
        double volume, worst;
    };
    for (const Row& row :
         {Row{"cable_finger/finger.vtk", 389, 18508.66, 0.048},
          Row{"cable_finger/finger_7k.vtk", 7407, 18508.66, 0.078},
          Row{"pneunet_finger/pneunetCut.vtk", 9560, 51162.50, 0.006},
          Row{"pneunet_finger/pneunetCutCoarse.vtk", 1195, 51162.50, 0.011},
          Row{"springy/Springy.vtk", 5992, 28.43, 0.0003}, Row{"springy/Springy.vtu", 2743, 31.47, 0.013}}) {
        CAPTURE(row.file);
        const Result<TetMesh> mesh = read_tet_mesh(folder("softrobots/") + row.file);
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        const MeshReport report = report_on(*mesh);
        CHECK(report.tets == row.tets);
        CHECK(volume(*mesh) == doctest::Approx(row.volume).epsilon(2e-4));
        CHECK(report.worst_quality == doctest::Approx(row.worst).epsilon(0.1).scale(0.001));
    }
}

TEST_CASE("a real STL finger is meshed anew and keeps its volume") {
    const Result<SurfaceFile> surface = read_surface(folder("softrobots/cable_finger/finger.stl"));
    REQUIRE(surface);
    CHECK(surface->mesh.points.size() == 155);
    CHECK(check_closed(surface->mesh));
    Progress silent;
    const std::vector<BodyGeometry> bodies = {{"finger", surface->mesh}};
    const Result<TetMesh> mesh = mesh_bodies(bodies, {.size = 3, .order = 2}, silent);
    REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
    CHECK(volume(*mesh) == doctest::Approx(18508.66).epsilon(1e-3));
    CHECK(report_on(*mesh).worst_quality > 0.02);
}

TEST_CASE("broken STL files: read, read with a warning, or refused with a reason") {
    struct Row {
        const char* file;
        bool read;
        std::size_t triangles, warnings;
    };
    for (const Row& row : {Row{"cube_good_binary", true, 12, 0}, Row{"cube_good_ascii", true, 12, 0},
                           Row{"binary_header_says_solid", true, 12, 0}, Row{"binary_count_too_large", true, 12, 1},
                           Row{"binary_count_too_small", true, 12, 1}, Row{"binary_trailing_bytes", true, 12, 1},
                           Row{"ascii_crlf_uppercase", true, 12, 0}, Row{"ascii_exponent_no_normal", true, 12, 0},
                           Row{"ascii_name_with_facet_word", true, 12, 0}, Row{"ascii_two_solids", true, 24, 0},
                           Row{"binary_nan_vertex", false, 0, 0}, Row{"binary_zero_triangles", false, 0, 0},
                           Row{"empty_zero_bytes", false, 0, 0}, Row{"ascii_empty_solid", false, 0, 0},
                           Row{"not_an_stl", false, 0, 0}, Row{"ascii_missing_vertex", false, 0, 0}}) {
        CAPTURE(row.file);
        const Result<SurfaceFile> surface = read_surface(folder("3mf/broken_stl/") + row.file + ".stl");
        CHECK(surface.has_value() == row.read);
        if (!surface) {
            CHECK(surface.error().message.find(row.file) != std::string::npos);
            continue;
        }
        CHECK(surface->mesh.triangles.size() == row.triangles);
        CHECK(surface->warnings.size() == row.warnings);
    }
}
