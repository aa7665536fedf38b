#include "presentation/report/mesh_picture.hpp"

#include <cairo.h>
#include <doctest/doctest.h>

#include <cstring>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

struct Source {
    std::string_view bytes;
    static cairo_status_t read(void* closure, unsigned char* out, unsigned count) {
        auto& self = *static_cast<Source*>(closure);
        if (count > self.bytes.size()) return CAIRO_STATUS_READ_ERROR;
        std::memcpy(out, self.bytes.data(), count);
        self.bytes.remove_prefix(count);
        return CAIRO_STATUS_SUCCESS;
    }
};

/// Pixels of the 1600 x 900 picture in which red outweighs blue (the poor bins), and those where blue does.
std::pair<int, int> red_and_blue(const std::string& png) {
    Source source{png};
    cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(&Source::read, &source);
    CHECK(cairo_image_surface_get_width(surface) == 1600);
    CHECK(cairo_image_surface_get_height(surface) == 900);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    std::pair<int, int> count;
    for (int y = 0; y < 900; ++y) {
        for (int x = 0; x < 1600; ++x) {
            const unsigned char* p = data + y * stride + 4 * x;  // blue, green, red
            count.first += p[2] > p[0] + 80 ? 1 : 0;
            count.second += p[0] > p[2] + 80 ? 1 : 0;
        }
    }
    cairo_surface_destroy(surface);
    return count;
}

}  // namespace

TEST_CASE("bars are as high as their share, and poor shapes are red") {
    mesh::MeshReport report;
    report.tets = 40;
    report.regions = {{"soft <foam>", 40, 1.0}};
    report.quality_counts[12] = 40;
    report.dihedral_counts[10] = 240;
    const auto good = mesh_picture_png("a mesh", report);
    REQUIRE(good);
    const auto [red, blue] = red_and_blue(*good);
    CHECK(red == 0);
    CHECK(blue > 20000);  // two whole bars
    report.quality_counts[0] = 40;
    report.dihedral_counts[35] = 240;
    const auto bad = mesh_picture_png("a mesh", report);
    REQUIRE(bad);
    CHECK(red_and_blue(*bad).first == near(blue, {.relative = 0.05}));
    CHECK(mesh_picture_png("", mesh::MeshReport{}));
}
