// A plot of y over x with lines and points, as a PNG.
#pragma once

#include <string>
#include <vector>

#include "core/error.hpp"
#include "report/canvas.hpp"

namespace pliant::report {

struct Series {
    std::string name;
    std::vector<Point2> points;  ///< in the units of the axes
    bool dots = false;           ///< separate points; else a line through them in order
};

struct Plot {
    std::string title;
    std::string x_label;
    std::string y_label;
    std::vector<Series> series;  ///< at least one, with a point; not finite ones are left out
};

/// 8-bit RGB, 1200 x 800 pixels.
[[nodiscard]] Result<std::string> plot_png(const Plot& plot);

/// Round numbers (1, 2, 5 times a power of ten apart) from below `low` to above `high`, 4 to 11 of them.
[[nodiscard]] std::vector<double> ticks(double low, double high);

}  // namespace pliant::report
