#include "printing/job/png.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::job;
using slice::Image;

namespace {

Image pattern(int width, int height) {
    Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height)};
    std::uint32_t state = 12345;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        state = state * 1664525 + 1013904223;
        image.pixels[i] = i % 7 < 4 ? 255 : static_cast<std::uint8_t>(state >> 24);
    }
    return image;
}

std::string refused_png(std::string_view png, PngSize size = {30, 20}) {
    const auto image = decode_png(png, size, "job.zip: layers/1.png");
    REQUIRE(!image.has_value());
    CHECK(image.error().message.find("job.zip: layers/1.png: ") == 0);
    return image.error().message;
}

}  // namespace

TEST_CASE("images are read back as written, from one pixel to a full screen") {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 50}, {50, 1}, {30, 20}, {1920, 1080}}) {
        const Image image = pattern(width, height);
        const auto back = decode_png(encode_png(image), {width, height}, "x");
        REQUIRE(back.has_value());
        CHECK(*back == image);
    }
}

TEST_CASE("an image that was used before, of another size and filled, ends as a new one would") {
    Image image = pattern(70, 50);
    for (const auto& [width, height] : {std::pair{30, 20}, {100, 90}, {1, 1}, {100, 90}}) {
        const Image wanted = pattern(width, height);
        REQUIRE(decode_png(encode_png(wanted), {width, height}, "x", image));
        CHECK(image == wanted);
    }
    std::string damaged = encode_png(pattern(100, 90));
    damaged[damaged.size() / 2] ^= 0x40;
    CHECK_FALSE(decode_png(damaged, {100, 90}, "x", image));
    REQUIRE(decode_png(encode_png(pattern(30, 20)), {30, 20}, "x", image));
    CHECK(image == pattern(30, 20));
}

TEST_CASE("a blank full-screen image takes under 2,300 bytes") {
    const Image blank{1920, 1080, std::vector<std::uint8_t>(1920 * 1080)};
    CHECK(encode_png(blank).size() < 2300);
}

TEST_CASE("other images than 8-bit grey ones of the expected size are refused") {
    const std::string good = encode_png(pattern(30, 20));
    CHECK(refused_png("").find("is not a PNG") != std::string::npos);
    CHECK(refused_png(good.substr(0, 28)).find("is not a PNG") != std::string::npos);
    CHECK(refused_png("GIF89a" + good.substr(6)).find("is not a PNG") != std::string::npos);
    CHECK(refused_png(good, {30, 21}).find("30 x 20 pixels, 30 x 21 are needed") != std::string::npos);
    std::string changed = good;
    changed[24] = 16;
    CHECK(refused_png(changed).find("8-bit grey") != std::string::npos);
    for (const std::size_t length : {good.size() - 13, good.size() / 2, std::size_t{40}})
        refused_png(good.substr(0, length));
    changed = good;
    changed[good.size() / 2] ^= 0x40;  // the checksum of the data no longer holds
    refused_png(changed);
}

TEST_CASE("a header with a false size allocates no memory") {
    std::string liar = encode_png(pattern(30, 20));
    liar[17] = 0x10;  // width 0x10001e: a million pixels
    liar[21] = 0x10;
    CHECK(refused_png(liar, {0x10001e, 0x100014}).find("cannot hold") != std::string::npos);
}

TEST_CASE("rows of every kind are read back, whatever filter was chosen") {
    // Equal rows, blank rows between, sideways steps, moving grey edges: each filter is best somewhere.
    slice::RunImage image(300, 60);
    for (int row = 5; row < 55; ++row) {
        if (row % 11 == 0) continue;
        const int left = row < 20 ? 40 : 40 + 2 * row % 37;
        image.append(row, left - 2, left - 1, static_cast<std::uint8_t>(row * 5));
        image.append(row, left, left + 1, static_cast<std::uint8_t>(100 + row));
        image.append(row, left + 1, 200, 255);
        if (row % 3 == 0) image.append(row, 250, 300, 1);
    }
    const std::string png = encode_png(image);
    CHECK(png == encode_png(image.to_image()));
    const auto back = decode_png(png, {300, 60}, "x");
    REQUIRE(back.has_value());
    CHECK(*back == image.to_image());
}
