#include "presentation/report/measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/core/csv.hpp"
#include "base/core/segment.hpp"
#include "base/core/text.hpp"

namespace pliant::report {
namespace {

constexpr std::array<std::string_view, 3> suffixes = {"_x_mm", "_y_mm", "_z_mm"};

/// The columns with a marker's coordinates.
struct Columns {
    std::size_t marker = 0;
    std::array<std::optional<std::size_t>, 3> at;
};

std::size_t index_of(const std::vector<sim::MarkerState>& markers, std::string_view name) {
    return static_cast<std::size_t>(
        std::find_if(markers.begin(), markers.end(), [&](const auto& m) { return m.name == name; }) - markers.begin());
}

std::string known_names(const std::vector<sim::MarkerState>& markers) {
    std::vector<std::string> names;
    for (const auto& marker : markers) names.push_back("\"" + marker.name + "\"");
    return names.empty() ? "none" : join_names(names);
}

Result<std::vector<Columns>> read_header(const CsvTable& table, const std::vector<sim::MarkerState>& markers) {
    std::vector<Columns> found;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::string_view name = table.columns[c];
            if (!name.ends_with(suffixes[axis])) continue;
            name.remove_suffix(suffixes[axis].size());
            std::size_t marker = index_of(markers, name);
            if (marker == markers.size()) marker = index_of(markers, csv_name(name));
            if (marker == markers.size())
                return input_error_at(table.file, table.header_line, "\"{}\" is not a marker of the robot; it has {}",
                                      name, known_names(markers));
            auto of = std::find_if(found.begin(), found.end(), [&](const Columns& f) { return f.marker == marker; });
            if (of == found.end()) of = found.insert(found.end(), Columns{marker, {}});
            if (of->at[axis])
                return input_error_at(table.file, table.header_line, "there are two columns \"{}\"", table.columns[c]);
            of->at[axis] = c;
        }
    }
    if (found.empty())
        return input_error_at(table.file, table.header_line,
                              "no column is named as in \"tip_x_mm\"; markers of the robot: {}", known_names(markers));
    return found;
}

/// The point in a row; empty if one of its cells is.
Result<std::optional<Vec3>> read_point(const CsvTable& table, const CsvRow& row, const Columns& columns,
                                       const sim::MarkerState& marker) {
    Vec3 point = marker.position_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!columns.at[axis]) continue;
        const auto cell = table.cell(row, *columns.at[axis]);
        if (!cell) return tl::unexpected(cell.error());
        if (cell->empty()) return std::nullopt;
        const auto value_mm = table.number(row, *columns.at[axis], table.columns[*columns.at[axis]]);
        if (!value_mm) return tl::unexpected(value_mm.error());
        point[axis] = 1e-3 * *value_mm;
    }
    return point;
}

double distance_to_way(const Vec3& p, const std::vector<Vec3>& way) {
    double least = norm(p - way.front());
    for (std::size_t i = 1; i < way.size(); ++i) least = std::min(least, distance_to_segment(p, way[i - 1], way[i]));
    return least;
}

std::vector<Vec3> way_of(const sim::Trajectory& result, std::size_t marker) {
    std::vector<Vec3> way;
    for (const sim::Step& step : result.steps) way.push_back(step.markers[marker].position_m);
    return way;
}

}  // namespace

Result<std::vector<MeasuredPath>> parse_measured(std::string_view text, const std::string& file,
                                                 const sim::Step& rest) {
    const auto table = parse_csv(text, file, "tip_x_mm,tip_y_mm,tip_z_mm");
    if (!table) return tl::unexpected(table.error());
    const auto columns = read_header(*table, rest.markers);
    if (!columns) return tl::unexpected(columns.error());
    std::vector<MeasuredPath> paths;
    for (const Columns& of : *columns) {
        const sim::MarkerState& marker = rest.markers[of.marker];
        MeasuredPath path{marker.name, {}};
        for (const CsvRow& row : table->rows) {
            const auto point = read_point(*table, row, of, marker);
            if (!point) return tl::unexpected(point.error());
            if (*point) path.points.push_back(**point);
        }
        if (path.points.empty()) return input_error_at(file, 0, "{} has no point in any row", marker.name);
        paths.push_back(std::move(path));
    }
    return paths;
}

std::vector<Deviation> deviations(const std::vector<MeasuredPath>& paths, const sim::Trajectory& result) {
    std::vector<Deviation> list;
    for (const MeasuredPath& path : paths) {
        const std::vector<Vec3> way = way_of(result, index_of(result.steps.front().markers, path.marker));
        Deviation d{path.marker, path.points.size()};
        for (std::size_t i = 1; i < way.size(); ++i) d.way_m += norm(way[i] - way[i - 1]);
        for (const Vec3& p : path.points) {
            const double distance = distance_to_way(p, way);
            d.mean_m += distance / static_cast<double>(path.points.size());
            d.largest_m = std::max(d.largest_m, distance);
        }
        list.push_back(d);
    }
    return list;
}

std::string deviation_line(const Deviation& d) {
    std::string text =
        fmt::format("marker {}: {} measured point{}, {:.3g} mm from the simulated way on average, {:.3g} mm at most",
                    d.marker, d.points, d.points == 1 ? "" : "s", 1e3 * d.mean_m, 1e3 * d.largest_m);
    if (d.way_m > 0) text += fmt::format(" ({:.2g} % of the way)", 100 * d.largest_m / d.way_m);
    return text;
}

Plot measured_plot(const std::vector<MeasuredPath>& paths, const sim::Trajectory& result, const std::string& as) {
    std::array<double, 3> least{}, most{};
    least.fill(std::numeric_limits<double>::infinity());
    most.fill(-std::numeric_limits<double>::infinity());
    std::vector<std::vector<Vec3>> ways;
    for (const MeasuredPath& path : paths) {
        ways.push_back(way_of(result, index_of(result.steps.front().markers, path.marker)));
        const std::array<const std::vector<Vec3>*, 2> both = {&path.points, &ways.back()};
        for (const std::vector<Vec3>* points : both) {
            for (const Vec3& p : *points) {
                for (std::size_t k = 0; k < 3; ++k) {
                    least[k] = std::min(least[k], p[k]);
                    most[k] = std::max(most[k], p[k]);
                }
            }
        }
    }
    std::size_t along = 1;  // on a tie y: the usual view of a robot that bends in x and z
    for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
        if (most[k] - least[k] < most[along] - least[along]) along = k;
    }
    const std::size_t x = along == 0 ? 1 : 0, y = along == 2 ? 1 : 2;
    constexpr std::array<std::string_view, 3> axes = {"x (mm)", "y (mm)", "z (mm)"};
    Plot plot{"Markers: simulated and " + as, std::string(axes[x]), std::string(axes[y]), {}};
    for (std::size_t i = 0; i < paths.size(); ++i) {
        Series simulated{paths[i].marker + ", simulated", {}, false}, measured{paths[i].marker + ", " + as, {}, true};
        for (const Vec3& p : ways[i]) simulated.points.push_back({1e3 * p[x], 1e3 * p[y]});
        for (const Vec3& p : paths[i].points) measured.points.push_back({1e3 * p[x], 1e3 * p[y]});
        plot.series.push_back(std::move(simulated));
        plot.series.push_back(std::move(measured));
    }
    return plot;
}

}  // namespace pliant::report
