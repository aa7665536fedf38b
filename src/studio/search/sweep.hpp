// A parameter sweep: one or two numbers of a robot over their ranges, with the results of its program for each, for
// response plots.
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "studio/requests/search_order.hpp"
#include "studio/simulate/simulation_session.hpp"

namespace pliant::studio {

struct SweepColumn {
    std::string key, label, unit;  ///< as named in the plots of the page: "flexor_tension_N", "flexor: tension", "N"
};

/// The end of one program.
struct SweepRun {
    std::vector<double> inputs;   ///< (axes)
    std::vector<double> results;  ///< (columns); empty if there is no equilibrium
    std::string why;              ///< reason if there is none
    std::string warning;          ///< reasons not to trust the results; without the notes on the robot itself
};

struct Sweep {
    std::vector<SweepColumn> columns;
    std::vector<SweepRun> runs;  ///< the last axis changes first
};

/// Error: both axes set one number of the robot of `source`, however they write it; only one of the two would count;
/// or one sets a target that keys of the program say, which would change nothing.
[[nodiscard]] Status check_axes(const RobotText& source, const SweepOrder& order);

/// Runs the robot of `source` with every combination of values, each from rest. The mesh is reused if no key changes
/// it. Errors: no combination has an equilibrium, with the reason for the first one; cancelled.
[[nodiscard]] Result<Sweep> run_sweep(const RobotText& source, const SweepOrder& order, Progress& progress);

/// True if a key affects the geometry, or the mesh size.
[[nodiscard]] bool changes_mesh(const std::string& key);

/// {"axes": [{"key", "unit", "values"}], "columns": [{"key", "label", "unit"}], "runs": [{"inputs", "results", "why",
/// "warning"}]}
[[nodiscard]] std::string sweep_json(const SweepOrder& order, const Sweep& sweep);

}  // namespace pliant::studio
