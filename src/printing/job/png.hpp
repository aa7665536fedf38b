// 8-bit grey PNG files in memory.
#pragma once

#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::job {

struct PngSize {
    int width_px = 0;
    int height_px = 0;
};

/// Number of leading bytes that contain a PNG's size and kind.
inline constexpr std::size_t png_head_bytes = 29;

/// Not interlaced; optimised for speed, not size. Preconditions: at least one pixel, and as many values as pixels.
[[nodiscard]] std::string encode_png(const slice::Image& image);
/// Directly from runs, without ever expanding the pixels.
[[nodiscard]] std::string encode_png(const slice::RunImage& image);

/// Reads signature and header. Errors (prefixed with `where`): not a PNG; not 8-bit grey without interlacing.
[[nodiscard]] Result<PngSize> png_size(std::string_view head, std::string_view where);

/// Decodes; the size must be `expected`, which the caller has accepted. Memory is allocated only if the file is long
/// enough to hold that many pixels at deflate's maximum ratio.
[[nodiscard]] Result<slice::Image> decode_png(std::string_view png, const PngSize& expected, std::string_view where);
/// The same into an image that is there, whose memory is used again: for many images of one size. After an error its
/// content is anything.
[[nodiscard]] Status decode_png(std::string_view png, const PngSize& expected, std::string_view where,
                                slice::Image& image);

/// The same for PNG images of any kind; at most 2^28 pixels. The samples are taken as they are, whatever the file says
/// of its gamma: 16 bits are rounded to 8, colours become grey, transparent pixels dark in proportion.
[[nodiscard]] Result<PngSize> any_png_size(std::string_view png, std::string_view where);
[[nodiscard]] Result<slice::Image> decode_any_png(std::string_view png, const PngSize& expected,
                                                  std::string_view where);

}  // namespace pliant::job
