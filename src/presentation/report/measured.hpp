// Measured marker trajectories, or ones from elsewhere, compared with the simulated ones.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"
#include "presentation/draw/plot.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::report {

struct MeasuredPath {
    std::string marker;        ///< of the simulation
    std::vector<Vec3> points;  ///< m, in order; at least one
};

/// Reads the columns of markers.csv: NAME_x_mm, NAME_y_mm, NAME_z_mm of any markers of the simulation, in any order;
/// other columns (index, time) are ignored. A missing column is replaced by the coordinate of the marker at rest: a
/// video shows only two coordinates. An empty cell was not measured: the marker has no point in that row. Errors, with
/// file and line: no column for any marker of `rest`; a marker that the simulation does not have; invalid values.
[[nodiscard]] Result<std::vector<MeasuredPath>> parse_measured(std::string_view text, const std::string& file,
                                                               const sim::Step& rest);

/// Distance of measured points from the simulated path, the polyline through all steps.
struct Deviation {
    std::string marker;
    std::size_t points = 0;
    double mean_m = 0, largest_m = 0;
    double way_m = 0;  ///< length of the simulated path
};
[[nodiscard]] std::vector<Deviation> deviations(const std::vector<MeasuredPath>& paths, const sim::Trajectory& result);

/// "marker tip: 12 measured points, 0.8 mm from the simulated way on average, 1.9 mm at most (1.6 % of the way)".
[[nodiscard]] std::string deviation_line(const Deviation& deviation);

/// Simulated paths as lines and measured points as dots, in mm, seen along the axis of least marker motion. `as`: label
/// of the points.
[[nodiscard]] Plot measured_plot(const std::vector<MeasuredPath>& paths, const sim::Trajectory& result,
                                 const std::string& as = "measured");

}  // namespace pliant::report
