// steps.csv, markers.csv and iterations.csv: results for a spreadsheet or pandas. RFC 4180 quoting, decimal points
// whatever the locale, 10 significant digits.
#pragma once

#include <string>
#include <string_view>

#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// One row per step, the rest state first (index 0). Columns: index, time, converged, iterations, substeps, residual,
/// wall_ms, min_J, solver, then per cable NAME_length_ratio, NAME_length_mm, NAME_tension_N, per chamber
/// NAME_volume_ratio, NAME_volume_mm3, NAME_pressure_kPa, per support NAME_force_x_N, .._y_N, .._z_N, per obstacle the
/// same three: its force on the robot. If anything could touch, self_contact_N and smallest_distance_mm (empty while
/// nothing is near) follow.
[[nodiscard]] std::string steps_csv(const sim::Trajectory& result);

/// One row per step, the rest state first. Columns: index, time, then per marker NAME_x_mm, NAME_y_mm, NAME_z_mm.
[[nodiscard]] std::string markers_csv(const sim::Trajectory& result);

/// One row per iteration, in order; iteration 0 is the start of an attempt. Columns: step, time, solver, iteration,
/// residual, violation, energy_J, alpha, min_J.
[[nodiscard]] std::string iterations_csv(const sim::Trajectory& result);

/// The cells of one iteration: "1,0.05,newton,3,...", without a line break.
[[nodiscard]] std::string iteration_row(const sim::IterationRecord& record);

}  // namespace pliant::report
