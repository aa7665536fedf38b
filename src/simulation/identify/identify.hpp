// Parameter identification: the robot parameters with which the simulated program comes closest to measurements.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "simulation/identify/measurements.hpp"
#include "simulation/identify/source.hpp"
#include "simulation/identify/unknown.hpp"

namespace pliant::sim::identify {

struct Found {
    Unknown unknown;  ///< `value`: initial value of the search
    double value = 0;
    /// 95 % confidence interval; empty if the data do not determine one. At a bound it is what they allow from there.
    std::optional<double> low, high;
    bool at_bound = false;
    bool matters = true;  ///< false: none of the measurements depends on it
};

/// One measured value and its simulated counterparts, in the channel's unit.
struct Compared {
    MeasuredValue measured;
    double before = 0, after = 0;
};

/// Root mean squares of simulated minus measured values in one unit, before and after.
struct Errors {
    std::string unit;  ///< "" for ratios
    std::size_t values = 0;
    double before = 0, after = 0;
};

struct Identification {
    std::vector<Found> found;
    /// (unknowns, unknowns) correlation of the estimates; NaN for an unknown that is at a bound or does not matter.
    Eigen::MatrixXd correlation;
    std::vector<Errors> fitted, judged;  ///< one per unit; judged: empty if nothing was held out
    std::vector<Channel> channels;
    std::vector<Compared> values;  ///< in the order of the table
    std::vector<std::string> warnings;
    int trials = 0;          ///< number of programs that were solved
    bool converged = false;  ///< false: the search ended at the limit of trials
};

/// Least-squares fit to all values that are not held out, each weighted by its scatter. Without scatter, all values of
/// one unit have the same weight: their scatter is a hundredth of the largest motion, from rest, of a quantity in that
/// unit. Intervals are those of the linear theory at the solution, t sqrt(C_jj) with C = G S G^T, G = (J^T J)^-1 J^T, S
/// the diagonal matrix of the noise of each value, and Student's t, in the coordinate of each unknown (Seber and Wild,
/// Nonlinear Regression, 1989, section 2.1.2). The noise is estimated for each unit, for values with a given scatter
/// apart from the others, from the values that depend on an unknown; t has the freedom of Satterthwaite 1946. They
/// reflect noise in the data, not a model that does not fit. Errors: fewer values than unknowns; an unknown that is
/// named twice; a start from which the program cannot be solved; errors of the source and the measurements; cancelled.
[[nodiscard]] Result<Identification> identify(const Source& source, const std::vector<Unknown>& unknowns,
                                              const Measurements& measurements, Progress& progress);

/// "KEY=VALUE" of each estimate, as for `--set`.
[[nodiscard]] std::vector<std::string> assignments(const Identification& result);

/// Text for people: a table of the unknowns and one of the errors, without warnings.
[[nodiscard]] std::string identification_text(const Identification& result);
[[nodiscard]] std::string identification_json(const Identification& result);
/// One row per measured value: line, time, quantity, unit, use, measured, scatter, before, after.
[[nodiscard]] std::string comparison_csv(const Identification& result);

}  // namespace pliant::sim::identify
