#include "printing/job/png.hpp"

#include <libdeflate.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
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

/// The rest of a PNG's header after its size: 8 bits, grey, deflate, adaptive filters, not interlaced.
constexpr std::string_view plain_grey{"\x08\0\0\0\0", 5};

/// The pixels of a file in the form that encode_png() writes: one IDAT, rows unfiltered or as differences to the row
/// above. False for any other file, which is left to libpng. Three times as fast as libpng.
bool decode_own(std::string_view png, const PngSize& size, slice::Image& image) {
    constexpr std::size_t data_at = 41;  // signature, IHDR, header of IDAT
    if (png.size() < data_at + 16 || png.substr(24, 5) != plain_grey || png.substr(37, 4) != "IDAT") return false;
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

/// Bytes for libpng, and its words about an error.
struct PngSource {
    std::string_view left;
    std::array<char, 128> why{};
};

void give_png_bytes(png_structp png, png_bytep to, std::size_t count) {
    auto& source = *static_cast<PngSource*>(png_get_io_ptr(png));
    if (count > source.left.size()) png_error(png, "the file ends too early");
    std::memcpy(to, source.left.data(), count);
    source.left.remove_prefix(count);
}

[[noreturn]] void keep_png_error(png_structp png, png_const_charp why) {
    auto& source = *static_cast<PngSource*>(png_get_error_ptr(png));
    std::strncpy(source.why.data(), why, source.why.size() - 1);
    png_longjmp(png, 1);
}

void drop_png_warning(png_structp, png_const_charp) {}

/// A grey value of 8-bit samples: colours with the weights of sRGB's primaries, transparent pixels over black.
std::uint8_t grey_of(const std::uint8_t* samples, int channels) {
    unsigned value = samples[0];
    if (channels >= 3) value = (6968U * samples[0] + 23434U * samples[1] + 2366U * samples[2] + (1U << 14)) >> 15;
    if (channels % 2 == 0) value = (value * samples[channels - 1] + 127) / 255;
    return static_cast<std::uint8_t>(value);
}

/// A PNG of any kind, read with libpng as the samples that it holds: these are shares of light for a projector, so
/// what a file says of its gamma is for screens, and is not applied. (The simple functions of libpng apply it, and take
/// 16 bits as linear light.) After an error libpng jumps back: nothing in begin() and read() needs a destructor.
class PngReader {
public:
    explicit PngReader(std::string_view bytes)
        : source_{bytes},
          png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, keep_png_error, drop_png_warning)),
          info_(png_ != nullptr ? png_create_info_struct(png_) : nullptr) {}
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    bool begin() {
        if (info_ == nullptr) return false;
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        png_set_read_fn(png_, &source_, give_png_bytes);
        png_set_benign_errors(png_, 1);
        png_read_info(png_, info_);
        png_set_expand(png_);  // palettes, fewer bits, transparent colours
        png_set_scale_16(png_);
        passes_ = png_set_interlace_handling(png_);
        png_read_update_info(png_, info_);
        return true;
    }

    /// Number of bytes that read() needs beside the image: a row, or all rows of an interlaced file; none where the
    /// samples are the pixels.
    [[nodiscard]] std::size_t spare_bytes(const PngSize& size) const {
        if (channels() == 1) return 0;
        return png_get_rowbytes(png_, info_) * static_cast<std::size_t>(passes_ > 1 ? size.height_px : 1);
    }

    bool read(const PngSize& size, std::uint8_t* pixels, std::uint8_t* spare) {
        if (setjmp(png_jmpbuf(png_)) != 0) return false;
        for (int pass = 0; pass < passes_; ++pass) {
            for (std::size_t row = 0; row < static_cast<std::size_t>(size.height_px); ++row)
                read_row(row, static_cast<std::size_t>(size.width_px), pixels, spare);
        }
        return true;
    }

    [[nodiscard]] std::string why() const { return source_.why[0] != 0 ? source_.why.data() : "no memory is left"; }

private:
    [[nodiscard]] int channels() const { return png_get_channels(png_, info_); }

    void read_row(std::size_t row, std::size_t width, std::uint8_t* pixels, std::uint8_t* spare) {
        std::uint8_t* out = pixels + row * width;
        const int n = channels();
        if (n == 1) return png_read_row(png_, out, nullptr);
        std::uint8_t* samples = passes_ > 1 ? spare + row * png_get_rowbytes(png_, info_) : spare;
        png_read_row(png_, samples, nullptr);
        for (std::size_t c = 0; c < width; ++c) out[c] = grey_of(samples + c * static_cast<std::size_t>(n), n);
    }

    PngSource source_;
    png_structp png_;
    png_infop info_;
    int passes_ = 1;
};

}  // namespace

std::string encode_png(const slice::Image& image) {
    return encode_png(slice::RunImage::from_image(image));
}

std::string encode_png(const slice::RunImage& image) {
    std::string head;
    put_u32(head, static_cast<std::uint32_t>(image.width_px()));
    put_u32(head, static_cast<std::uint32_t>(image.height_px()));
    head += plain_grey;
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
    PngReader reader(png);
    if (!reader.begin()) return input_error("{}: {}", where, reader.why());
    image.width_px = size.width_px;
    image.height_px = size.height_px;
    image.pixels.resize(count);
    std::vector<std::uint8_t> spare(reader.spare_bytes(size));
    if (!reader.read(size, image.pixels.data(), spare.data())) return input_error("{}: {}", where, reader.why());
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
    if (size && head.substr(24, 5) != plain_grey)
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
