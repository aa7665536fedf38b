// A line plot over the layers of a print, as an SVG drawing in a card of report.css: no script, sharp at any size.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pliant::report {

struct LayerLine {
    std::string name;
    std::string colour;                             ///< of CSS
    std::vector<std::pair<double, double>> points;  ///< layer and value, by layer; values not below 0
    bool dashed = false;
};

/// The axis runs from 0 to the largest value. `layers` of the whole print, at least 1. Names are escaped, title and
/// unit are not.
[[nodiscard]] std::string layer_plot(std::string_view title, std::string_view unit, const std::vector<LayerLine>& lines,
                                     int layers);

}  // namespace pliant::report
