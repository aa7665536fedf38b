/// @file
/// Numbers of a robot from measurements on it: those with which its program, simulated, comes nearest.
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

/// What was measured, as a table: docs/reference/commands.md, "identify", has its columns.
struct Measurements {
    std::string csv;                    ///< the table
    std::string file = "measured.csv";  ///< what messages call it

    /// Reads a file.
    /// @throws Failure of the disk.
    [[nodiscard]] static PLIANT_API Measurements load(const std::filesystem::path& file);
};

/// Which rows are kept out of the fit, to judge it on.
enum class JudgeOn {
    nothing,       ///< or what the column `use` says
    every_second,  ///< the second row of the table, the fourth...
    second_half,   ///< as it says
};

/// A number that was looked for.
struct Estimate {
    std::string key;               ///< as in the robot file
    std::string unit;              ///< SI; "" of a plain number
    double start = 0;              ///< where the search began
    double value = 0;              ///< found
    std::optional<double> low{};   ///< of the 95 % confidence interval, where the data give one
    std::optional<double> high{};  ///< likewise
    bool at_bound = false;         ///< a bound stops it
    bool matters = true;           ///< false: nothing that was measured depends on it
};

/// One measured value beside the simulated ones.
struct Comparison {
    int line = 0;          ///< of the table
    double time = 0;       ///< of the program
    std::string quantity;  ///< column of the table
    std::string unit;      ///< of the values: that of the column
    bool judged = false;   ///< kept out of the fit
    double measured = 0;   ///< value
    double before = 0;     ///< simulated with the numbers that the robot had
    double after = 0;      ///< simulated with those that were found
};

/// Root mean square of simulated minus measured values of one unit.
struct FitError {
    std::string unit;        ///< as in Comparison
    std::size_t values = 0;  ///< how many there are
    double before = 0;       ///< with the numbers that the robot had
    double after = 0;        ///< with those that were found
};

/// What was found. A value; copies share what never changes.
class PLIANT_API Identification {
public:
    /// False: the search ended after too many trials.
    [[nodiscard]] bool converged() const;
    /// In the order in which they were asked for.
    [[nodiscard]] std::vector<Estimate> estimates() const;
    /// (estimates, estimates) correlation; not a number beside one that is at a bound or does not matter.
    [[nodiscard]] std::vector<std::vector<double>> correlation() const;
    /// In the order of the table.
    [[nodiscard]] std::vector<Comparison> comparisons() const;
    /// By unit, of the values that were fitted.
    [[nodiscard]] std::vector<FitError> fitted() const;
    /// By unit, of those that were kept out of the fit.
    [[nodiscard]] std::vector<FitError> judged() const;
    /// Where the answer should not be trusted, a sentence each.
    [[nodiscard]] const std::vector<std::string>& warnings() const;
    /// Programs that were solved.
    [[nodiscard]] int trials() const;
    /// KEY=VALUE of everything that was found, as Robot::load() takes it.
    [[nodiscard]] std::vector<std::string> changes() const;
    /// The robot with what was found.
    [[nodiscard]] Robot robot() const;
    /// For people: tables of the numbers and of the errors.
    [[nodiscard]] std::string text() const;
    /// All figures, as in summary.json.
    [[nodiscard]] std::string json() const;
    /// Writes the folder that `pliant identify -o` writes, whole or not at all, in place of an older one:
    /// identified.toml, summary.json, comparison.csv and plots.
    /// @throws Failure of the disk.
    void write(const std::filesystem::path& folder) const;

    /// @cond
    struct Data;
    explicit Identification(std::shared_ptr<const Data> data);

private:
    std::shared_ptr<const Data> data_;
    /// @endcond
};

/// Least squares over the values that are not judged. `unknowns` are keys of the robot file, or KEY=LOW..HIGH; `mesh`
/// as for Model, of a robot that says mesh.file = "memory:".
/// @throws Failure of the robot, the table, an unknown that there is not; where there are fewer values than unknowns or
/// the program cannot be solved; cancelled.
[[nodiscard]] PLIANT_API Identification identify(const Robot& robot, const std::vector<std::string>& unknowns,
                                                 const Measurements& measured, JudgeOn judge = JudgeOn::nothing,
                                                 const std::optional<Mesh>& mesh = {}, const Watch& watch = {});

}  // namespace pliant
