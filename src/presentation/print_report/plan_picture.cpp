#include "presentation/print_report/plan_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/core/counted.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/print_report/picture_colours.hpp"

namespace pliant::report {
namespace {

constexpr Colour faint{0.85, 0.87, 0.90};
constexpr double chart_left = 220;  // of all charts; row labels are to the left of it
constexpr double chart_right = 1540;
constexpr double row_height = 44;

const Font label{.size = 20, .colour = ink, .align = Align::right};
const Font tick{.size = 17, .colour = ink, .align = Align::centre};

/// Distance of axis marks (1, 2 or 5 times a power of ten) for at most ten marks, but no less than `least`.
double mark_step(double length, double least) {
    const double power = std::pow(10, std::floor(std::log10(std::max(length, least) / 10)));
    for (const double step : {power, 2 * power, 5 * power, 10 * power}) {
        if (step >= least && length / step <= 10) return step;
    }
    return std::max(least, 10 * power);
}

/// Marks below a chart from y `top` to `bottom` whose axis runs from 0 to `length`.
void draw_axis(Canvas& canvas, double top, double bottom, double length, double least, std::string_view unit) {
    const double step = mark_step(length, least);
    for (double at = 0; at <= length * (1 + 1e-9); at += step) {
        const double x = chart_left + at / length * (chart_right - chart_left);
        const std::array<Point2, 2> grid = {Point2{x, top}, Point2{x, bottom}};
        canvas.line(grid, 1, faint);
        canvas.text({x, bottom + 22}, at == 0 ? fmt::format("0 {}", unit) : fmt::format("{:g}", at), tick);
    }
}

void draw_heading(Canvas& canvas, const plan::Plan& plan) {
    canvas.text({60, 62}, fmt::format("{} on {}", plan.job, plan.printer), {.size = 34, .colour = ink, .bold = true});
    canvas.text({60, 98},
                fmt::format("{}, {} (minimum {}), {}", counted(plan.layers, "layer"), counted(plan.swaps, "swap"),
                            plan.swap_lower_bound, plan::clock_text(plan.seconds.total)),
                {.size = 22, .colour = ink});
}

void draw_title(Canvas& canvas, double y, std::string_view text) {
    canvas.text({60, y}, text, {.size = 24, .colour = ink, .bold = true});
}

/// One bar from the beginning to the end of the print, divided by activity, with labels below.
void draw_time(Canvas& canvas, const plan::Seconds& s) {
    draw_title(canvas, 158, "Time");
    const std::array<std::pair<const char*, double>, 4> parts = {
        {{"swap", s.swap}, {"clean", s.clean}, {"expose", s.expose}, {"move", s.move}}};
    double x = chart_left;
    double name_x = chart_left;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto& [name, seconds] = parts[i];
        const double width = s.total > 0 ? seconds / s.total * (chart_right - chart_left) : 0;
        canvas.box({x, 136}, width, 32, palette(static_cast<int>(i)));
        x += width;
        const std::string text = fmt::format("{} {}", name, plan::clock_text(seconds));
        canvas.box({name_x, 182}, 16, 16, palette(static_cast<int>(i)));
        canvas.text({name_x + 24, 197}, text, {.size = 19, .colour = ink});
        name_x += 24 + canvas.text_width(text, {.size = 19}) + 40;
    }
}

void draw_swap(Canvas& canvas, const plan::SwapTimeline& swap) {
    if (swap.stretches.empty()) {
        draw_title(canvas, 262, "No swap: one vat prints all");
        return;
    }
    draw_title(canvas, 262,
               fmt::format("One swap, from slot {} to slot {}: {:.1f} s", swap.from_slot, swap.to_slot, swap.seconds));
    constexpr double top = 282;
    constexpr double room = 264;  // above the next title
    const int rows = static_cast<int>(swap.devices.size());
    const double height = std::min(row_height, room / std::max(1, rows));
    draw_axis(canvas, top, top + rows * height, swap.seconds, 1, "s");
    for (int d = 0; d < rows; ++d) {
        canvas.text({chart_left - 16, top + d * height + height / 2 + 7},
                    plan::device_name(swap.devices[static_cast<std::size_t>(d)]), label);
    }
    for (const plan::Stretch& s : swap.stretches) {
        const auto found = std::find(swap.devices.begin(), swap.devices.end(), s.device);
        if (found == swap.devices.end()) continue;
        const int d = static_cast<int>(found - swap.devices.begin());
        const double scale = (chart_right - chart_left) / swap.seconds;
        canvas.box({chart_left + s.begin_s * scale, top + d * height + 7}, (s.end_s - s.begin_s) * scale, height - 14,
                   palette(d), 4);
    }
}

void draw_vat_layers(Canvas& canvas, const plan::Plan& plan) {
    constexpr double top = 642;
    draw_title(canvas, 622, "Layers that each vat prints");
    if (plan.layers == 0) return;
    const double rows = static_cast<double>(plan.vats.size());
    const double height = std::min(row_height, 300 / std::max(1.0, rows));
    draw_axis(canvas, top, top + rows * height, plan.layers, 1, "layers");
    const double scale = (chart_right - chart_left) / plan.layers;
    for (std::size_t v = 0; v < plan.vats.size(); ++v) {
        const plan::VatUse& use = plan.vats[v];
        const double y = top + static_cast<double>(v) * height;
        std::string name = fmt::format("{}  {}", use.slot, use.resin);
        if (canvas.text_width(name, label) > chart_left - 30) name = fmt::format("slot {}", use.slot);
        canvas.text({chart_left - 16, y + height / 2 + 7}, name, label);
        for (const LayerRun& run : layer_runs(plan, use.vat)) {
            canvas.box({chart_left + run.first * scale, y + 0.15 * height}, (run.last + 1 - run.first) * scale,
                       0.7 * height, palette(static_cast<int>(v)));
        }
    }
}

}  // namespace

std::vector<LayerRun> layer_runs(const plan::Plan& plan, int vat) {
    std::vector<LayerRun> runs;
    for (std::size_t i = 0; i < plan.order.size(); ++i) {
        const plan::VatList& vats = plan.order[i];
        if (std::find(vats.begin(), vats.end(), vat) == vats.end()) continue;
        const int layer = static_cast<int>(i);
        if (!runs.empty() && runs.back().last == layer - 1)
            runs.back().last = layer;
        else
            runs.push_back({layer, layer});
    }
    return runs;
}

Result<std::string> plan_picture(const plan::Plan& plan, const plan::SwapTimeline& swap) {
    auto made = Canvas::create(1600, 1000, paper);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    draw_heading(canvas, plan);
    draw_time(canvas, plan.seconds);
    draw_swap(canvas, swap);
    draw_vat_layers(canvas, plan);
    return canvas.png();
}

}  // namespace pliant::report
