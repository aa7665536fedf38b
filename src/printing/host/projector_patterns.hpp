// Images that a projector is set up with, and what is measured on them turned into keys of the printer file.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

namespace pliant::host {

/// white, black, checkerboard, grid, border, ramp, points: what they are for is in docs/reference/projector.md.
[[nodiscard]] std::span<const std::string> pattern_names();

struct PatternOptions {
    int width_px = 0, height_px = 0;  ///< at least 16
    double pixel_um = 0;              ///< of the printer; 0: not known, scales are then in pixels
    int square_px = 1;                ///< of the checkerboard
    int columns = 5, rows = 3;        ///< of the points
};

/// Errors: an unknown name (with the nearest), sizes out of range.
[[nodiscard]] Result<job::Image> test_pattern(std::string_view name, const PatternOptions& options);

/// The rectangle that `border` draws to be measured: lines one pixel wide, this far apart from middle to middle.
struct MeasuredSpan {
    int x_px = 0, y_px = 0;
};
[[nodiscard]] MeasuredSpan measured_span(int width_px, int height_px);

struct PixelSize {
    double pixel_um = 0;        ///< mean of both directions
    double x_um = 0, y_um = 0;  ///< each by itself
    double off_percent = 0;     ///< of x from y: above some 0.1 % something is not square
};
/// From the distances of `measured_span`'s lines on the vat's floor. Errors: nothing above 0.
[[nodiscard]] Result<PixelSize> pixel_size(int width_px, int height_px, double x_mm, double y_mm);

/// Readings of a light meter at the places that `points` marks: a table, (rows, columns), in any unit.
struct LightTable {
    int columns = 0, rows = 0;
    std::vector<double> readings;  ///< row by row from the top
};
/// One row of the image in a line, from the top; numbers with blanks, commas, semicolons or tabs between them; `#`
/// begins a comment. 2 to 100 rows and columns, all above 0. Errors name file and line.
[[nodiscard]] Result<LightTable> parse_light_table(std::string_view text, std::string_view file);

struct LightMask {
    job::Image mask;   ///< share of its light that each pixel may get, in 1/255
    double least = 0;  ///< share of the brightest reading that the darkest has: what every pixel gets then
};
/// What makes the light the same everywhere: of the darkest place all, of others as much as there. Between the places
/// readings go straight (beyond the outer ones they go on as at the edge). `gamma`: of the projector, whose light is
/// the value's share to that power; 1: light follows the value.
[[nodiscard]] LightMask light_mask(const LightTable& table, int width_px, int height_px, double gamma);

/// Where the reading of a column (row) is taken: the middle of its share of `length_px`.
[[nodiscard]] double point_px(int index, int count, int length_px);

}  // namespace pliant::host
