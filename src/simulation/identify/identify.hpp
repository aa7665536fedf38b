// Finds numbers of a robot from what was measured on it: those with which its program, simulated, comes nearest.
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
    Unknown unknown;  ///< `value`: where the search began
    double value = 0;
    /// 95 % confidence interval; none where the data do not give one.
    std::optional<double> low, high;
    bool at_bound = false;
    bool matters = true;  ///< false: nothing that was measured depends on it
};

/// One measured value beside the simulated ones, in the channel's unit.
struct Compared {
    MeasuredValue measured;
    double before = 0, after = 0;
};

/// Root mean squares of simulated minus measured values of one unit, before and after.
struct Errors {
    std::string unit;  ///< "" of ratios
    std::size_t values = 0;
    double before = 0, after = 0;
};

struct Identification {
    std::vector<Found> found;
    /// (unknowns, unknowns) of the estimates; not a number beside an unknown that is at a bound or does not matter.
    Eigen::MatrixXd correlation;
    std::vector<Errors> fitted, judged;  ///< by unit; judged: empty where nothing was kept back
    std::vector<Channel> channels;
    std::vector<Compared> values;  ///< in the order of the table
    std::vector<std::string> warnings;
    int trials = 0;          ///< programs that were solved
    bool converged = false;  ///< false: the search ended after too many trials
};

/// Least squares over the values that are not judged, each over its scatter. Without a scatter all values of one unit
/// count alike, and different units by the spread of their values, so that neither drowns the other. Intervals are
/// those of the linear theory at the solution, t s sqrt(C_jj) with C = (J^T J)^-1, s^2 = |r|^2 / (n - unknowns) over
/// the n values that depend on one, and Student's t, in the coordinate of each unknown (Seber and Wild, Nonlinear
/// Regression, 1989, section 2.1.2): they tell of noise in the data, not of a model that does not fit. Errors: fewer
/// values than unknowns; an unknown that is named twice; a start from which the program cannot be solved; of what it
/// stands on; cancelled.
[[nodiscard]] Result<Identification> identify(const Source& source, const std::vector<Unknown>& unknowns,
                                              const Measurements& measurements, Progress& progress);

/// What "KEY=VALUE" of `--set` makes the robot that was found.
[[nodiscard]] std::vector<std::string> assignments(const Identification& result);

/// For people; a table of the unknowns and one of the errors, without warnings.
[[nodiscard]] std::string identification_text(const Identification& result);
[[nodiscard]] std::string identification_json(const Identification& result);
/// One row for each measured value: line, time, quantity, unit, use, measured, scatter, before, after.
[[nodiscard]] std::string comparison_csv(const Identification& result);

}  // namespace pliant::sim::identify
