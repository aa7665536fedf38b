// Decodes a PNG file, for tests of pictures.
#pragma once

#include <cairo.h>
#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <string_view>

namespace pliant::report::test {

/// Pixels of a PNG file, 4 bytes each: blue, green, red, unused.
struct Pixels {
    int width = 0, height = 0, stride = 0;
    std::string bytes;
    [[nodiscard]] bool white(int x, int y) const {
        const auto at = static_cast<std::size_t>(y * stride + 4 * x);
        return bytes.substr(at, 3) == "\xff\xff\xff";
    }
    [[nodiscard]] std::string colour(int x, int y) const {
        return bytes.substr(static_cast<std::size_t>(y * stride + 4 * x), 3);
    }
};

inline Pixels decode(std::string_view png) {
    const auto read = [](void* from, unsigned char* to, unsigned int length) {
        auto& left = *static_cast<std::string_view*>(from);
        if (length > left.size()) return CAIRO_STATUS_READ_ERROR;
        std::memcpy(to, left.data(), length);
        left.remove_prefix(length);
        return CAIRO_STATUS_SUCCESS;
    };
    cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read, &png);
    REQUIRE(cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS);
    Pixels p{cairo_image_surface_get_width(surface),
             cairo_image_surface_get_height(surface),
             cairo_image_surface_get_stride(surface),
             {}};
    p.bytes.assign(reinterpret_cast<const char*>(cairo_image_surface_get_data(surface)),
                   static_cast<std::size_t>(p.stride * p.height));
    cairo_surface_destroy(surface);
    return p;
}

}  // namespace pliant::report::test
