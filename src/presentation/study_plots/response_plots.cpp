#include "presentation/study_plots/response_plots.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/letters.hpp"
#include "loop/study/values.hpp"
#include "presentation/draw/plot.hpp"

namespace pliant::report {
namespace {

/// With a number where another plot has that name: different characters become the same underscore.
std::string file_name(const std::string& result, const std::string& key, const std::vector<ResponsePlot>& others) {
    std::string plain = result + "_over_" + key;
    for (char& c : plain) {
        if (!is_letter(c) && !is_digit(c) && c != '.' && c != '_' && c != '-') c = '_';
    }
    if (plain.starts_with('.')) plain.insert(0, "_");
    std::string name = plain + ".png";
    const auto is_taken = [&](const ResponsePlot& plot) { return lower_case(plot.file) == lower_case(name); };
    for (int number = 2; std::any_of(others.begin(), others.end(), is_taken); ++number)
        name = plain + "_" + std::to_string(number) + ".png";
    return name;
}

double number_of(const std::string& value) {
    const auto measure = study::read_measure(value);
    return measure ? measure->number : std::nan("");
}

std::vector<Point2> points_of(const study::Plan& plan, const study::Collected& rows, std::size_t result,
                              std::size_t key) {
    std::vector<Point2> points;
    for (std::size_t row = 0; row < plan.rows.size(); ++row) {
        const auto& record = rows.rows[row];
        if (!record || !record->done || !std::isfinite(record->values[result])) continue;
        points.push_back({number_of(plan.rows[row][key]), record->values[result]});
    }
    return points;
}

Plot plot_of(const study::Plan& plan, std::size_t result, std::size_t key, std::vector<Point2> points) {
    const study::Key& k = plan.keys[key];
    const std::string& name = plan.results[result].name;
    Plot plot{plan.study, k.unit.empty() ? k.name : k.name + " (" + k.unit + ")", name, {}};
    if (plan.keys.size() == 1) {
        std::sort(points.begin(), points.end(), [](const Point2& a, const Point2& b) { return a.x < b.x; });
        plot.series.push_back({"in order", points, false});
    }
    plot.series.push_back({name, std::move(points), true});
    return plot;
}

}  // namespace

Result<std::vector<ResponsePlot>> response_plots(const study::Plan& plan, const study::Collected& rows) {
    std::vector<ResponsePlot> plots;
    for (std::size_t result = 0; result < plan.results.size(); ++result) {
        for (std::size_t key = 0; key < plan.keys.size() && plots.size() < most_response_plots; ++key) {
            if (!plan.keys[key].numeric) continue;
            auto points = points_of(plan, rows, result, key);
            if (points.empty()) continue;
            auto png = plot_png(plot_of(plan, result, key, std::move(points)));
            if (!png) return tl::unexpected(png.error());
            plots.push_back({file_name(plan.results[result].name, plan.keys[key].name, plots), std::move(*png)});
        }
    }
    return plots;
}

}  // namespace pliant::report
