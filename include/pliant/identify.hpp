/// @file
/// Parameter identification: the robot parameters with which the simulated program comes closest to measurements.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// A table of measurements; its columns are described in docs/reference/commands.md, "identify".
struct Measurements {
    std::string csv;                    ///< the table
    std::string file = "measured.csv";  ///< name used in messages

    /// Reads the table from a file.
    /// @throws Failure if the file cannot be read.
    [[nodiscard]] static PLIANT_API Measurements load(const std::filesystem::path& file);
};

/// Which rows are held out of the fit for validation.
enum class JudgeOn {
    nothing,       ///< none, except rows marked in the column `use`
    every_second,  ///< the second row of the table, the fourth...
    second_half,   ///< the second half of the rows
};

/// Estimate of one unknown parameter.
struct Estimate {
    std::string key;               ///< as in the robot file
    std::string unit;              ///< SI; "" if dimensionless
    double start = 0;              ///< initial value of the search
    double value = 0;              ///< estimated value
    std::optional<double> low{};   ///< of the 95 % confidence interval, if the data determine one
    std::optional<double> high{};  ///< likewise
    bool at_bound = false;         ///< the estimate is limited by a bound
    bool matters = true;           ///< false: none of the measurements depends on it
};

/// One measured value and its simulated counterparts.
struct Comparison {
    int line = 0;          ///< in the table
    double time = 0;       ///< program time
    std::string quantity;  ///< column in the table
    std::string unit;      ///< of all three values: that of the column
    bool judged = false;   ///< held out of the fit
    double measured = 0;   ///< measured value
    double before = 0;     ///< simulated with the initial parameters
    double after = 0;      ///< simulated with the estimates
};

/// Root mean square of simulated minus measured values in one unit.
struct FitError {
    std::string unit;        ///< as in Comparison
    std::size_t values = 0;  ///< number of values
    double before = 0;       ///< with the initial parameters
    double after = 0;        ///< with the estimates
};

/// Result of an identification. A value; copies share immutable data.
class PLIANT_API Identification {
public:
    /// False if the search ended at the limit of trials.
    [[nodiscard]] bool converged() const;
    /// The estimates, in the order of the unknowns.
    [[nodiscard]] std::vector<Estimate> estimates() const;
    /// (estimates, estimates) correlation matrix; NaN in rows and columns of an estimate at a bound or one that does
    /// not matter.
    [[nodiscard]] std::vector<std::vector<double>> correlation() const;
    /// All measured values, in the order of the table.
    [[nodiscard]] std::vector<Comparison> comparisons() const;
    /// Errors of the fitted values, one for each unit.
    [[nodiscard]] std::vector<FitError> fitted() const;
    /// Errors of the values held out of the fit, one for each unit.
    [[nodiscard]] std::vector<FitError> judged() const;
    /// Reasons not to trust the result, one sentence each.
    [[nodiscard]] const std::vector<std::string>& warnings() const;
    /// Number of programs that were solved.
    [[nodiscard]] int trials() const;
    /// All estimates as KEY=VALUE, as Robot::load() takes them.
    [[nodiscard]] std::vector<std::string> changes() const;
    /// The robot with the estimated parameters.
    /// @throws Failure if a file that the robot file is based on can no longer be read, or has become invalid.
    [[nodiscard]] Robot robot() const;
    /// Text for people: tables of the estimates and errors.
    [[nodiscard]] std::string text() const;
    /// All figures, as in summary.json.
    [[nodiscard]] std::string json() const;
    /// Writes the folder that `pliant identify -o` writes, whole or not at all, replacing an older one:
    /// identified.toml, summary.json, comparison.csv and plots.
    /// @throws Failure as for robot(), or if a file cannot be written.
    void write(const std::filesystem::path& folder) const;

    /// @cond
    struct Data;
    explicit Identification(std::shared_ptr<const Data> data);

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// Least-squares fit to all values that are not held out. `unknowns` are keys of the robot file, or KEY=LOW..HIGH;
/// `mesh` is for a robot that says mesh.file = "memory:", as for Model.
/// @throws Failure if the robot or the table is invalid, an unknown does not exist, there are fewer values than
/// unknowns, or the program cannot be solved; or when cancelled.
[[nodiscard]] PLIANT_API Identification identify(const Robot& robot, const std::vector<std::string>& unknowns,
                                                 const Measurements& measured, JudgeOn judge = JudgeOn::nothing,
                                                 const std::optional<Mesh>& mesh = {}, const Watch& watch = {});

}  // namespace pliant
