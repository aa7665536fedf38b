// Meshes of real soft robots (softrobots/README.md and 3mf/README.md of the reference data).
#include <doctest/doctest.h>

#include <cstdlib>

#include "base/core/near.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/repair/surface_check.hpp"

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
        double half_digit = 5e-4;  // of the table's worst quality
    };
    for (const Row& row :
         {Row{"cable_finger/finger.vtk", 389, 18508.66, 0.048},
          Row{"cable_finger/finger_7k.vtk", 7407, 18508.66, 0.078},
          Row{"pneunet_finger/pneunetCut.vtk", 9560, 51162.50, 0.006},
          Row{"pneunet_finger/pneunetCutCoarse.vtk", 1195, 51162.50, 0.011},
          Row{"springy/Springy.vtk", 5992, 28.43, 0.0003, 5e-5}, Row{"springy/Springy.vtu", 2743, 31.47, 0.013}}) {
        CAPTURE(row.file);
        const Result<TetMesh> mesh = read_tet_mesh(folder("softrobots/") + row.file);
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        const MeshReport report = report_on(*mesh);
        CHECK(report.tets == row.tets);
        CHECK(volume(*mesh) == near(row.volume, {.relative = 2e-4}));
        CHECK(report.worst_quality == near(row.worst, {.absolute = row.half_digit}));
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
    CHECK(volume(*mesh) == near(18508.66, {.relative = 1e-3}));
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

TEST_CASE("broken STL files are meshed by their winding number, or refused with a reason") {
    struct Row {
        const char* file;
        double volume;     ///< 0: refused
        const char* told;  ///< expected part of the note or error; null: none expected
    };
    for (const Row& row :
         {Row{"cube_good_binary", 1000, ""}, Row{"hole_one_triangle", 1000, "3 open edges"},
          Row{"t_junction", 1000, "winding number"}, Row{"inverted_all", 1000, "inside out were turned outwards"},
          Row{"duplicate_triangle", 1000, "1 repeated"}, Row{"degenerate_triangles", 1000, "flat"},
          Row{"shared_vertex", 2000, ""}, Row{"touching_faces", 2000, ""}, Row{"cavity_inverted_inner", 784, ""},
          Row{"open_sheet", 0, "encloses nothing"}, Row{"tiny_1um_cube", 1e-9, ""}, Row{"far_from_origin", 1000, ""},
          Row{"ascii_two_solids", 2000, ""}}) {
        CAPTURE(row.file);
        const Result<SurfaceFile> surface = read_surface(folder("3mf/broken_stl/") + row.file + ".stl");
        REQUIRE_MESSAGE(surface, (surface ? "" : surface.error().message));
        Progress silent;
        const double size = bounds(surface->mesh).size().x / 6;
        const Result<TetMesh> mesh =
            mesh_bodies(std::vector<BodyGeometry>{{"cube", surface->mesh}}, {.size = size, .order = 1}, silent);
        if (row.volume == 0) {
            CHECK_FALSE(mesh);
            if (!mesh) CHECK(mesh.error().message.find(row.told) != std::string::npos);
            continue;
        }
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        CHECK(volume(*mesh) == near(row.volume, {.relative = 0.02}));
        CHECK(report_on(*mesh).min_dihedral_deg > 5);
        std::string notes;
        for (const std::string& note : surface->warnings) notes += note + "; ";
        for (const std::string& note : mesh->notes) notes += note + "; ";
        CAPTURE(notes);
        CHECK(notes.find(row.told) != std::string::npos);
    }
}

TEST_CASE("closed clean surfaces of real robots: no dihedral angle under 5 degrees") {
    for (const char* file :
         {"cable_finger/finger.stl", "pneunet_finger/pneunetCut.stl", "pneunet_finger/pneunetCavityCut.stl",
          "tripod/tripod_low.stl", "tripod/tripod_mid.stl", "tripod/tripod_high.stl"}) {
        const Result<SurfaceFile> surface = read_surface(folder("softrobots/") + file);
        REQUIRE_MESSAGE(surface, (surface ? "" : surface.error().message));
        REQUIRE(check_closed(surface->mesh));
        const Vec3 d = bounds(surface->mesh).size();
        for (const double divisions : {12, 20, 24}) {
            CAPTURE(file);
            CAPTURE(divisions);
            Progress silent;
            const Result<TetMesh> mesh =
                mesh_bodies(std::vector<BodyGeometry>{{"robot", surface->mesh}},
                            {.size = std::max({d.x, d.y, d.z}) / divisions, .order = 1}, silent);
            REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
            CHECK(smallest_dihedral_deg(*mesh) >= 5);
            CHECK(volume(*mesh) == near(signed_volume(surface->mesh), {.relative = 0.02}));
        }
    }
}
