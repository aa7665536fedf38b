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
    std::vector<std::pair<double, double>> points;  ///< index of the layer and value, by layer; not below 0
    bool dashed = false;
};

/// The axis of values runs from 0 to the largest, that of the layers from 1 to `layers`. `layers` of the whole print,
/// at least 1. Names are escaped, title and unit are not.
[[nodiscard]] std::string layer_plot(std::string_view title, std::string_view unit, const std::vector<LayerLine>& lines,
                                     int layers);

}  // namespace pliant::report
