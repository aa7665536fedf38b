#include "presentation/report/mesh_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "base/core/counted.hpp"
#include "presentation/draw/canvas.hpp"

namespace pliant::report {
namespace {

constexpr Colour paper{1, 1, 1};
constexpr Colour dark_ink{0.16, 0.18, 0.22};
constexpr Colour faint{0.82, 0.84, 0.87};
constexpr Colour bar_colour{0.25, 0.47, 0.71};
constexpr Colour poor{0.80, 0.29, 0.24};

struct PlotFrame {
    double left, top, width, height;
};

struct Histogram {
    std::string title;
    std::string note;
    std::span<const std::size_t> counts;
    double end;             ///< of the last bin; the first begins at 0
    double tick;            ///< distance of the marks on the axis
    std::size_t poor_low;   ///< bins below are drawn in red
    std::size_t poor_high;  ///< and bins from here on
};

void draw_axis(Canvas& canvas, const PlotFrame& frame, const Histogram& h) {
    const double bottom = frame.top + frame.height;
    canvas.line(std::array{Point2{frame.left, bottom}, Point2{frame.left + frame.width, bottom}}, 2, dark_ink);
    for (double at = 0; at <= h.end * (1 + 1e-9); at += h.tick) {
        const double x = frame.left + frame.width * at / h.end;
        canvas.line(std::array{Point2{x, bottom}, Point2{x, bottom + 8}}, 2, dark_ink);
        canvas.text({x, bottom + 34}, fmt::format("{:.6g}", at), {22, dark_ink, Align::centre});
    }
}

void draw_histogram(Canvas& canvas, const PlotFrame& frame, const Histogram& h) {
    canvas.text({frame.left, frame.top - 62}, h.title, {28, dark_ink, Align::left, true});
    canvas.text({frame.left, frame.top - 26}, h.note, {22, dark_ink});
    const auto most =
        static_cast<double>(std::max<std::size_t>(1, *std::max_element(h.counts.begin(), h.counts.end())));
    for (const double share : {0.25, 0.5, 0.75, 1.0}) {
        const double y = frame.top + frame.height * (1 - share);
        canvas.line(std::array{Point2{frame.left, y}, Point2{frame.left + frame.width, y}}, 1, faint);
    }
    const double width = frame.width / static_cast<double>(h.counts.size());
    for (std::size_t i = 0; i < h.counts.size(); ++i) {
        if (h.counts[i] == 0) continue;
        const double height = std::max(2.0, frame.height * static_cast<double>(h.counts[i]) / most);
        const bool bad = i < h.poor_low || i >= h.poor_high;
        canvas.box({frame.left + (static_cast<double>(i) + 0.06) * width, frame.top + frame.height - height},
                   0.88 * width, height, bad ? poor : bar_colour);
    }
    draw_axis(canvas, frame, h);
}

std::string regions_text(const mesh::MeshReport& report) {
    constexpr std::size_t most = 6;
    std::string text;
    for (std::size_t r = 0; r < std::min(most, report.regions.size()); ++r)
        text += fmt::format("{}{}: {}", r == 0 ? "" : ",  ", report.regions[r].name,
                            counted(report.regions[r].tets, "tet"));
    if (report.regions.size() > most)
        text += fmt::format(" and {}", counted(report.regions.size() - most, "more region"));
    return text;
}

}  // namespace

Result<std::string> mesh_picture_png(std::string_view title, const mesh::MeshReport& report) {
    auto made = Canvas::create(1600, 900, paper);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    const double half = (canvas.width() - 4 * 70) / 2;
    canvas.text({70, 74}, title, {36, dark_ink, Align::left, true});
    const std::string jacobian =
        report.order == 2 ? fmt::format(", smallest J {:.3f}", report.worst_jacobian) : std::string();
    canvas.text({70, 118},
                fmt::format("{}, {}{}", counted(report.points, "node"),
                            counted(report.tets, report.order == 2 ? "quadratic tet" : "linear tet"), jacobian),
                {24, dark_ink});
    canvas.text({70, 156}, regions_text(report), {24, dark_ink});
    draw_histogram(canvas, {70, 310, half, 600},
                   {"shape quality of the tets",
                    fmt::format("worst {:.3f}, median {:.3f}; 1 is a regular tet, 0 a flat one", report.worst_quality,
                                report.median_quality),
                    report.quality_counts, 1, 0.2, 1, report.quality_counts.size()});
    draw_histogram(
        canvas, {70 + half + 140, 310, half, 600},
        {"dihedral angles, degrees",
         fmt::format("from {:.1f} to {:.1f}; 70.5 in a regular tet", report.min_dihedral_deg, report.max_dihedral_deg),
         report.dihedral_counts, 180, 30, 1, 34});
    return canvas.png();
}

}  // namespace pliant::report
