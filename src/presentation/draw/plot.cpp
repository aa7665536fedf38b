#include "presentation/draw/plot.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace pliant::report {
namespace {

constexpr Colour white = {1, 1, 1};
constexpr Colour grid_colour = {0.87, 0.88, 0.90};
constexpr Colour frame_colour = {0.35, 0.38, 0.42};
// Position of the axes; the canvas is 1500 by 1000.
constexpr double left = 140, right = 1460, top = 90, bottom = 880;

/// One axis: its values and their positions on the canvas.
struct Axis {
    std::vector<double> marks;
    double from, to;
    bool log;
    [[nodiscard]] double scale(double value) const { return log ? std::log10(value) : value; }
    [[nodiscard]] double at(double value) const {
        const double first = scale(marks.front());
        return from + (scale(value) - first) / (scale(marks.back()) - first) * (to - from);
    }
};

bool is_shown(const Plot& plot, const Point2& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && (p.x > 0 || !plot.log_x) && (p.y > 0 || !plot.log_y);
}

Axis axis_for(const Plot& plot, bool log, double Point2::*member, double from, double to) {
    double low = INFINITY;
    double high = -INFINITY;
    for (const Series& series : plot.series) {
        for (const Point2& p : series.points) {
            if (!is_shown(plot, p)) continue;
            low = std::min(low, p.*member);
            high = std::max(high, p.*member);
        }
    }
    return {log ? log_ticks(low, high) : ticks(low, high), from, to, log};
}

/// "0.01", "1e-5": short labels for powers of ten.
std::string label(const Axis& axis, double value) {
    if (axis.log && (value > 2e3 || value < 5e-4)) return fmt::format("1e{:.0f}", std::log10(value));
    return fmt::format("{:.6g}", value);
}

void draw_grid(Canvas& canvas, const Axis& x, const Axis& y) {
    for (const double value : x.marks) {
        canvas.line(std::array{Point2{x.at(value), top}, Point2{x.at(value), bottom}}, 1.5, grid_colour);
        canvas.text({x.at(value), bottom + 34}, label(x, value), {.size = 24, .align = Align::centre});
    }
    for (const double value : y.marks) {
        canvas.line(std::array{Point2{left, y.at(value)}, Point2{right, y.at(value)}}, 1.5, grid_colour);
        canvas.text({left - 14, y.at(value) + 8}, label(y, value), {.size = 24, .align = Align::right});
    }
    const std::array corner = {Point2{left, top}, Point2{left, bottom}, Point2{right, bottom}};
    canvas.line(corner, 2.5, frame_colour);
}

/// A series on the canvas.
std::vector<Point2> placed(const Plot& plot, const Series& series, const Axis& x, const Axis& y) {
    std::vector<Point2> points;
    for (const Point2& p : series.points) {
        if (is_shown(plot, p)) points.push_back({x.at(p.x), y.at(p.y)});
    }
    return points;
}

void draw_series(Canvas& canvas, const Series& series, const std::vector<Point2>& points, const Colour& colour) {
    if (series.dots) {
        for (const Point2& p : points) canvas.disc(p, 7, colour);
    } else if (points.size() > 1) {
        canvas.line(points, 4, colour);
    }
}

struct Rectangle {
    Point2 corner;  ///< upper left
    double width, height;
    [[nodiscard]] bool contains(const Point2& p) const {
        return p.x >= corner.x && p.x <= corner.x + width && p.y >= corner.y && p.y <= corner.y + height;
    }
};

/// How much of the curves lies in it: dots, and pieces of lines of the size of a dot.
std::size_t covered(const Rectangle& place, const Plot& plot, const std::vector<std::vector<Point2>>& curves) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const std::vector<Point2>& points = curves[i];
        for (std::size_t k = 0; k < points.size(); ++k) {
            count += place.contains(points[k]) ? 1 : 0;
            if (plot.series[i].dots || k == 0) continue;
            const Point2 from = points[k - 1], way{points[k].x - from.x, points[k].y - from.y};
            const int pieces = static_cast<int>(std::hypot(way.x, way.y) / 14);
            for (int n = 1; n < pieces; ++n) {
                const double share = static_cast<double>(n) / pieces;
                count += place.contains({from.x + share * way.x, from.y + share * way.y}) ? 1 : 0;
            }
        }
    }
    return count;
}

constexpr double legend_line = 38;

/// The corner of the axes in which the legend covers least. If several are as free: for curves that fall by powers of
/// ten the lower right, else the upper left.
Rectangle legend_place(const Canvas& canvas, const Plot& plot, const std::vector<std::vector<Point2>>& curves) {
    double width = 0;
    for (const Series& series : plot.series) width = std::max(width, canvas.text_width(series.name, {.size = 26}));
    width += 84 + 14;
    const double height = legend_line * static_cast<double>(plot.series.size()) + 8;
    const double west = left + 16, east = std::max(west, right - width), north = top + 8, south = bottom - height - 8;
    std::array<Point2, 4> corners{Point2{west, north}, Point2{east, north}, Point2{west, south}, Point2{east, south}};
    if (plot.log_y) std::ranges::reverse(corners);
    const auto hidden = [&](const Point2& corner) { return covered({corner, width, height}, plot, curves); };
    return {*std::ranges::min_element(corners, {}, hidden), width, height};
}

void draw_legend(Canvas& canvas, const Plot& plot, const Rectangle& place) {
    canvas.box(place.corner, place.width, place.height, white, 6, 0.8);
    double height = place.corner.y + 30;
    for (std::size_t i = 0; i < plot.series.size(); ++i) {
        const Colour colour = palette(static_cast<int>(i));
        const double side = place.corner.x, middle = height - 8;
        if (plot.series[i].dots)
            canvas.disc({side + 34, middle}, 7, colour);
        else
            canvas.line(std::array{Point2{side + 14, middle}, Point2{side + 54, middle}}, 4, colour);
        canvas.text({side + 68, height}, plot.series[i].name, {.size = 26});
        height += legend_line;
    }
}

}  // namespace

std::vector<double> log_ticks(double low, double high) {
    if (!std::isfinite(low) || !std::isfinite(high) || !(low > 0)) return {0.1, 1};
    const auto first = static_cast<int>(std::floor(std::log10(low) + 1e-9));
    const int last = std::max(first + 1, static_cast<int>(std::ceil(std::log10(high) - 1e-9)));
    const int stride = (last - first + 9) / 10;
    std::vector<double> marks;
    for (int k = first; k < last + stride; k += stride) marks.push_back(std::pow(10, k));
    return marks;
}

std::vector<double> ticks(double low, double high) {
    if (!std::isfinite(low) || !std::isfinite(high)) return {0, 1};
    if (!(high - low > 1e-12 * std::max(std::fabs(low), std::fabs(high)))) {
        const double room = low == 0 ? 1 : 0.5 * std::fabs(low);
        low -= room;
        high += room;
    }
    const double rough = (high - low) / 6;
    const double power = std::pow(10, std::floor(std::log10(rough)));
    const double digit = rough / power;
    const double step = power * (digit < 1.5 ? 1 : (digit < 3.5 ? 2 : (digit < 7.5 ? 5 : 10)));
    std::vector<double> marks;
    const auto first = std::floor(low / step + 1e-9);
    const auto last = std::ceil(high / step - 1e-9);
    for (double k = first; k <= last; ++k) marks.push_back(k * step);
    return marks;
}

Result<std::string> plot_png(const Plot& plot) {
    auto made = Canvas::create(1200, 800, white);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    const Axis x = axis_for(plot, plot.log_x, &Point2::x, left, right);
    const Axis y = axis_for(plot, plot.log_y, &Point2::y, bottom, top);
    draw_grid(canvas, x, y);
    std::vector<std::vector<Point2>> curves;
    for (const Series& series : plot.series) {
        curves.push_back(placed(plot, series, x, y));
        draw_series(canvas, series, curves.back(), palette(static_cast<int>(curves.size()) - 1));
    }
    draw_legend(canvas, plot, legend_place(canvas, plot, curves));
    canvas.text({left, 50}, plot.title, {.size = 32, .bold = true});
    canvas.text({(left + right) / 2, 965}, plot.x_label, {.size = 28, .align = Align::centre});
    canvas.text({left, 82}, plot.y_label, {.size = 24});
    return canvas.png();
}

}  // namespace pliant::report
