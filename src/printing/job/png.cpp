#include "printing/job/png.hpp"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "printing/job/rle_deflate.hpp"

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

/// Equal bytes of a row, up to the column `end`.
struct Piece {
    int end;
    std::uint8_t value;
};

/// A row of pixels as pieces from the first column to the last, including dark ones.
void spell_row(std::span<const slice::Run> runs, int width, std::vector<Piece>& pieces) {
    pieces.clear();
    int at = 0;
    for (const slice::Run& run : runs) {
        if (run.begin > at) pieces.push_back({run.begin, 0});
        pieces.push_back({run.end, run.value});
        at = run.end;
    }
    if (at < width) pieces.push_back({width, 0});
}

/// The difference of a row to the one above it, byte by byte.
void subtract(const std::vector<Piece>& row, const std::vector<Piece>& above, std::vector<Piece>& difference) {
    difference.clear();
    for (auto r = row.begin(), a = above.begin(); r != row.end();) {
        const int end = std::min(r->end, a->end);
        const auto value = static_cast<std::uint8_t>(r->value - a->value);
        if (!difference.empty() && difference.back().value == value) {
            difference.back().end = end;
        } else {
            difference.push_back({end, value});
        }
        if (r->end == end) ++r;
        if (a->end == end) ++a;
    }
}

/// Estimated number of bits for the pieces: 0, 255 (edges of a solid) and 1 (steps of a full pixel) are frequent, so
/// short.
int cost(const std::vector<Piece>& pieces) {
    int bits = 0, at = 0;
    for (const Piece& piece : pieces) {
        bits += piece.value == 0 || piece.value == 255 || piece.value == 1 ? 3 : 9;
        if (piece.end - at > 3) bits += 9;
        at = piece.end;
    }
    return bits;
}

/// The bytes that a PNG file compresses: for each row the number of a filter, then the filtered row. Rows are
/// unfiltered (filter 0) or differences to the row above ("up", filter 2), whichever is smaller.
class RowPacker {
public:
    explicit RowPacker(const slice::RunImage& image) : image_(image) {}

    std::string pack() {
        const auto row_bytes = static_cast<std::uint64_t>(image_.width_px()) + 1;
        out_.add(0, row_bytes * static_cast<std::uint64_t>(image_.first_row()));
        spell_row({}, image_.width_px(), above_);
        for (int r = image_.first_row(); r < image_.end_row(); ++r) pack_row(r);
        out_.add(0, row_bytes * static_cast<std::uint64_t>(image_.height_px() - image_.end_row()));
        return out_.finish();
    }

private:
    void pack_row(int r) {
        const std::span<const slice::Run> runs = image_.row(r);
        const int width = image_.width_px();
        if (runs.empty()) {
            out_.add(0, static_cast<std::uint64_t>(width) + 1);
            spell_row(runs, width, above_);
            return;
        }
        if (r > 0 && std::ranges::equal(runs, image_.row(r - 1))) {
            out_.add(2, 1);
            out_.add(0, static_cast<std::uint64_t>(width));
            return;
        }
        spell_row(runs, width, row_);
        subtract(row_, above_, difference_);
        const bool up = cost(difference_) < cost(row_);
        out_.add(up ? 2 : 0, 1);
        int at = 0;
        for (const Piece& piece : up ? difference_ : row_) {
            out_.add(piece.value, static_cast<std::uint64_t>(piece.end - at));
            at = piece.end;
        }
        std::swap(row_, above_);
    }

    const slice::RunImage& image_;
    std::vector<Piece> row_, above_, difference_;
    RunDeflater out_;
};

struct FreeDecompressor {
    void operator()(libdeflate_decompressor* d) const { libdeflate_free_decompressor(d); }
};

/// The pixels of a file in the form that encode_png() writes: one IDAT, rows unfiltered or as differences to the row
/// above. False for any other file, which is left to libpng. Three times as fast as libpng.
bool decode_own(std::string_view png, const PngSize& size, slice::Image& image) {
    constexpr std::size_t data_at = 41;  // signature, IHDR, header of IDAT
    if (png.size() < data_at + 16 || png.substr(37, 4) != "IDAT") return false;
    const std::size_t length = get_u32(png, 33);
    if (length > png.size() - data_at - 16 || png.substr(data_at + length + 8, 4) != "IEND") return false;
    if (libdeflate_crc32(0, png.data() + 37, length + 4) != get_u32(png, data_at + length)) return false;
    const auto width = static_cast<std::size_t>(size.width_px), height = static_cast<std::size_t>(size.height_px);
    std::vector<std::uint8_t>& bytes = image.pixels;
    bytes.resize((width + 1) * height);
    const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> inflate(libdeflate_alloc_decompressor());
    if (!inflate || libdeflate_zlib_decompress(inflate.get(), png.data() + data_at, length, bytes.data(), bytes.size(),
                                               nullptr) != LIBDEFLATE_SUCCESS)
        return false;
    // In place: a row of pixels ends before the next row, with the number of its filter, begins.
    for (std::size_t r = 0; r < height; ++r) {
        const std::uint8_t* row = bytes.data() + r * (width + 1);
        std::uint8_t* out = bytes.data() + r * width;
        const std::uint8_t filter = *row;
        if (filter != 0 && filter != 2) return false;
        std::memmove(out, row + 1, width);
        if (filter == 0 || r == 0) continue;
        for (std::size_t c = 0; c < width; ++c)
            out[c] = static_cast<std::uint8_t>(
                out[c] + out[static_cast<std::ptrdiff_t>(c) - static_cast<std::ptrdiff_t>(width)]);
    }
    bytes.resize(width * height);
    image.width_px = size.width_px;
    image.height_px = size.height_px;
    return true;
}

}  // namespace

std::string encode_png(const slice::Image& image) {
    return encode_png(slice::RunImage::from_image(image));
}

std::string encode_png(const slice::RunImage& image) {
    std::string head;
    put_u32(head, static_cast<std::uint32_t>(image.width_px()));
    put_u32(head, static_cast<std::uint32_t>(image.height_px()));
    head += std::string_view("\x08\0\0\0\0", 5);  // 8 bits, grey, deflate, adaptive filters, not interlaced
    std::string png(reinterpret_cast<const char*>(signature.data()), signature.size());
    put_chunk(png, "IHDR", head);
    put_chunk(png, "IDAT", RowPacker(image).pack());
    put_chunk(png, "IEND", {});
    return png;
}

namespace {

Result<PngSize> size_in_header(std::string_view head, std::string_view where) {
    if (head.size() < png_head_bytes || std::memcmp(head.data(), signature.data(), signature.size()) != 0 ||
        head.substr(12, 4) != "IHDR")
        return input_error("{}: is not a PNG image", where);
    const std::uint32_t width = get_u32(head, 16), height = get_u32(head, 20);
    if (width == 0 || height == 0 || width > INT32_MAX || height > INT32_MAX)
        return input_error("{}: claims {} x {} pixels", where, width, height);
    return PngSize{static_cast<int>(width), static_cast<int>(height)};
}

/// `size`: from the header.
Status decode(std::string_view png, const PngSize& size, std::string_view where, slice::Image& image) {
    const std::size_t count = static_cast<std::size_t>(size.width_px) * static_cast<std::size_t>(size.height_px);
    if (decode_own(png, size, image)) return {};
    png_image reader{};
    reader.version = PNG_IMAGE_VERSION;
    if (png_image_begin_read_from_memory(&reader, png.data(), png.size()) == 0)
        return input_error("{}: {}", where, std::string(reader.message));
    reader.format = PNG_FORMAT_GRAY;
    image.width_px = size.width_px;
    image.height_px = size.height_px;
    image.pixels.resize(count);
    const png_color black{0, 0, 0};
    const int done = png_image_finish_read(&reader, &black, image.pixels.data(), 0, nullptr);
    const std::string message = reader.message;
    png_image_free(&reader);
    if (done == 0) return input_error("{}: {}", where, message);
    return {};
}

Status check_size(const PngSize& size, const PngSize& expected, std::string_view where) {
    if (size.width_px != expected.width_px || size.height_px != expected.height_px)
        return input_error("{}: {} x {} pixels, {} x {} are needed", where, size.width_px, size.height_px,
                           expected.width_px, expected.height_px);
    return {};
}

}  // namespace

Result<PngSize> png_size(std::string_view head, std::string_view where) {
    const auto size = size_in_header(head, where);
    if (size && head.substr(24, 5) != std::string_view("\x08\0\0\0\0", 5))
        return input_error("{}: an 8-bit grey PNG without interlacing is needed", where);
    return size;
}

Result<slice::Image> decode_png(std::string_view png, const PngSize& expected, std::string_view where) {
    slice::Image image;
    if (Status status = decode_png(png, expected, where, image); !status) return tl::unexpected(status.error());
    return image;
}

Status decode_png(std::string_view png, const PngSize& expected, std::string_view where, slice::Image& image) {
    const auto size = png_size(png.substr(0, png_head_bytes), where);
    if (!size) return tl::unexpected(size.error());
    if (auto status = check_size(*size, expected, where); !status) return tl::unexpected(status.error());
    const std::size_t count = static_cast<std::size_t>(size->width_px) * static_cast<std::size_t>(size->height_px);
    if (count / max_deflate_ratio > png.size())
        return input_error("{}: {} bytes cannot hold {} x {} pixels", where, png.size(), size->width_px,
                           size->height_px);
    return decode(png, *size, where, image);
}

Result<PngSize> any_png_size(std::string_view png, std::string_view where) {
    const auto size = size_in_header(png.substr(0, png_head_bytes), where);
    constexpr long long most = 1LL << 28;
    if (size && static_cast<long long>(size->width_px) * size->height_px > most)
        return input_error("{}: {} x {} pixels, more than 2^28", where, size->width_px, size->height_px);
    // A pixel takes at least one bit, compressed.
    if (size &&
        static_cast<std::size_t>(size->width_px) * static_cast<std::size_t>(size->height_px) / 8 / max_deflate_ratio >
            png.size())
        return input_error("{}: {} bytes cannot hold {} x {} pixels", where, png.size(), size->width_px,
                           size->height_px);
    return size;
}

Result<slice::Image> decode_any_png(std::string_view png, const PngSize& expected, std::string_view where) {
    const auto size = any_png_size(png, where);
    if (!size) return tl::unexpected(size.error());
    if (auto status = check_size(*size, expected, where); !status) return tl::unexpected(status.error());
    slice::Image image;
    if (Status status = decode(png, *size, where, image); !status) return tl::unexpected(status.error());
    return image;
}

}  // namespace pliant::job
