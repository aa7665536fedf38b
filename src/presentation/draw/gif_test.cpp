// Films, read back by giflib.
#include "presentation/draw/gif.hpp"

#include <doctest/doctest.h>
#include <gif_lib.h>

#include <cstring>

using namespace pliant;
using namespace pliant::report;

namespace {

Image square_at(int x) {
    Image image{40, 20, std::vector<std::uint8_t>(40 * 20 * 3, 240)};
    for (int row = 5; row < 15; ++row) {
        for (int column = x; column < x + 8; ++column) {
            const auto at = static_cast<std::size_t>(3 * (row * 40 + column));
            image.rgb[at] = 200;
            image.rgb[at + 1] = 40;
            image.rgb[at + 2] = 32;
        }
    }
    return image;
}

struct Read {
    const std::string& bytes;
    std::size_t at = 0;
};

int read_bytes(GifFileType* file, GifByteType* to, int count) {
    auto& from = *static_cast<Read*>(file->UserData);
    const std::size_t most = std::min(static_cast<std::size_t>(count), from.bytes.size() - from.at);
    std::memcpy(to, from.bytes.data() + from.at, most);
    from.at += most;
    return static_cast<int>(most);
}

}  // namespace

TEST_CASE("a GIF shows each frame unchanged for its time, and repeats for ever") {
    const std::vector<Image> frames = {square_at(2), square_at(12), square_at(22), square_at(22)};
    const Result<std::string> gif = animated_gif(frames, 40, 900);
    REQUIRE(gif);
    CHECK(gif->starts_with("GIF89a"));
    CHECK(gif->find("NETSCAPE2.0") != std::string::npos);
    Read read{*gif};
    int error = 0;
    GifFileType* file = DGifOpen(&read, read_bytes, &error);
    REQUIRE(file != nullptr);
    REQUIRE(DGifSlurp(file) == GIF_OK);
    REQUIRE(file->ImageCount == 4);
    CHECK(file->SWidth == 40);
    std::vector<std::uint8_t> shown(frames[0].rgb.size());
    for (int k = 0; k < 4; ++k) {
        GraphicsControlBlock control{};
        REQUIRE(DGifSavedExtensionToGCB(file, k, &control) == GIF_OK);
        CHECK(control.DelayTime == (k == 3 ? 90 : 4));
        for (std::size_t p = 0; p < shown.size() / 3; ++p) {
            const int index = file->SavedImages[k].RasterBits[p];
            if (index == control.TransparentColor) continue;
            const GifColorType& colour = file->SColorMap->Colors[index];
            shown[3 * p] = colour.Red;
            shown[3 * p + 1] = colour.Green;
            shown[3 * p + 2] = colour.Blue;
        }
        int farthest = 0;
        for (std::size_t b = 0; b < shown.size(); ++b)
            farthest = std::max(farthest, std::abs(shown[b] - frames[static_cast<std::size_t>(k)].rgb[b]));
        CHECK(farthest == 0);  // there are colours enough
    }
    DGifCloseFile(file, &error);
    CHECK(animated_gif(frames, 40, 900).value() == *gif);
}
