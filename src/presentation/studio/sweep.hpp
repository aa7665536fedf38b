// One or two numbers of a robot over their ranges, and what its program comes to with each: the points of a response
// plot.
#pragma once

#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "presentation/studio/search_order.hpp"
#include "presentation/studio/simulation_session.hpp"

namespace pliant::studio {

struct SweepColumn {
    std::string key, label, unit;  ///< as the plots of the page name them: "flexor_tension_N", "flexor: tension", "N"
};

/// The end of one program.
struct SweepRun {
    std::vector<double> inputs;   ///< (axes)
    std::vector<double> results;  ///< (columns); empty where there is no equilibrium
    std::string why;              ///< there is none
};

struct Sweep {
    std::vector<SweepColumn> columns;
    std::vector<SweepRun> runs;  ///< the last axis changes first
};

/// The robot of `source` with every combination of values, each from rest. The mesh is kept where no key changes it.
/// Errors: no combination has an equilibrium, and then why the first has not; cancelled.
[[nodiscard]] Result<Sweep> run_sweep(const RobotText& source, const SweepOrder& order, Progress& progress);

/// Whether a key says something about the shapes, or about how finely they are meshed.
[[nodiscard]] bool changes_mesh(const std::string& key);

/// {"axes": [{"key", "unit", "values"}], "columns": [{"key", "label", "unit"}], "runs": [{"inputs", "results", "why"}]}
[[nodiscard]] std::string sweep_json(const SweepOrder& order, const Sweep& sweep);

}  // namespace pliant::studio
