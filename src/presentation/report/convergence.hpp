// How solvers come to rest: one program run by several of them, side by side, and the iterations of one run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::report {

struct SolverRun {
    sim::Solver asked = sim::Solver::automatic;
    sim::Trajectory result;
};

/// One solver against the reference: Newton, or the first where that one did not take part.
struct SolverRow {
    std::string solver;
    bool converged = false;  ///< the whole program was run
    int steps = 0;           ///< that converged
    int iterations = 0;      ///< of all steps and attempts, also of those in vain
    double solve_s = 0;
    double residual = 0;       ///< these three at the last step that converged
    double energy_J = 0;       ///< as Step::energy_J
    double difference_mm = 0;  ///< largest distance of a marker (of a node, without markers) from the reference's at
                               ///< that step; not a number if the reference has none
    std::string message;       ///< why it stopped, if it did
};
[[nodiscard]] std::vector<SolverRow> compare(std::span<const SolverRun> runs);

/// A table for a terminal.
[[nodiscard]] std::string comparison_text(std::span<const SolverRow> rows);
/// One object per solver, with the names of SolverRow.
[[nodiscard]] std::string comparison_json(std::span<const SolverRow> rows);
/// The same as a table; header line first.
[[nodiscard]] std::string comparison_csv(std::span<const SolverRow> rows);

/// Every iteration of every run: as iterations.csv with a column `run` in front, the solver that was asked for.
[[nodiscard]] std::string convergence_csv(std::span<const SolverRun> runs);

/// Residual over iterations of the first step, where all begin at the same state. Both axes by powers of ten.
/// PNG as of plot_png.
[[nodiscard]] Result<std::string> convergence_png(std::span<const SolverRun> runs);

/// For report.html: {"solvers": [names], "rows": [[number, index of solver, residual], ...]}, at most about 4,000 rows;
/// where there are more, evenly chosen ones and the last of every attempt.
[[nodiscard]] std::string iterations_json(const sim::Trajectory& result);

}  // namespace pliant::report
