// A plot of y over x with lines and points, as a PNG.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "presentation/draw/canvas.hpp"

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
    std::vector<Series> series;  ///< at least one, with a point; values that are not finite are skipped
    bool log_x = false;          ///< logarithmic; values not above zero are skipped
    bool log_y = false;
};

/// 8-bit RGB, 1200 x 800 pixels.
[[nodiscard]] Result<std::string> plot_png(const Plot& plot);

/// Powers of ten from at most `low` to at least `high`, both above zero: 2 to 11 of them, evenly thinned out if there
/// are more.
[[nodiscard]] std::vector<double> log_ticks(double low, double high);

/// Round numbers (1, 2, 5 times a power of ten apart) from below `low` to above `high`, 4 to 11 of them.
[[nodiscard]] std::vector<double> ticks(double low, double high);

}  // namespace pliant::report
