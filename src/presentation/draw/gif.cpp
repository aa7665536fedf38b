#include "presentation/draw/gif.hpp"

#include <gif_lib.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace pliant::report {
namespace {

constexpr int most_colours = 255;  // one of the 256 means that a pixel has not changed
constexpr GifByteType unchanged = 255;
constexpr std::size_t looked_at = 400'000;  // number of pixels, over all frames, from which colours are chosen

struct CloseGif {
    void operator()(GifFileType* file) const {
        int ignored = 0;
        EGifCloseFile(file, &ignored);
    }
};

int append_gif(GifFileType* file, const GifByteType* bytes, int count) {
    static_cast<std::string*>(file->UserData)
        ->append(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count));
    return count;
}

/// The colours of a film, and a cache of the nearest palette colour of any other.
class Palette {
public:
    [[nodiscard]] static Result<Palette> from(std::span<const Image> frames) {
        std::size_t pixels = 0;
        for (const Image& frame : frames) pixels += frame.rgb.size() / 3;
        const std::size_t stride = std::max<std::size_t>(1, pixels / looked_at);
        std::array<std::vector<GifByteType>, 3> planes;
        std::size_t next = 0, before = 0;
        for (const Image& frame : frames) {
            const std::size_t count = frame.rgb.size() / 3;
            for (; next < before + count; next += stride) {
                for (std::size_t c = 0; c < 3; ++c) planes[c].push_back(frame.rgb[3 * (next - before) + c]);
            }
            before += count;
        }
        Palette palette;
        std::vector<GifByteType> ignored(planes[0].size());
        int count = most_colours;
        if (GifQuantizeBuffer(static_cast<unsigned>(planes[0].size()), 1, &count, planes[0].data(), planes[1].data(),
                              planes[2].data(), ignored.data(), palette.colours_.data()) == GIF_ERROR)
            return failure("film: its colours could not be chosen");
        palette.count_ = count;
        palette.settle(planes);
        return palette;
    }

    [[nodiscard]] GifByteType nearest(const std::uint8_t* rgb) {
        std::int16_t& known = nearest_[(std::size_t{rgb[0]} << 16) | (std::size_t{rgb[1]} << 8) | std::size_t{rgb[2]}];
        if (known >= 0) return static_cast<GifByteType>(known);
        int least = 1 << 30;
        for (int k = 0; k < count_; ++k) {
            const GifColorType& colour = colours_[static_cast<std::size_t>(k)];
            const int r = colour.Red - rgb[0], g = colour.Green - rgb[1], b = colour.Blue - rgb[2];
            const int away = r * r + g * g + b * b;
            if (away >= least) continue;
            least = away;
            known = static_cast<std::int16_t>(k);
        }
        return static_cast<GifByteType>(known);
    }
    [[nodiscard]] const GifColorType* colours() const { return colours_.data(); }

private:
    using Planes = std::array<std::vector<GifByteType>, 3>;

    /// giflib quantises to five bits, which tints greys: each colour is replaced by the mean of those that it
    /// represents (Lloyd's iteration).
    void settle(const Planes& planes) {
        constexpr int rounds = 3;
        for (int round = 0; round < rounds; ++round) {
            nearest_.assign(std::size_t{1} << 24, -1);
            std::array<std::array<std::uint64_t, 4>, 256> sums{};
            for (std::size_t p = 0; p < planes[0].size(); ++p) {
                const std::array<std::uint8_t, 3> rgb{planes[0][p], planes[1][p], planes[2][p]};
                auto& sum = sums[nearest(rgb.data())];
                for (std::size_t c = 0; c < 3; ++c) sum[c] += rgb[c];
                ++sum[3];
            }
            const auto mean = [](std::uint64_t sum, std::uint64_t count) {
                return static_cast<GifByteType>((sum + count / 2) / count);
            };
            for (std::size_t k = 0; k < sums.size(); ++k) {
                const auto& [r, g, b, n] = sums[k];
                if (n > 0) colours_[k] = {mean(r, n), mean(g, n), mean(b, n)};
            }
        }
        nearest_.assign(std::size_t{1} << 24, -1);
    }

    std::array<GifColorType, 256> colours_{};
    int count_ = 0;
    std::vector<std::int16_t> nearest_;  ///< (2^24), -1: not computed yet
};

Status write_frame(GifFileType* file, const Image& frame, int ms, Palette& palette, std::vector<GifByteType>& shown) {
    GraphicsControlBlock control{DISPOSE_DO_NOT, false, (ms + 5) / 10, unchanged};
    std::array<GifByteType, 4> bytes{};
    EGifGCBToExtension(&control, bytes.data());
    if (EGifPutExtension(file, GRAPHICS_EXT_FUNC_CODE, static_cast<int>(bytes.size()), bytes.data()) == GIF_ERROR ||
        EGifPutImageDesc(file, 0, 0, frame.width_px, frame.height_px, false, nullptr) == GIF_ERROR)
        return failure("film: {}", GifErrorString(file->Error));
    const auto width = static_cast<std::size_t>(frame.width_px);
    std::vector<GifByteType> line(width);
    for (std::size_t y = 0; y < static_cast<std::size_t>(frame.height_px); ++y) {
        for (std::size_t x = 0; x < width; ++x) {
            const GifByteType now = palette.nearest(&frame.rgb[3 * (y * width + x)]);
            GifByteType& before = shown[y * width + x];
            line[x] = now == before ? unchanged : now;
            before = now;
        }
        if (EGifPutLine(file, line.data(), frame.width_px) == GIF_ERROR)
            return failure("film: {}", GifErrorString(file->Error));
    }
    return {};
}

/// The Netscape extension, which every viewer supports: loop for ever.
Status write_loop(GifFileType* file) {
    const std::array<GifByteType, 3> forever{1, 0, 0};
    if (EGifPutExtensionLeader(file, APPLICATION_EXT_FUNC_CODE) == GIF_ERROR ||
        EGifPutExtensionBlock(file, 11, "NETSCAPE2.0") == GIF_ERROR ||
        EGifPutExtensionBlock(file, static_cast<int>(forever.size()), forever.data()) == GIF_ERROR ||
        EGifPutExtensionTrailer(file) == GIF_ERROR)
        return failure("film: {}", GifErrorString(file->Error));
    return {};
}

}  // namespace

Result<std::string> animated_gif(std::span<const Image> frames, int frame_ms, int last_ms) {
    Result<Palette> palette = Palette::from(frames);
    if (!palette) return tl::unexpected(palette.error());
    std::string bytes;
    int error = 0;
    std::unique_ptr<GifFileType, CloseGif> file(EGifOpen(&bytes, append_gif, &error));
    if (!file) return failure("film: {}", GifErrorString(error));
    EGifSetGifVersion(file.get(), true);
    const std::unique_ptr<ColorMapObject, void (*)(ColorMapObject*)> map(GifMakeMapObject(256, palette->colours()),
                                                                         GifFreeMapObject);
    const Image& first = frames.front();
    if (!map || EGifPutScreenDesc(file.get(), first.width_px, first.height_px, 8, 0, map.get()) == GIF_ERROR)
        return failure("film: {}", GifErrorString(file->Error));
    if (Status status = write_loop(file.get()); !status) return tl::unexpected(status.error());
    std::vector<GifByteType> shown(first.rgb.size() / 3, unchanged);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const int ms = k + 1 == frames.size() ? last_ms : frame_ms;
        if (Status status = write_frame(file.get(), frames[k], ms, *palette, shown); !status)
            return tl::unexpected(status.error());
    }
    if (EGifCloseFile(file.release(), &error) == GIF_ERROR) return failure("film: {}", GifErrorString(error));
    return bytes;
}

}  // namespace pliant::report
