#include "job/png.hpp"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>

#include "job/rle_deflate.hpp"

namespace pliant::job {
namespace {

constexpr std::array<unsigned char, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t max_deflate_ratio = 1032;

void put_u32(std::string& out, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) out.push_back(static_cast<char>(value >> shift & 0xFF));
}

std::uint32_t get_u32(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

void put_chunk(std::string& out, std::string_view type, std::string_view data) {
    put_u32(out, static_cast<std::uint32_t>(data.size()));
    const std::size_t start = out.size();
    out += type;
    out += data;
    put_u32(out, libdeflate_crc32(0, out.data() + start, out.size() - start));
}

bool is_blank(const std::uint8_t* row, std::size_t width) {
    return row[0] == 0 && std::memcmp(row, row + 1, width - 1) == 0;
}

/// Each row as its difference to the one above ("up", filter 2): rows of a solid part repeat, so most become zeros.
/// Blank rows stay as they are (filter 0), so that they are zeros from end to end.
std::string filtered(const slice::Image& image) {
    const auto width = static_cast<std::size_t>(image.width_px), height = static_cast<std::size_t>(image.height_px);
    std::string rows((width + 1) * height, '\0');
    for (std::size_t r = 0; r < height; ++r) {
        const std::uint8_t* row = image.pixels.data() + r * width;
        const std::uint8_t* above = r > 0 ? row - width : nullptr;
        auto* out = reinterpret_cast<std::uint8_t*>(rows.data() + r * (width + 1));
        if (is_blank(row, width)) continue;
        *out++ = 2;
        if (above == nullptr) {
            std::memcpy(out, row, width);
        } else if (std::memcmp(row, above, width) != 0) {
            for (std::size_t c = 0; c < width; ++c) out[c] = static_cast<std::uint8_t>(row[c] - above[c]);
        }
    }
    return rows;
}

struct FreeDecompressor {
    void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
};

/// The pixels of a file as encode_png() writes them: one IDAT, rows unfiltered or as differences to the row above.
/// Nothing for any other file, which libpng then reads (or refuses). Three times as fast as libpng.
std::optional<slice::Image> decode_own(std::string_view png, const PngSize& size) {
    constexpr std::size_t data_at = 41;  // signature, IHDR, head of IDAT
    if (png.size() < data_at + 16 || png.substr(37, 4) != "IDAT") return std::nullopt;
    const std::size_t length = get_u32(png, 33);
    if (length > png.size() - data_at - 16 || png.substr(data_at + length + 8, 4) != "IEND") return std::nullopt;
    if (libdeflate_crc32(0, png.data() + 37, length + 4) != get_u32(png, data_at + length)) return std::nullopt;
    const auto width = static_cast<std::size_t>(size.width_px), height = static_cast<std::size_t>(size.height_px);
    std::vector<std::uint8_t> rows((width + 1) * height);
    const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> inflate(libdeflate_alloc_decompressor());
    if (!inflate || libdeflate_zlib_decompress(inflate.get(), png.data() + data_at, length, rows.data(), rows.size(),
                                               nullptr) != LIBDEFLATE_SUCCESS)
        return std::nullopt;
    slice::Image image{size.width_px, size.height_px, std::vector<std::uint8_t>(width * height)};
    for (std::size_t r = 0; r < height; ++r) {
        const std::uint8_t* row = rows.data() + r * (width + 1);
        std::uint8_t* out = image.pixels.data() + r * width;
        if (*row != 0 && *row != 2) return std::nullopt;
        std::memcpy(out, row + 1, width);
        if (*row == 0 || r == 0) continue;
        for (std::size_t c = 0; c < width; ++c)
            out[c] = static_cast<std::uint8_t>(
                out[c] + out[static_cast<std::ptrdiff_t>(c) - static_cast<std::ptrdiff_t>(width)]);
    }
    return image;
}

}  // namespace

std::string encode_png(const slice::Image& image) {
    std::string head;
    put_u32(head, static_cast<std::uint32_t>(image.width_px));
    put_u32(head, static_cast<std::uint32_t>(image.height_px));
    head += std::string_view("\x08\0\0\0\0", 5);  // 8 bits, grey, deflate, adaptive filters, not interlaced
    std::string png(reinterpret_cast<const char*>(signature.data()), signature.size());
    put_chunk(png, "IHDR", head);
    put_chunk(png, "IDAT", deflate_runs(filtered(image)));
    put_chunk(png, "IEND", {});
    return png;
}

Result<PngSize> png_size(std::string_view head, std::string_view where) {
    if (head.size() < png_head_bytes || std::memcmp(head.data(), signature.data(), signature.size()) != 0 ||
        head.substr(12, 4) != "IHDR")
        return input_error("{}: is not a PNG image", where);
    const std::uint32_t width = get_u32(head, 16), height = get_u32(head, 20);
    if (head.substr(24, 5) != std::string_view("\x08\0\0\0\0", 5))
        return input_error("{}: an 8-bit grey PNG without interlacing is needed", where);
    if (width == 0 || height == 0 || width > INT32_MAX || height > INT32_MAX)
        return input_error("{}: claims {} x {} pixels", where, width, height);
    return PngSize{static_cast<int>(width), static_cast<int>(height)};
}

Result<slice::Image> decode_png(std::string_view png, const PngSize& expected, std::string_view where) {
    const auto size = png_size(png.substr(0, png_head_bytes), where);
    if (!size) return tl::unexpected(size.error());
    if (size->width_px != expected.width_px || size->height_px != expected.height_px)
        return input_error("{}: {} x {} pixels, the manifest says {} x {}", where, size->width_px, size->height_px,
                           expected.width_px, expected.height_px);
    const std::size_t count = static_cast<std::size_t>(size->width_px) * static_cast<std::size_t>(size->height_px);
    if (count / max_deflate_ratio > png.size())
        return input_error("{}: {} bytes cannot hold {} x {} pixels", where, png.size(), size->width_px,
                           size->height_px);
    if (auto own = decode_own(png, *size)) return std::move(*own);
    png_image reader{};
    reader.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&reader, png.data(), png.size()) == 0)
        return input_error("{}: {}", where, std::string(reader.message));
    reader.format = PNG_FORMAT_GRAY;
    slice::Image image{size->width_px, size->height_px, std::vector<std::uint8_t>(count)};
    const int done = png_image_finish_read(&reader, nullptr, image.pixels.data(), 0, nullptr);
    const std::string message = reader.message;
    png_image_free(&reader);
    if (done == 0) return input_error("{}: {}", where, message);
    return image;
}

}  // namespace pliant::job
