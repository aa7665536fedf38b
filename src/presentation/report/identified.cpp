#include "presentation/report/identified.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace pliant::report {
namespace {

using sim::identify::Compared;
using sim::identify::Identification;

constexpr std::size_t most_over_time = 3;

/// In chronological order.
using Rows = std::vector<Compared>;

/// The values of one unit, by channel.
std::map<std::size_t, Rows> rows_of(const Identification& result, const std::string& unit) {
    std::map<std::size_t, Rows> rows;
    for (const Compared& value : result.values) {
        if (result.channels[value.measured.channel].unit == unit) rows[value.measured.channel].push_back(value);
    }
    for (auto& [channel, list] : rows)
        std::ranges::stable_sort(list, {}, [](const Compared& value) { return value.measured.time; });
    return rows;
}

std::string label(const std::string& what, const std::string& unit) {
    return unit.empty() ? what : fmt::format("{} ({})", what, unit);
}

Plot over_time(const Identification& result, const std::string& unit, const std::map<std::size_t, Rows>& rows) {
    Plot plot{"Measured and simulated", "time", label("change since the first row", unit), {}};
    for (const auto& [channel, list] : rows) {
        const std::string& name = result.channels[channel].column;
        const double zero = list.front().measured.value;
        Series measured{name + ", measured", {}, true}, before{name + ", before", {}, false},
            after{name + ", after", {}, false};
        for (const Compared& value : list) {
            measured.points.push_back({value.measured.time, value.measured.value - zero});
            before.points.push_back({value.measured.time, value.before - zero});
            after.points.push_back({value.measured.time, value.after - zero});
        }
        for (Series* series : {&measured, &before, &after}) plot.series.push_back(std::move(*series));
    }
    return plot;
}

Plot over_measured(const std::string& unit, const std::map<std::size_t, Rows>& rows) {
    Plot plot{"Simulated over measured",
              label("measured, change since the first row", unit),
              label("simulated, change since the first row", unit),
              {}};
    Series before{"before", {}, true}, after{"after", {}, true}, equal{"equal", {}, false};
    double low = 0, high = 0;
    for (const auto& [channel, list] : rows) {
        const double zero = list.front().measured.value;
        for (const Compared& value : list) {
            const double x = value.measured.value - zero;
            before.points.push_back({x, value.before - zero});
            after.points.push_back({x, value.after - zero});
            low = std::min(low, x);
            high = std::max(high, x);
        }
    }
    equal.points = {{low, low}, {high, high}};
    plot.series = {std::move(before), std::move(after), std::move(equal)};
    return plot;
}

}  // namespace

std::vector<NamedPlot> identified_plots(const Identification& result) {
    std::vector<NamedPlot> plots;
    std::vector<std::string> units;
    for (const Compared& value : result.values) {
        const std::string& unit = result.channels[value.measured.channel].unit;
        if (std::ranges::find(units, unit) == units.end()) units.push_back(unit);
    }
    for (const std::string& unit : units) {
        const auto rows = rows_of(result, unit);
        const bool few = rows.size() <= most_over_time &&
                         std::ranges::all_of(rows, [](const auto& entry) { return entry.second.size() > 1; });
        plots.push_back({fmt::format("measured_{}.png", unit.empty() ? "ratio" : unit),
                         few ? over_time(result, unit, rows) : over_measured(unit, rows)});
    }
    return plots;
}

}  // namespace pliant::report
