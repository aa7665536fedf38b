#include "presentation/print_report/layer_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "presentation/report/html.hpp"

namespace pliant::report {
namespace {

constexpr double plot_left = 54, plot_right = 590, plot_top = 8, plot_bottom = 222;

/// Step of the axis marks: 1, 2 or 5 times a power of ten, with 3 to 6 marks up to `most`.
double step_of(double most) {
    const double decade = std::pow(10, std::floor(std::log10(most)));
    const double share = most / decade;
    return decade * (share > 5 ? 2 : share > 2.5 ? 1 : share > 1.2 ? 0.5 : 0.2);
}

struct Frame {
    double most = 1e-9;
    int layers = 1;

    [[nodiscard]] double x(double layer) const {
        return plot_left + (plot_right - plot_left) * layer / std::max(layers - 1, 1);
    }
    [[nodiscard]] double y(double value) const { return plot_bottom - (plot_bottom - plot_top) * value / most; }
};

std::string axes(const Frame& frame) {
    std::string svg;
    const double step = step_of(frame.most);
    for (double value = 0; value <= frame.most * 1.0001; value += step) {
        svg += fmt::format(
            "<line x1=\"{0:.0f}\" x2=\"{1:.0f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text x=\"{3:.0f}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">{5:g}</text>\n",
            plot_left, plot_right, frame.y(value), plot_left - 6, frame.y(value) + 4, value);
    }
    constexpr int marks = 4;
    for (int k = 0; k <= marks; ++k) {
        const double layer = std::round((frame.layers - 1.0) * k / marks);
        svg += fmt::format("<text x=\"{:.1f}\" y=\"240\" text-anchor=\"middle\">{:.0f}</text>\n", frame.x(layer),
                           layer + 1);
    }
    return svg;
}

std::string drawn(const LayerLine& line, const Frame& frame) {
    std::string svg = fmt::format("<polyline style=\"stroke:{}\"{} points=\"", line.colour,
                                  line.dashed ? " stroke-dasharray=\"5 4\"" : "");
    for (const auto& [layer, value] : line.points) svg += fmt::format("{:.1f},{:.1f} ", frame.x(layer), frame.y(value));
    return svg + "\"/>\n";
}

}  // namespace

std::string layer_plot(std::string_view title, std::string_view unit, const std::vector<LayerLine>& lines, int layers) {
    Frame frame;
    frame.layers = layers;
    for (const LayerLine& line : lines) {
        for (const auto& point : line.points) frame.most = std::max(frame.most, point.second);
    }
    std::string svg = axes(frame), legend;
    for (const LayerLine& line : lines) {
        svg += drawn(line, frame);
        legend += fmt::format("<span style=\"color:{}\">{}</span> {} &nbsp; ", line.colour, line.dashed ? "┄┄" : "━━",
                              html_escaped(line.name));
    }
    return fmt::format(
        "<div class=\"card\"><h3>{}, {}</h3><div class=\"plot\"><svg viewBox=\"0 0 600 250\" "
        "role=\"img\">\n{}</svg></div>"
        "<p class=\"plot-legend\">{}over the layers</p></div>\n",
        title, unit, svg, legend);
}

}  // namespace pliant::report
