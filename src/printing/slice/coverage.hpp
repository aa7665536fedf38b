// Exact area coverage of pixels by outlines, as sparse cells.
#pragma once

#include <cstdint>
#include <vector>

#include "printing/slice/body.hpp"
#include "printing/slice/section.hpp"

namespace pliant::slice {

/// Coverage is an integer in steps of 2^-40 of a pixel. So sums do not depend on their order, a closed outline sums to
/// exactly zero at the end of a row, and ties are exact.
inline constexpr int coverage_bits = 40;
inline constexpr std::int64_t full_coverage = std::int64_t{1} << coverage_bits;

/// The contribution of one body's outline to one pixel. With `cover` the signed height of outline inside the pixel
/// (positive where the body is to its right) and `area` the signed area between the outline and the pixel's right side,
/// the coverage of a pixel is the sum of `cover` of all cells to its left in the row, plus the sum of its own `area`.
/// This is the accumulation rule of exact-area font rasterisers (R. Levien's font-rs, D. Turner's FreeType); cost: one
/// cell per pixel that an outline passes through, whatever the area inside.
struct Cell {
    std::uint64_t key;         ///< row, column and body, so that cells sort in sweep order
    std::int64_t cover, area;  ///< in steps of 1 / full_coverage

    [[nodiscard]] int row() const { return static_cast<int>(key >> 48); }
    [[nodiscard]] int column() const { return static_cast<int>((key >> 31) & 0x1FFFF); }
    [[nodiscard]] int body() const { return static_cast<int>(key & 0x7FFFFFFF); }
};

enum class Beyond { clamped, kept };
/// Transforms outlines from the platform to the image (x: columns, y: rows), with the solid to the right of those that
/// run to higher rows. Those of bodies must be inside the raster up to rounding, and are clamped to it.
[[nodiscard]] std::vector<Segment> in_image(const std::vector<Segment>& segments, const Raster& raster,
                                            Beyond beyond = Beyond::clamped);

/// Collects the cells of one layer.
class CellBuffer {
public:
    /// Adds outlines of a body as returned by in_image(). Precondition: bodies come in ascending order.
    void add(int body, const std::vector<Segment>& lines);

    /// All cells, ordered by row, then column, then body; several may have the same pixel and body. Columns range from
    /// 0 to width_px (the right border).
    [[nodiscard]] const std::vector<Cell>& sorted();

private:
    void add_line(double u0, double v0, double u1, double v1);
    void add_in_row(int row, double u0, double u1, std::int64_t height);
    void add_cell(int row, int column, std::int64_t cover, double middle);

    std::uint64_t body_ = 0;
    std::vector<Cell> cells_, by_column_, sorted_;
};

}  // namespace pliant::slice
