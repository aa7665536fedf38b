#include "presentation/print_report/printers_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/base64.hpp"
#include "base/core/json.hpp"
#include "presentation/draw/plot.hpp"
#include "presentation/report/html.hpp"
#include "printing/machine/cleaning_data.hpp"
#include "printing/plan/figures.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/swap.hpp"
#include "printing/plan/timeline.hpp"

namespace pliant::report {
namespace {

using machine::Printer;
using machine::Store;
using Json = nlohmann::ordered_json;

constexpr std::string_view page_style = R"(
body { font: 16px/1.5 system-ui, sans-serif; color: #292e38; margin: 0; background: #fff; }
main { max-width: 1080px; margin: 0 auto; padding: 24px; }
h1 { font-size: 28px; } h2 { font-size: 20px; margin-top: 36px; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: 4px 8px; border-bottom: 1px solid #d9dde4; vertical-align: top; }
th:first-child, td:first-child { text-align: left; }
img, svg { max-width: 100%; height: auto; display: block; margin: 12px 0; }
.note { color: #59606d; } figure { margin: 0; } figcaption { font-weight: 600; margin-top: 16px; }
)";

std::string cell(double value, std::string_view format_zero = "-") {
    return value > 0 ? fmt::format("{:.1f}", value) : std::string(format_zero);
}

std::string row(const std::vector<std::string>& cells, std::string_view tag = "td") {
    std::string text = "<tr>";
    for (const std::string& c : cells) text += fmt::format("<{0}>{1}</{0}>", tag, html_escaped(c));
    return text + "</tr>\n";
}

std::vector<std::string> figure_cells(const plan::PrinterFigures& f) {
    return {f.name,
            fmt::format("{:.0f}", f.area_mm2 / plan::square_inch_mm2),
            fmt::format("{}", f.places),
            cell(f.swap.push_s),
            cell(f.swap.hooks_s),
            cell(f.swap.clean_s),
            cell(f.swap.pull_s),
            cell(f.swap.total_s),
            cell(f.mean_swap_s),
            cell(f.longest_swap_s),
            f.removed > 0 ? fmt::format("{:.0f} %", 100 * f.removed) : "-",
            f.packing > 0 ? fmt::format("{:.2f}", f.packing) : "-",
            f.store_mm > 0 ? fmt::format("{:.0f}", f.store_mm / 25.4) : "-"};
}

const std::vector<std::string> heads = {"printer",  "area, in²", "places",   "push, s",        "hooks, s",
                                        "clean, s", "pull, s",   "swap, s",  "mean of all, s", "longest, s",
                                        "removed",  "packing",   "store, in"};

std::string figures_table(const std::vector<Printer>& printers) {
    std::string text = "<table>\n" + row(heads, "th");
    for (const Printer& p : printers) text += row(figure_cells(plan::figures(p)));
    return text + "</table>\n";
}

/// A Gantt chart of one swap: a row for every device, a scale in seconds.
std::string gantt(const plan::SwapTimeline& swap) {
    constexpr double left = 120, width = 900, height = 26;
    const auto rows = static_cast<double>(swap.devices.size());
    const double scale = width / swap.seconds;
    std::string svg = fmt::format("<svg viewBox=\"0 0 1040 {:.0f}\" role=\"img\">\n", rows * height + 30);
    const double step = swap.seconds > 120 ? 30 : 10;
    for (double t = 0; t <= swap.seconds; t += step) {
        svg += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1:.0f}\" stroke=\"#d9dde4\"/><text "
            "x=\"{0:.1f}\" y=\"{2:.0f}\" font-size=\"13\" text-anchor=\"middle\">{3:.0f}{4}</text>\n",
            left + t * scale, rows * height, rows * height + 18, t, t == 0 ? " s" : "");
    }
    for (std::size_t d = 0; d < swap.devices.size(); ++d) {
        const double y = static_cast<double>(d) * height;
        svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" font-size=\"14\" text-anchor=\"end\">{}</text>\n",
                           left - 10, y + 18, plan::device_name(swap.devices[d]));
        for (const plan::Stretch& s : swap.stretches) {
            if (s.device != swap.devices[d]) continue;
            svg += fmt::format(
                "<rect x=\"{:.1f}\" y=\"{:.0f}\" width=\"{:.1f}\" height=\"{:.0f}\" rx=\"3\" fill=\"{}\"/>\n",
                left + s.begin_s * scale, y + 4, std::max(1.0, (s.end_s - s.begin_s) * scale), height - 8,
                hex(palette(static_cast<int>(d))));
        }
    }
    return svg + "</svg>\n";
}

std::string swaps(const std::vector<Printer>& printers) {
    std::string text;
    for (const Printer& p : printers) {
        if (p.vats.size() < 2) continue;
        const plan::SwapTimeline swap = plan::swap_timeline(p, p.vats[0].slot, p.vats[1].slot);
        text += fmt::format("<figure><figcaption>{}: slot {} to slot {}, {:.1f} s</figcaption>{}</figure>\n",
                            html_escaped(p.name), swap.from_slot, swap.to_slot, swap.seconds, gantt(swap));
    }
    return text;
}

/// The first printer of each kind of store.
struct Kinds {
    const Printer* tower = nullptr;
    const Printer* wall = nullptr;
    const Printer* ring = nullptr;
    const Printer* line = nullptr;

    explicit Kinds(const std::vector<Printer>& printers) {
        for (const Printer& p : printers) {
            if (p.store() == Store::none) continue;
            const Printer*& kind = p.store() == Store::tower             ? tower
                                   : p.store() == Store::wall            ? wall
                                   : p.axis(machine::Axis::table).rotary ? ring
                                                                         : line;
            if (kind == nullptr) kind = &p;
        }
    }
};

Result<std::string> growth_plot(const std::vector<Printer>& printers) {
    const std::vector<int> vats = {2, 3, 4, 6, 8, 12, 16, 20, 24, 28, 32};
    const Kinds kinds(printers);
    Plot plot{"A change of vats, less its cleaning, over the vats in store", "vats", "seconds", {}};
    const auto add = [&](const Printer* p, const std::string& name, bool next) {
        if (p == nullptr) return;
        Series series{name, {}};
        for (const plan::SwapTimes& t : plan::swap_over_vats(*p, vats)) {
            series.points.push_back({static_cast<double>(t.vats), (next ? t.next_s : t.mean_s) - p->cleaning.spray_s});
        }
        plot.series.push_back(std::move(series));
    };
    add(kinds.tower, "tower, next slot", true);
    add(kinds.tower, "tower, mean", false);
    add(kinds.wall, "wall, mean", false);
    add(kinds.ring, "turntable, mean", false);
    add(kinds.line, "conveyor, mean", false);
    if (plot.series.empty()) return std::string();
    const Result<std::string> png = plot_png(plot);
    if (!png) return png;
    return fmt::format("<img alt=\"swap time over vats\" src=\"data:image/png;base64,{}\">\n", base64(*png));
}

/// Swap time of the first tower, over the length of its bed and the speed of its motors.
std::string bed_table(const std::vector<Printer>& printers) {
    const Kinds kinds(printers);
    const Printer* p = kinds.tower != nullptr ? kinds.tower : kinds.wall != nullptr ? kinds.wall : kinds.line;
    if (p == nullptr || p->vats.size() < 2) return "";
    constexpr std::array<double, 4> beds = {0.5, 1, 1.5, 2}, motors = {1, 2, 4, 8};
    const bool deep = p->has_carriage() && p->carriage.along_y;
    std::vector<std::string> head = {"bed along the way of the vats"};
    for (const double m : motors) head.push_back(m == 1 ? "motors as they are" : fmt::format("{:g} times as fast", m));
    std::string text = "<table>\n" + row(head, "th");
    for (const double bed : beds) {
        const double length_mm = (deep ? p->platform.depth_um : p->platform.width_um) / 1000.0 * bed;
        std::vector<std::string> cells = {fmt::format("{:.0f} mm", length_mm)};
        for (const double m : motors)
            cells.push_back(fmt::format("{:.1f} s", plan::figures(plan::with_bed(*p, bed, m)).swap.total_s));
        text += row(cells);
    }
    return "<h2>How a swap follows from bed and motors</h2>\n" + text + "</table>\n" +
           fmt::format(
               "<p class=\"note\">{}: the travel of its vats grows with "
               "the bed; accelerations and cleaning stay the same.</p>\n",
               html_escaped(p->name));
}

std::string test_name(const machine::CleaningTest& t) {
    return t.seconds > 0 ? fmt::format("{} {:.0f} s", t.method, t.seconds) : std::string(t.method);
}

std::string cleaning_table() {
    std::string text =
        "<table>\n" + row({"cleaning", "cone", "scaffold", "cylinder", "pyramids", "mean", "printed"}, "th");
    for (const machine::CleaningTest& t : machine::cleaning_tests()) {
        std::vector<std::string> cells = {test_name(t)};
        for (const double share : t.removed) cells.push_back(fmt::format("{:.0f} %", 100 * share));
        cells.push_back(fmt::format("{:.0f} %", 100 * t.mean()));
        cells.push_back(t.printed_pyramids > 0 ? fmt::format("pyramids {:.0f} %", 100 * t.printed_pyramids)
                                               : "the same");
        text += row(cells);
    }
    const machine::CleaningLaw spray = machine::cleaning_law(machine::CleaningMethod::spray);
    const machine::CleaningLaw sound = machine::cleaning_law(machine::CleaningMethod::ultrasound);
    return text + "</table>\n" +
           fmt::format(
               "<p>Laws through the means, by which the virtual printer carries resin from vat to vat: spray "
               "1 − exp(−t / {:.2f} s); ultrasound {:.3f} (1 − exp(−t / {:.1f} s)).</p>\n",
               spray.tau_s, sound.reach, sound.tau_s);
}

/// The row of table 4.2 that disagrees with the weights beside it, and whose shares it shows instead.
std::string pyramids() {
    std::string text = "<li><b>The pyramids of table 4.2.</b> The table disagrees with the weights beside it:";
    for (const machine::CleaningTest& t : machine::cleaning_tests()) {
        if (t.printed_pyramids <= 0) continue;
        text += fmt::format(" under {} it prints {:.0f} %, they give {:.0f} %", test_name(t), 100 * t.printed_pyramids,
                            100 * t.pyramids());
        for (const machine::CleaningTest& other : machine::cleaning_tests()) {
            if (other.pyramids() == t.printed_pyramids)
                text += fmt::format(" ({:.0f} % is theirs for {})", 100 * other.pyramids(), test_name(other));
        }
        text += ";";
    }
    text.back() = '.';
    return text + " Everything here goes by the weights.</li>\n";
}

std::string disagreements(const std::vector<Printer>& printers) {
    const Kinds kinds(printers);
    std::string text = "<ul>\n";
    if (kinds.tower != nullptr) {
        const Printer& tower = *kinds.tower;
        const plan::SwapSteps s = plan::figures(tower).swap;
        text += fmt::format(
            "<li><b>62 or 63 s.</b> Table 4.1 says 62 s for a swap, the text 63 s; its parts 24 + 3 + 15 + 24 "
            "make 66 s. They agree if the hooks' 3 s lie within the 15 s of spray: 24 + 15 + 24 = 63. Reckoned "
            "from motions: {:.1f} + {:.1f} + {:.1f} = {:.1f} s, the hooks' {:.1f} s among the spray.</li>\n",
            s.push_s, s.clean_s, s.pull_s, s.total_s, s.hooks_s);
        text += pyramids();
        const auto times = plan::swap_over_vats(tower, {8, 32});
        text += fmt::format(
            "<li><b>O(1).</b> To the next slot a swap takes {:.1f} s whatever the tower's "
            "height: its way is hidden behind the spray. To any slot it is O(n) too, "
            "with a small factor: {:.1f} s in the mean of 8 vats, {:.1f} s of 32.</li>\n",
            times[0].next_s, times[0].mean_s, times[1].mean_s);
        text += fmt::format(
            "<li><b>Packing.</b> About 0.6 is right for the four vats of the prototype ({:.2f}); eight "
            "in {:.0f} in fill {:.2f}, and the limit of vats and clearances of 4 in each is 0.50.</li>\n",
            plan::tower_packing(tower, 4), plan::tower_height_mm(tower, 8) / 25.4, plan::tower_packing(tower, 8));
    }
    return text + "</ul>\n";
}

}  // namespace

Result<std::string> printers_page(const std::vector<Printer>& printers) {
    const Result<std::string> plot = growth_plot(printers);
    if (!plot) return plot;
    std::string page =
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
        "http-equiv=\"Content-Security-Policy\" "
        "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n<title>Printers compared</title>\n";
    page += fmt::format("<style>{}</style>\n</head>\n<body>\n<main>\n<h1>Printers compared</h1>\n", page_style);
    page +=
        "<p>Everything here follows from the printers' files: ways, speeds and accelerations of the axes, durations of "
        "cleaning. Swap steps are those between the first two vats; packing is the share of a tower's height, a row's "
        "length or a turntable's disc that vats fill.</p>\n";
    page += figures_table(printers);
    page += "<h2>One swap, device by device</h2>\n" + swaps(printers);
    page += "<h2>Swap time over the size of the store</h2>\n" + *plot;
    page +=
        "<p class=\"note\">The same machines with a longer tower, a longer row, and a wider turntable whose rim is no "
        "faster than before.</p>\n";
    page += bed_table(printers);
    page += "<h2>Cleaning (table 4.2)</h2>\n" + cleaning_table();
    page += "<h2>Where the thesis disagrees with itself</h2>\n" + disagreements(printers);
    return page + "</main>\n</body>\n</html>\n";
}

std::string printers_json(const std::vector<Printer>& printers) {
    const auto rounded = [](double v) { return std::round(v * 1000) / 1000; };
    Json list = Json::array();
    for (const Printer& p : printers) {
        const plan::PrinterFigures f = plan::figures(p);
        list.push_back({{"name", f.name},
                        {"area_in2", rounded(f.area_mm2 / plan::square_inch_mm2)},
                        {"places", f.places},
                        {"push_s", rounded(f.swap.push_s)},
                        {"hooks_s", rounded(f.swap.hooks_s)},
                        {"clean_s", rounded(f.swap.clean_s)},
                        {"pull_s", rounded(f.swap.pull_s)},
                        {"swap_s", rounded(f.swap.total_s)},
                        {"mean_swap_s", rounded(f.mean_swap_s)},
                        {"longest_swap_s", rounded(f.longest_swap_s)},
                        {"removed", rounded(f.removed)},
                        {"packing", rounded(f.packing)},
                        {"store_mm", rounded(f.store_mm)}});
    }
    return json_text(list, 1) + "\n";
}

std::string printers_text(const std::vector<Printer>& printers) {
    std::string text =
        fmt::format("{:<22}{:>6}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>9}\n", "printer", "in^2", "places", "push",
                    "hooks", "clean", "pull", "swap s", "mean s", "removed", "packing");
    for (const Printer& p : printers) {
        const std::vector<std::string> c = figure_cells(plan::figures(p));
        text += fmt::format("{:<22}{:>6}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>9}{:>9}{:>9}\n", c[0], c[1], c[2], c[3], c[4],
                            c[5], c[6], c[7], c[8], c[10], c[11]);
    }
    return text;
}

}  // namespace pliant::report
