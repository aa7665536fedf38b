// Cubes of 10 mm, each damaged in one way, at 0.1 mm pixels and 0.05 mm layers.
#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>

#include "base/core/files.hpp"
#include "printing/slice/place.hpp"
#include "printing/slice/slicer.hpp"

using namespace pliant;
using namespace pliant::slice;

namespace {

mesh::TriMesh read_binary_stl_um(const std::string& name) {
    const char* folder = std::getenv("PLIANT_REFERENCE_DATA");
    REQUIRE(folder != nullptr);
    const auto bytes = read_file(std::filesystem::path(folder) / "3mf/broken_stl" / name);
    REQUIRE(bytes.has_value());
    mesh::TriMesh mesh;
    std::uint32_t count = 0;
    std::memcpy(&count, bytes->data() + 80, 4);
    REQUIRE(bytes->size() >= 84 + std::size_t{50} * count);
    for (std::uint32_t t = 0; t < count; ++t) {
        std::array<float, 9> xyz{};
        std::memcpy(xyz.data(), bytes->data() + 84 + 50 * t + 12, 36);
        const int first = static_cast<int>(mesh.points.size());
        for (std::size_t i = 0; i < 9; i += 3) mesh.points.push_back(Vec3{xyz[i], xyz[i + 1], xyz[i + 2]} * 1000);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

struct SlicedFile {
    std::vector<long> full_pixels;  ///< per layer
    std::vector<std::string> warnings;
};

Result<SlicedFile> slice_file(const std::string& name) {
    std::vector<Body> bodies{{"soft", read_binary_stl_um(name), name}};
    const Settings settings{{512, 384, 100}, 50, {}};
    auto placed = place_on_platform(bodies, settings.raster);
    if (!placed) return tl::unexpected(placed.error());
    SlicedFile outcome;
    Progress progress;
    const auto summary = slice_bodies(
        bodies, settings,
        [&](int layer, int, const RunImage& runs) {
            const Image image = runs.to_image();
            outcome.full_pixels.resize(static_cast<std::size_t>(layer) + 1, 0);
            long grey = 0;
            for (const auto p : image.pixels) {
                grey += p != 0 && p != 255;
                outcome.full_pixels.back() += p == 255;
            }
            CHECK(grey == 0);
            return Status{};
        },
        progress);
    if (!summary) return tl::unexpected(summary.error());
    outcome.warnings = *placed;
    outcome.warnings.insert(outcome.warnings.end(), summary->warnings.begin(), summary->warnings.end());
    return outcome;
}

void check_layers(const std::string& name, std::size_t layers, long pixels, std::size_t warnings) {
    CAPTURE(name);
    const auto outcome = slice_file(name);
    REQUIRE_MESSAGE(outcome.has_value(), (outcome ? "" : outcome.error().message));
    CHECK(outcome->full_pixels == std::vector<long>(layers, pixels));
    CHECK(outcome->warnings.size() == warnings);
}

}  // namespace

TEST_CASE("good cubes, and cubes that repair makes good, have the full area in every layer") {
    check_layers("cube_good_binary.stl", 200, 10000, 0);
    check_layers("binary_header_says_solid.stl", 200, 10000, 0);
    check_layers("hole_one_triangle.stl", 200, 10000, 1);
    check_layers("t_junction.stl", 200, 10000, 0);
    check_layers("inverted_all.stl", 200, 10000, 1);
    check_layers("duplicate_triangle.stl", 200, 10000, 0);
    check_layers("degenerate_triangles.stl", 200, 10000, 0);
    check_layers("touching_faces.stl", 200, 20000, 0);
    check_layers("shared_vertex.stl", 400, 10000, 0);
    check_layers("far_from_origin.stl", 200, 10000, 1);
    check_layers("flat_on_layer_planes.stl", 1, 10000, 0);
}

TEST_CASE("a cavity stays empty") {
    const auto outcome = slice_file("cavity_inverted_inner.stl");
    REQUIRE(outcome.has_value());
    REQUIRE(outcome->full_pixels.size() == 200);
    for (std::size_t k = 0; k < 200; ++k) CHECK(outcome->full_pixels[k] == (k >= 40 && k < 160 ? 6400 : 10000));
    CHECK(outcome->warnings.empty());
}

TEST_CASE("an open sheet, a 1 um cube and a NaN vertex are refused") {
    CHECK(slice_file("open_sheet.stl").error().message.find("the surface is open") != std::string::npos);
    CHECK(slice_file("tiny_1um_cube.stl").error().message.find("nothing to print") != std::string::npos);
    CHECK(slice_file("binary_nan_vertex.stl").error().message.find("is not finite") != std::string::npos);
}
