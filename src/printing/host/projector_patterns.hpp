// Test images for setting up a projector, and the conversion of measurements on them to keys of the printer file.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::host {

/// white, black, checkerboard, grid, border, ramp, points: docs/reference/projector.md explains their use.
[[nodiscard]] std::span<const std::string> pattern_names();

struct PatternOptions {
    int width_px = 0, height_px = 0;  ///< at least 16
    double pixel_um = 0;              ///< of the printer; 0: unknown, scales are then in pixels
    int square_px = 1;                ///< square of the checkerboard
    int columns = 5, rows = 3;        ///< of the points pattern
};

/// Errors: an unknown name (with the nearest), sizes out of range.
[[nodiscard]] Result<job::Image> test_pattern(std::string_view name, const PatternOptions& options);

/// The rectangle that `border` draws for measuring: lines one pixel wide, distances from centre to centre.
struct MeasuredSpan {
    int x_px = 0, y_px = 0;
};
[[nodiscard]] MeasuredSpan measured_span(int width_px, int height_px);

struct PixelSize {
    double pixel_um = 0;        ///< mean of both directions
    double x_um = 0, y_um = 0;  ///< per direction
    double off_percent = 0;     ///< difference of x from y: above about 0.1 % the optics are distorted or tilted
};
/// From the measured distances between `measured_span`'s lines on the vat's floor. Errors: a distance not above 0.
[[nodiscard]] Result<PixelSize> pixel_size(int width_px, int height_px, double x_mm, double y_mm);

/// Light meter readings at the marks of the `points` pattern: a table, (rows, columns), in any unit.
struct LightTable {
    int columns = 0, rows = 0;
    std::vector<double> readings;  ///< row by row from the top
};
/// One line per row of the table, from the top; numbers separated by blanks, commas, semicolons or tabs; `#` begins a
/// comment. 2 to 100 rows and columns, all above 0. Errors name file and line.
[[nodiscard]] Result<LightTable> parse_light_table(std::string_view text, std::string_view file);

struct LightMask {
    job::Image mask;   ///< fraction of its light that each pixel may get, in 1/255
    double least = 0;  ///< darkest reading over brightest: the light that every pixel then gets
};
/// The mask that makes the light uniform: the darkest place gets all its light, the others are dimmed to the same
/// level. Readings are interpolated linearly (and constant beyond the outer ones). `gamma`: of the projector, whose
/// light is the value's fraction to that power; 1: light is proportional to the value.
[[nodiscard]] LightMask light_mask(const LightTable& table, int width_px, int height_px, double gamma);

/// Position of a column's (row's) reading: the middle of its share of `length_px`.
[[nodiscard]] double point_px(int index, int count, int length_px);

}  // namespace pliant::host
