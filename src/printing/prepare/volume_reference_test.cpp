// Slices every closed model of the reference data: the images contain its volume, for the original and with corners
// moved by one step of its 32-bit numbers.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "base/core/letters.hpp"
#include "base/core/test_folder.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/repair/surface_check.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/slicer.hpp"

using namespace pliant;
using namespace pliant::prepare;
namespace fs = std::filesystem;

namespace {

struct Model {
    std::string name;
    mesh::TriMesh surface_um;
};

std::vector<fs::path> surface_files() {
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(std::getenv("PLIANT_REFERENCE_DATA"))) {
        const std::string extension = lower_case(entry.path().extension().string());
        for (const char* known : {".stl", ".obj", ".ply", ".off", ".3mf"}) {
            if (extension == known) files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

/// The closed models in the files. Unreadable files are left to other tests.
std::vector<Model> closed_models() {
    std::vector<Model> models;
    for (const fs::path& file : surface_files()) {
        Progress silent;
        const bool package = lower_case(file.extension().string()) == ".3mf";
        Result<Drawing> drawing = read_drawing({(package ? "" : "resin=") + file.string()}, {}, silent);
        if (!drawing) continue;
        for (slice::Body& body : drawing->bodies) {
            if (!body.slices.empty() || !mesh::check_closed(body.surface_um)) continue;
            models.push_back({file.filename().string() + " " + body.name, std::move(body.surface_um)});
        }
    }
    return models;
}

/// Rotated so that no face is horizontal or vertical: then the area of sections varies continuously with height, and
/// the sum over the middles of layers is the volume with a second-order error in their thickness. 200 layers of 50 um,
/// around the origin, where 32-bit numbers are most accurate.
mesh::TriMesh turned(mesh::TriMesh surface) {
    const Vec3 x = unit(Vec3{0.61, 0.53, 0.37});
    const Vec3 y = unit(cross(Vec3{0.2, -0.3, 0.9}, x));
    const Vec3 z = cross(x, y);
    for (Vec3& p : surface.points) p = {dot(x, p), dot(y, p), dot(z, p)};
    const Box3 box = mesh::bounds(surface);
    for (Vec3& p : surface.points) p = p - box.center();
    return mesh::scaled(std::move(surface), 200 * 50 / box.size().z);
}

/// Sum of all light times the thickness of layers, um^3; negative if slicing fails.
double printed_um3(const std::string& name, mesh::TriMesh surface) {
    const Vec3 size = mesh::bounds(surface).size();
    const double pixel_um = std::max(size.x, size.y) / 300;
    std::vector<slice::Body> bodies{{"resin", std::move(surface), name}};
    slice::Settings settings{{310, 310, pixel_um}, 50, {}};
    if (const auto placed = slice::place_on_platform(bodies, settings.raster); !placed) return -1;
    double light = 0;
    Progress silent;
    const auto summary = slice::slice_bodies(
        bodies, settings,
        [&](int, int, const slice::RunImage& image) {
            light += static_cast<double>(image.value_sum());
            return Status{};
        },
        silent);
    CHECK_MESSAGE(summary, name << ": " << (summary ? "" : summary.error().message));
    return summary ? light / 255 * pixel_um * pixel_um * 50 : -1;
}

/// Every tenth corner, at random, is moved by one 32-bit step along some axes; written to STL and read back.
mesh::TriMesh jittered(const mesh::TriMesh& surface, const fs::path& file) {
    std::mt19937 random(1);
    mesh::TriMesh soup;
    for (const auto& t : surface.triangles) {
        for (const int corner : t) {
            Vec3 p = surface.points[static_cast<std::size_t>(corner)];
            const bool off = random() % 10 == 0;
            for (std::size_t k = 0; k < 3 && off; ++k)
                p[k] =
                    static_cast<double>(std::nextafter(static_cast<float>(p[k]), random() % 2 == 0 ? 1e30F : -1e30F));
            soup.points.push_back(p);
        }
        const int n = static_cast<int>(soup.points.size());
        soup.triangles.push_back({n - 3, n - 2, n - 1});
    }
    REQUIRE(mesh::write_stl(file, soup));
    Result<mesh::SurfaceFile> read = mesh::read_surface(file);
    REQUIRE(read);
    return std::move(read->mesh);
}

}  // namespace

TEST_CASE("the images of every closed model have its volume within 0.1 %, also with jittered corners") {
    const pliant::test::Folder folder("volumes");
    const std::vector<Model> models = closed_models();
    CHECK(models.size() >= 100);
    double worst = 0;
    for (const Model& model : models) {
        CAPTURE(model.name);
        const mesh::TriMesh drawn = turned(model.surface_um);
        const double volume = mesh::signed_volume(drawn);
        const double error = printed_um3(model.name, drawn) / volume - 1;
        CHECK(std::fabs(error) < 1e-3);
        worst = std::max(worst, std::fabs(error));
        const mesh::TriMesh shaken = jittered(drawn, folder / "shaken.stl");
        CHECK(mesh::check_closed(shaken));
        CHECK(std::fabs(mesh::signed_volume(shaken) / volume - 1) < 1e-4);
        CHECK(std::fabs(printed_um3(model.name, shaken) / volume - 1) < 1e-3);
    }
    MESSAGE(models.size() << " models, the worst off by " << worst);
}
