#include "presentation/print_report/job_picture.hpp"

#include <cairo.h>
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>

#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::report;
namespace fs = std::filesystem;

namespace {

/// Two layers of 20 x 10 pixels, the lower of the first material, the upper of the second on its right half.
Result<std::string> picture(bool blank) {
    const pliant::test::Folder folder("picture");
    const fs::path path = folder / "job.zip";
    job::Manifest m{"two", "0", 64, 48, 100, 0, {{"soft", "s", 1, 0, 1, 1}, {"rigid", "r", 1, 0, 1, 1}}, {}, {}};
    m.layers = {{50, 50, {}}, {100, 50, {}}};
    auto writer = job::Writer::create(path);
    for (int k = 0; k < 2 && !blank; ++k) {
        slice::RunImage image(64, 48);
        for (int row = 20; row < 30; ++row) image.append(row, 20 + 10 * k, 40, 255);
        const std::string file = k == 0 ? "layers/a.png" : "layers/b.png";
        REQUIRE(writer->add_image(file, job::encode(image)).has_value());
        m.layers[static_cast<std::size_t>(k)].images = {{k, file, 1}};
    }
    REQUIRE(writer->finish(m).has_value());
    const auto archive = job::Archive::open(path);
    REQUIRE(archive.has_value());
    return job_picture(*archive);
}

struct Source {
    const std::string& bytes;
    std::size_t at = 0;
};

cairo_status_t read(void* closure, unsigned char* data, unsigned int length) {
    auto& source = *static_cast<Source*>(closure);
    if (source.at + length > source.bytes.size()) return CAIRO_STATUS_READ_ERROR;
    std::memcpy(data, source.bytes.data() + source.at, length);
    source.at += length;
    return CAIRO_STATUS_SUCCESS;
}

}  // namespace

TEST_CASE("the front view shows where each material is") {
    const auto png = picture(false);
    REQUIRE_MESSAGE(png.has_value(), (png ? "" : png.error().message));
    Source source{*png};
    cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read, &source);
    REQUIRE(cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS);
    CHECK(cairo_image_surface_get_width(surface) == 1600);
    CHECK(cairo_image_surface_get_height(surface) == 1000);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    const auto colour = [&](int x, int y) {
        return std::string(reinterpret_cast<const char*>(data) + y * stride + 4 * x, 3);
    };
    // 2 mm wide on 640 pixels from x = 60, 0.1 mm high on 32 from y = 160: the upper layer above, its left half dark.
    const std::string lower = colour(100, 184), upper = colour(600, 168), empty = colour(100, 168);
    CHECK(lower != upper);
    CHECK(lower != empty);
    CHECK(upper != empty);
    CHECK(colour(600, 184) == lower);
    CHECK(colour(30, 500) == "\xff\xff\xff");
    cairo_surface_destroy(surface);
}

TEST_CASE("a job without any exposure has no picture") {
    CHECK(picture(true).error().message == "two: no layer is lit");
}
