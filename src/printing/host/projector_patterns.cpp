#include "printing/host/projector_patterns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"

namespace pliant::host {
namespace {

constexpr int least_px = 16;
constexpr int most_px = 32768;
constexpr std::uint8_t full = 255;

/// Draws on an image, with clipping.
class Canvas {
public:
    Canvas(int width_px, int height_px, std::uint8_t ground = 0)
        : image_{width_px, height_px,
                 std::vector<std::uint8_t>(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px),
                                           ground)} {}

    [[nodiscard]] int width() const { return image_.width_px; }
    [[nodiscard]] int height() const { return image_.height_px; }
    job::Image take() { return std::move(image_); }

    void set(int x, int y, std::uint8_t value = full) {
        if (x < 0 || y < 0 || x >= width() || y >= height()) return;
        image_.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) + static_cast<std::size_t>(x)] =
            value;
    }
    void horizontal(int x0, int x1, int y, std::uint8_t value = full) {
        for (int x = x0; x <= x1; ++x) set(x, y, value);
    }
    void vertical(int x, int y0, int y1, std::uint8_t value = full) {
        for (int y = y0; y <= y1; ++y) set(x, y, value);
    }
    void frame(int x0, int y0, int x1, int y1) {
        horizontal(x0, x1, y0);
        horizontal(x0, x1, y1);
        vertical(x0, y0, y1);
        vertical(x1, y0, y1);
    }
    void block(int x0, int y0, int x1, int y1, std::uint8_t value = full) {
        for (int y = y0; y <= y1; ++y) horizontal(x0, x1, y, value);
    }

private:
    job::Image image_;
};

job::Image checkerboard(const PatternOptions& o) {
    Canvas canvas(o.width_px, o.height_px);
    for (int y = 0; y < o.height_px; ++y) {
        for (int x = 0; x < o.width_px; ++x) canvas.set(x, y, (x / o.square_px + y / o.square_px) % 2 == 0 ? full : 0);
    }
    return canvas.take();
}

/// Vertical and horizontal stripes of 1, 2 and 3 pixels, `size` wide: if the image is sharp they stay separate,
/// otherwise they blur to grey.
void stripes(Canvas& canvas, int x0, int y0, int size) {
    for (int group = 0; group < 3; ++group) {
        const int width = group + 1;
        const int left = x0 + group * (size + 4);
        for (int i = 0; i < size; ++i) {
            if (i / width % 2 != 0) continue;
            canvas.vertical(left + i, y0, y0 + size - 1);
            canvas.horizontal(left, left + size - 1, y0 + size + 4 + i);
        }
    }
}

/// Fine lines everywhere, and stripes in the centre and near the corners, where a lens is worst.
job::Image focus_grid(const PatternOptions& o) {
    Canvas canvas(o.width_px, o.height_px);
    const int pitch = std::max(8, std::min(o.width_px, o.height_px) / 18);
    for (int x = o.width_px / 2 % pitch; x < o.width_px; x += pitch) canvas.vertical(x, 0, o.height_px - 1);
    for (int y = o.height_px / 2 % pitch; y < o.height_px; y += pitch) canvas.horizontal(0, o.width_px - 1, y);
    const int size = std::max(6, std::min(o.width_px, o.height_px) / 24);
    const int wide = 3 * size + 8;
    const int high = 2 * size + 4;
    for (const int column : {0, 1, 2}) {
        for (const int row : {0, 1, 2}) {
            const int x0 = column * (o.width_px - wide - 8) / 2 + 4;
            const int y0 = row * (o.height_px - high - 8) / 2 + 4;
            canvas.block(x0 - 3, y0 - 3, x0 + wide + 2, y0 + high + 2, 0);
            stripes(canvas, x0, y0, size);
        }
    }
    return canvas.take();
}

/// Marks along both centre lines, outwards from the centre: a short one every millimetre, a long one every ten.
void ruler(Canvas& canvas, double pixel_um) {
    const double mark_px = pixel_um > 0 ? 1000 / pixel_um : 10;
    if (mark_px < 3) return ruler(canvas, pixel_um / 10);  // only one in ten
    const int cx = canvas.width() / 2;
    const int cy = canvas.height() / 2;
    for (int i = 1; i * mark_px < std::max(canvas.width(), canvas.height()) / 2.0; ++i) {
        const int off = static_cast<int>(std::lround(i * mark_px));
        const int length = i % 10 == 0 ? 8 : i % 5 == 0 ? 5 : 2;
        for (const int sign : {-1, 1}) {
            canvas.vertical(cx + sign * off, cy - length, cy + length);
            canvas.horizontal(cx - length, cx + length, cy + sign * off);
        }
    }
}

/// The outermost pixels, the rectangle to be measured, the centre with rulers, and a block that marks the top left.
job::Image border(const PatternOptions& o) {
    Canvas canvas(o.width_px, o.height_px);
    canvas.frame(0, 0, o.width_px - 1, o.height_px - 1);
    const MeasuredSpan span = measured_span(o.width_px, o.height_px);
    const int x0 = (o.width_px - span.x_px) / 2;
    const int y0 = (o.height_px - span.y_px) / 2;
    canvas.frame(x0, y0, x0 + span.x_px, y0 + span.y_px);
    canvas.horizontal(0, o.width_px - 1, o.height_px / 2);
    canvas.vertical(o.width_px / 2, 0, o.height_px - 1);
    ruler(canvas, o.pixel_um);
    const int size = std::max(2, std::min(o.width_px, o.height_px) / 40);
    canvas.block(2, 2, 1 + 2 * size, 1 + size);
    return canvas.take();
}

/// Upper half: every value from 0 to 255 from left to right; lower half: 16 steps.
job::Image ramp(const PatternOptions& o) {
    Canvas canvas(o.width_px, o.height_px);
    for (int x = 0; x < o.width_px; ++x) {
        canvas.vertical(x, 0, o.height_px / 2 - 1, static_cast<std::uint8_t>(x * 256L / o.width_px));
        canvas.vertical(x, o.height_px / 2, o.height_px - 1, static_cast<std::uint8_t>(x * 16L / o.width_px * 17));
    }
    return canvas.take();
}

/// White, with a dark ring at each place where the light is to be measured; the inside of the ring is white.
job::Image points(const PatternOptions& o) {
    Canvas canvas(o.width_px, o.height_px, full);
    const int radius = std::max(3, std::min(o.width_px / o.columns, o.height_px / o.rows) / 6);
    for (int row = 0; row < o.rows; ++row) {
        for (int column = 0; column < o.columns; ++column) {
            const int cx = static_cast<int>(std::lround(point_px(column, o.columns, o.width_px) - 0.5));
            const int cy = static_cast<int>(std::lround(point_px(row, o.rows, o.height_px) - 0.5));
            for (int y = -radius; y <= radius; ++y) {
                for (int x = -radius; x <= radius; ++x) {
                    if (std::lround(std::hypot(x, y)) == radius) canvas.set(cx + x, cy + y, 0);
                }
            }
        }
    }
    return canvas.take();
}

Status check(const PatternOptions& o) {
    if (o.width_px < least_px || o.height_px < least_px || o.width_px > most_px || o.height_px > most_px)
        return input_error("a pattern of {} x {} px: must be {} to {} each way", o.width_px, o.height_px, least_px,
                           most_px);
    if (o.square_px < 1 || o.square_px > most_px)
        return input_error("squares of {} px: must be 1 to {}", o.square_px, most_px);
    if (o.columns < 2 || o.rows < 2 || o.columns > 100 || o.rows > 100)
        return input_error("{} x {} points: must be 2 to 100 each way", o.columns, o.rows);
    return {};
}

/// Linear interpolation in a row of samples, at position `at` (in samples, from 0).
struct Between {
    int low = 0, high = 0;
    double share = 0;
};
Between between(double px, int count, int length_px) {
    const double at = std::clamp(px * count / length_px - 0.5, 0.0, count - 1.0);
    const int low = std::min(static_cast<int>(at), count - 2);
    return {low, low + 1, at - low};
}

std::optional<double> read_number(std::string_view& line) {
    constexpr std::string_view blanks = " \t,;\r";
    line.remove_prefix(std::min(line.size(), line.find_first_not_of(blanks)));
    const std::string_view word = line.substr(0, line.find_first_of(blanks));
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    line.remove_prefix(word.size());
    return value;
}

}  // namespace

std::span<const std::string> pattern_names() {
    static const std::array<std::string, 7> names = {"white",  "black", "checkerboard", "grid",
                                                     "border", "ramp",  "points"};
    return names;
}

Result<job::Image> test_pattern(std::string_view name, const PatternOptions& options) {
    if (Status status = check(options); !status) return tl::unexpected(status.error());
    if (name == "white") return Canvas(options.width_px, options.height_px, full).take();
    if (name == "black") return Canvas(options.width_px, options.height_px).take();
    if (name == "checkerboard") return checkerboard(options);
    if (name == "grid") return focus_grid(options);
    if (name == "border") return border(options);
    if (name == "ramp") return ramp(options);
    if (name == "points") return points(options);
    const std::string near = nearest_name(name, pattern_names());
    return input_error("no pattern \"{}\"{}: there are {}", name,
                       near.empty() ? "" : ", did you mean \"" + near + "\"?", join_names(pattern_names()));
}

MeasuredSpan measured_span(int width_px, int height_px) {
    // Even, so that the centre line is exact; a tenth of the image remains around it.
    const auto most = [](int length) { return length * 9 / 10 / 2 * 2; };
    return {most(width_px), most(height_px)};
}

Result<PixelSize> pixel_size(int width_px, int height_px, double x_mm, double y_mm) {
    if (!(x_mm > 0 && y_mm > 0 && x_mm < 1e5 && y_mm < 1e5))
        return input_error("measured {:g} x {:g} mm: must be above 0 and at most 100 m", x_mm, y_mm);
    const MeasuredSpan span = measured_span(width_px, height_px);
    if (span.x_px == 0 || span.y_px == 0) return input_error("an image of {} x {} px", width_px, height_px);
    PixelSize size;
    size.x_um = x_mm * 1000 / span.x_px;
    size.y_um = y_mm * 1000 / span.y_px;
    size.pixel_um = (size.x_um + size.y_um) / 2;
    size.off_percent = 100 * (size.x_um / size.y_um - 1);
    constexpr double most_off_percent = 10;  // no projector is so far from square
    if (std::fabs(size.off_percent) > most_off_percent)
        return input_error(
            "measured {:g} x {:g} mm: the pixels would be {:.1f} um wide and {:.1f} um high; X is along the {} px, Y "
            "along the {} px",
            x_mm, y_mm, size.x_um, size.y_um, width_px, height_px);
    return size;
}

namespace {

/// Commas within numbers where blanks or semicolons stand between them.
bool has_decimal_commas(std::string_view line) {
    const std::size_t end = line.find_last_not_of(" \t\r");
    const bool has_others =
        line.substr(0, end + 1).find_first_of(" \t;", line.find_first_not_of(" \t")) != std::string_view::npos;
    for (std::size_t at = line.find(','); has_others && at != std::string_view::npos; at = line.find(',', at + 1))
        if (at > 0 && at + 1 < line.size() && is_digit(line[at - 1]) && is_digit(line[at + 1])) return true;
    return false;
}

}  // namespace

Result<LightTable> parse_light_table(std::string_view text, std::string_view file) {
    LightTable table;
    for (int number = 1; !text.empty(); ++number) {
        std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        line = line.substr(0, line.find('#'));
        if (line.find_first_not_of(" \t,;\r") == std::string_view::npos) continue;
        if (has_decimal_commas(line))
            return input_error("{}: line {}: numbers have a decimal point, as in 4.1, not a comma", file, number);
        int columns = 0;
        while (line.find_first_not_of(" \t,;\r") != std::string_view::npos) {
            const auto value = read_number(line);
            if (!value || !(*value > 0 && *value < 1e12) || ++columns > 100)
                return input_error("{}: line {}: must be 2 to 100 readings above 0", file, number);
            table.readings.push_back(*value);
        }
        if (table.rows++ == 0) table.columns = columns;
        if (columns != table.columns || table.rows > 100)
            return input_error("{}: line {}: has {} readings, the first row {}; at most 100 rows", file, number,
                               columns, table.columns);
    }
    if (table.rows < 2 || table.columns < 2)
        return input_error("{}: {} rows of {} readings: must be 2 or more of each", file, table.rows, table.columns);
    return table;
}

double point_px(int index, int count, int length_px) {
    return (index + 0.5) * length_px / count;
}

LightMask light_mask(const LightTable& table, int width_px, int height_px, double gamma) {
    const auto [least, most] = std::minmax_element(table.readings.begin(), table.readings.end());
    LightMask result{{width_px, height_px, {}}, *least / *most};
    result.mask.pixels.reserve(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
    const auto at = [&](int row, int column) {
        return table.readings[static_cast<std::size_t>(row * table.columns + column)];
    };
    for (int y = 0; y < height_px; ++y) {
        const Between v = between(y + 0.5, table.rows, height_px);
        for (int x = 0; x < width_px; ++x) {
            const Between h = between(x + 0.5, table.columns, width_px);
            const double top = at(v.low, h.low) + h.share * (at(v.low, h.high) - at(v.low, h.low));
            const double bottom = at(v.high, h.low) + h.share * (at(v.high, h.high) - at(v.high, h.low));
            const double share = *least / (top + v.share * (bottom - top));
            result.mask.pixels.push_back(static_cast<std::uint8_t>(std::lround(255 * std::pow(share, 1 / gamma))));
        }
    }
    return result;
}

}  // namespace pliant::host
