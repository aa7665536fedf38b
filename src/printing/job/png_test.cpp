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

namespace {

/// A PNG as another program may write it, without compression; `data`: filters and samples of all rows.
struct OtherPng {
    int bits = 8, colour = 0;  ///< 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGB and alpha
    bool interlaced = false;
    std::string chunks{};  ///< between header and data

    static std::string u32(std::uint32_t value) {
        std::string out;
        for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(value >> shift & 0xFF));
        return out;
    }

    static std::string chunk(const std::string& type, const std::string& data) {
        std::uint32_t crc = ~0U;
        for (const char c : type + data) {
            crc ^= static_cast<unsigned char>(c);
            for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1U ? 0xEDB88320U : 0U);
        }
        return u32(static_cast<std::uint32_t>(data.size())) + type + data + u32(~crc);
    }

    static std::string gamma(std::uint32_t value) { return chunk("gAMA", u32(value)); }

    [[nodiscard]] std::string bytes(int width, int height, const std::string& data) const {
        std::uint32_t a = 1, b = 0;
        for (const char c : data) {
            a = (a + static_cast<unsigned char>(c)) % 65521;
            b = (b + a) % 65521;
        }
        const auto n = static_cast<std::uint32_t>(data.size());
        std::string stored{"\x78\x01\x01", 3};
        for (const std::uint32_t word : {n, ~n}) {
            stored.push_back(static_cast<char>(word & 0xFF));
            stored.push_back(static_cast<char>(word >> 8 & 0xFF));
        }
        const std::string head = u32(static_cast<std::uint32_t>(width)) + u32(static_cast<std::uint32_t>(height)) +
                                 static_cast<char>(bits) + static_cast<char>(colour) + '\0' + '\0' +
                                 static_cast<char>(interlaced ? 1 : 0);
        return "\x89PNG\r\n\x1A\n" + chunk("IHDR", head) + chunks + chunk("IDAT", stored + data + u32(b << 16 | a)) +
               chunk("IEND", "");
    }

    /// The grey values of an image of two rows of two pixels.
    [[nodiscard]] std::vector<int> greys(std::initializer_list<int> data) const {
        std::string raw;
        for (const int byte : data) raw.push_back(static_cast<char>(byte));
        const auto image = decode_any_png(bytes(2, 2, raw), {2, 2}, "x");
        REQUIRE_MESSAGE(image.has_value(), (image ? "" : image.error().message));
        return {image->pixels.begin(), image->pixels.end()};
    }
};

}  // namespace

TEST_CASE("samples of PNG files of all kinds are taken as they are, whatever their gamma") {
    using Values = std::vector<int>;
    const Values wanted{0, 128, 255, 7};
    for (const std::uint32_t gamma : {0U, 100000U, 45455U, 220000U}) {
        CAPTURE(gamma);
        const std::string chunks = gamma > 0 ? OtherPng::gamma(gamma) : "";
        CHECK(OtherPng{8, 0, false, chunks}.greys({0, 0, 128, 0, 255, 7}) == wanted);
        CHECK(OtherPng{16, 0, false, chunks}.greys({0, 0, 0, 128, 128, 0, 255, 255, 7, 7}) == wanted);
        CHECK(OtherPng{8, 0, true, chunks}.greys({0, 0, 0, 128, 0, 255, 7}) == wanted);
        CHECK(OtherPng{8, 2, false, chunks}.greys({0, 0, 0, 0, 128, 128, 128, 0, 255, 255, 255, 7, 7, 7}) == wanted);
        // Light that shows through in part is a share of the light.
        CHECK(OtherPng{8, 4, false, chunks}.greys({0, 255, 0, 255, 128, 0, 255, 255, 14, 128}) == wanted);
        CHECK(OtherPng{8, 4, true, chunks}.greys({0, 255, 0, 0, 255, 128, 0, 255, 255, 14, 128}) == wanted);
        CHECK(OtherPng{8, 6, false, chunks}.greys(
                  {0, 9, 9, 9, 0, 255, 255, 255, 128, 0, 255, 255, 255, 255, 7, 7, 7, 255}) == wanted);
        CHECK(OtherPng{1, 0, false, chunks}.greys({0, 0x40, 0, 0x80}) == Values{0, 255, 255, 0});
        const std::string palette = OtherPng::chunk("PLTE", {"\0\0\0\x80\x80\x80\xFF\xFF\xFF\x07\x07\x07", 12});
        CHECK(OtherPng{8, 3, false, chunks + palette}.greys({0, 0, 1, 0, 2, 3}) == wanted);
    }
    // A mask of a printer file goes the strict way.
    const std::string mask = OtherPng{8, 0, false, OtherPng::gamma(100000)}.bytes(2, 1, {"\0\x80\x40", 3});
    CHECK(decode_png(mask, {2, 1}, "x")->pixels == std::vector<std::uint8_t>{128, 64});
    // A column of one pixel of one bit: as many bytes as one of eight bits.
    CHECK(decode_any_png(OtherPng{1}.bytes(1, 2, {"\0\x80\0\0", 4}), {1, 2}, "x")->pixels ==
          std::vector<std::uint8_t>{255, 0});
}
