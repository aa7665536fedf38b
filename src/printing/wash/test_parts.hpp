// Parts with the features that the thesis names for those of table 4.2 (figure 4.8), and with the same weights; the
// figure has no dimensions, so these are ours. They hang below the platform as printed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "printing/machine/printer.hpp"
#include "printing/wash/part_cells.hpp"

namespace pliant::wash::test {

/// The printer that washes them.
inline machine::Printer tower() {
    return machine::load_printer("examples/printers/tower.toml").value();
}

/// Cells of `cell_mm` over a square of `side_mm` around the middle; `solid` (x, y, depth below the platform) in mm.
inline PartCells cells_of(double side_mm, double height_mm, double cell_mm,
                          const std::function<bool(double, double, double)>& solid) {
    const int n = static_cast<int>(std::lround(side_mm / cell_mm));
    const int high = static_cast<int>(std::lround(height_mm / cell_mm));
    PartCells p{n, n, high, cell_mm, cell_mm, -side_mm / 2, -side_mm / 2, {}};
    for (int slab = 0; slab < high; ++slab) {
        for (int row = 0; row < n; ++row) {
            for (int column = 0; column < n; ++column)
                p.solid.push_back(
                    solid(p.x_mm + (column + 0.5) * cell_mm, p.y_mm + (row + 0.5) * cell_mm, (slab + 0.5) * cell_mm)
                        ? 1
                        : 0);
        }
    }
    return p;
}

/// Ten discs of decreasing diameter.
inline PartCells cone() {
    return cells_of(32, 20, 0.5,
                    [](double x, double y, double d) { return std::hypot(x, y) < 16 - 1.5 * std::floor(d / 2); });
}

/// The edges of a cube of 31 mm, beams of 7.5 mm.
inline PartCells scaffold() {
    const auto on = [](double a) { return a < 7.5 || a > 23.5; };
    return cells_of(31, 31, 0.5, [on](double x, double y, double d) {
        return (on(x + 15.5) ? 1 : 0) + (on(y + 15.5) ? 1 : 0) + (on(d) ? 1 : 0) >= 2;
    });
}

/// A flat one: 69 % of its wetted surface is one face, as much as a cloth wipes off.
inline PartCells cylinder() {
    return cells_of(54, 6, 0.5, [](double x, double y, double) { return std::hypot(x, y) < 26.5; });
}

/// A block with four pyramid-shaped pits whose tips point at the platform.
inline PartCells pyramids() {
    return cells_of(34, 16, 0.5, [](double x, double y, double d) {
        const double across = std::max(std::abs(std::abs(x) - 8.5), std::abs(std::abs(y) - 8.5));
        return d < 3 || across > 7 * (d - 3) / 13;
    });
}

struct Measured {
    const char* name;
    PartCells part;
    double weight_g;  ///< fully clean
    double film_g;    ///< on it before
    double removed;   ///< share of that by 15 s of spray
};
inline std::array<Measured, 4> parts_of_table_4_2() {
    return {{{"cone", cone(), 7.21, 0.89, 0.99},
             {"scaffold", scaffold(), 15.20, 1.20, 0.92},
             {"cylinder", cylinder(), 14.90, 0.70, 0.97},
             {"pyramids", pyramids(), 16.21, 0.79, 0.91}}};
}

}  // namespace pliant::wash::test
