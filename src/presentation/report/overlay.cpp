#include "presentation/report/overlay.hpp"

#include <array>
#include <cmath>

namespace pliant::report {
namespace {

constexpr double margin = 44;
constexpr Colour ink = {0.13, 0.16, 0.21};
constexpr Colour faint_ink = {0.36, 0.40, 0.46};
constexpr Colour white = {1, 1, 1};
constexpr std::size_t named_markers = 8;

Point2 place_of(const Canvas& canvas, const Camera& camera, const Vec3& point) {
    const auto [u, v, depth] = camera.project(point);
    return {(u + 1) / 2 * canvas.width(), (1 - v) / 2 * canvas.height()};
}

/// The largest of 1, 2, 5 times a power of ten that is not above `value`.
double round_below(double value) {
    const double power = std::pow(10, std::floor(std::log10(value)));
    const double digit = value / power;
    return (digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power;
}

std::string metres_text(double metres) {
    return metres < 1e-3 ? fmt::format("{:g} µm", metres * 1e6)
           : metres < 1  ? fmt::format("{:g} mm", metres * 1e3)
                         : fmt::format("{:g} m", metres);
}

/// The font, reduced if the text would not fit into `room`.
Font fitting(const Canvas& canvas, const std::string& text, double room, Font font) {
    const double width = canvas.text_width(text, font);
    if (width > room) font.size *= room / width;
    return font;
}

}  // namespace

void draw_heading(Canvas& canvas, const std::string& title, const std::string& line) {
    const double room = canvas.width() - 2 * margin;
    canvas.text({margin, 64}, title, fitting(canvas, title, room, {32, ink, Align::left, true}));
    canvas.text({margin, 102}, line, fitting(canvas, line, room, {23, faint_ink}));
}

void draw_panel_caption(Canvas& canvas, const Point2& corner, double width, const std::string& title,
                        const std::string& line) {
    const double room = width - 1.5 * margin;
    canvas.text({corner.x + margin, corner.y + 32}, title, fitting(canvas, title, room, {23, ink, Align::left, true}));
    canvas.text({corner.x + margin, corner.y + 62}, line, fitting(canvas, line, room, {21, faint_ink}));
}

void draw_legend(Canvas& canvas, const std::vector<std::pair<Colour, std::string>>& entries) {
    const double swatch = 24, baseline = canvas.height() - margin;
    double x = margin;
    for (const auto& [colour, name] : entries) {
        if (x > 0.66 * canvas.width()) {  // the rest is for the scale bar
            canvas.text({x, baseline}, "…", {23, ink});
            return;
        }
        canvas.box({x, baseline - swatch + 3}, swatch, swatch, colour, 6);
        const Font font{23, ink};
        canvas.text({x + swatch + 10, baseline}, name, font);
        x += swatch + 10 + canvas.text_width(name, font) + 34;
    }
}

void draw_scale_bar(Canvas& canvas, const Camera& camera, const Vec3& centre) {
    const double depth = camera.project(centre)[2];
    const double metres_per_unit = 2 * camera.half_width * depth / canvas.width();
    const double length_m = round_below(0.16 * canvas.width() * metres_per_unit);
    const double right = canvas.width() - margin, left = right - length_m / metres_per_unit,
                 y = canvas.height() - margin - 4;
    canvas.line(std::array<Point2, 4>{{{left, y - 9}, {left, y}, {right, y}, {right, y - 9}}}, 2.5, ink);
    canvas.text({(left + right) / 2, y - 14}, metres_text(length_m), {23, ink, Align::centre});
}

void draw_colour_bar(Canvas& canvas, const std::string& title, double top, const std::string& unit, double highest) {
    const double width = 30, height = 0.50 * canvas.height(), x = canvas.width() - 190, y0 = 0.24 * canvas.height();
    const int bands = static_cast<int>(height);
    for (int i = 0; i < bands; ++i) {
        canvas.box({x, y0 + i}, width, 1.5, field_colour(1 - (i + 0.5) / bands));
    }
    canvas.text({x + width, y0 - 58}, title, {23, ink, Align::centre, true});
    canvas.text({x + width, y0 - 26}, unit, {23, faint_ink, Align::centre});
    constexpr int ticks = 5;
    for (int i = 0; i <= ticks; ++i) {
        const double y = y0 + height * (1 - static_cast<double>(i) / ticks);
        canvas.line(std::array<Point2, 2>{{{x + width, y}, {x + width + 8, y}}}, 2, ink);
        canvas.text({x + width + 16, y + 8}, fmt::format("{:.4g}", top * i / ticks), {23, ink});
    }
    if (highest > top)
        canvas.text({x + width, y0 + height + 48}, fmt::format("peak {:.4g}", highest), {21, faint_ink, Align::centre});
}

void draw_marker_paths(Canvas& canvas, const Camera& camera, const sim::Trajectory& result) {
    const std::size_t markers = result.steps.front().markers.size();
    for (std::size_t m = 0; m < markers; ++m) {
        std::vector<Point2> path;
        for (const sim::Step& step : result.steps) {
            path.push_back(place_of(canvas, camera, step.markers[m].position_m));
        }
        canvas.line(path, 6, white, 0.75);
        canvas.line(path, 2.5, ink, 0.9);
        const Point2 end = path.back();
        canvas.disc(path.front(), 6, white);
        canvas.disc(path.front(), 4, faint_ink);
        canvas.disc(end, 9, white);
        canvas.disc(end, 6.5, ink);
        if (markers > named_markers) continue;
        const std::string& name = result.steps.front().markers[m].name;
        const Font font{22, ink};
        const double width = canvas.text_width(name, font);
        const double x = end.x + 20 + width > canvas.width() - 8 ? end.x - 20 - width : end.x + 20;
        canvas.box({x - 8, end.y - 20}, width + 16, 34, white, 8, 0.78);
        canvas.text({x, end.y + 5}, name, font);
    }
}

void draw_measured(Canvas& canvas, const Camera& camera, const std::vector<MeasuredPath>& paths) {
    for (const MeasuredPath& path : paths) {
        std::vector<Point2> way;
        for (const Vec3& point : path.points) way.push_back(place_of(canvas, camera, point));
        canvas.line(way, 1.5, measured_colour, 0.6);
        for (const Point2& at : way) {
            canvas.disc(at, 8, measured_colour);
            canvas.disc(at, 5, white);
        }
    }
}

}  // namespace pliant::report
