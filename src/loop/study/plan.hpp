// A plan of experiments as a value: the command, its values in each row, and the wanted results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::study {

inline constexpr std::size_t most_rows = 1'000'000;
inline constexpr std::size_t most_keys = 64;

/// How the rows of a plan were chosen.
enum class Design {
    grid,             ///< every combination of the keys' levels
    latin_hypercube,  ///< one row in each of n equal strata of every key
    sobol,            ///< Sobol's sequence
    sensitivity,      ///< Saltelli's: n (k + 2) rows, for Sobol indices
    table,            ///< rows of a CSV file
};
[[nodiscard]] std::string_view name(Design design);

/// A quantity that changes from row to row, and how it is passed to the command.
struct Key {
    std::string name;       ///< name of its column
    std::string set;        ///< key for `--set`, or
    std::string option;     ///< option of the command, such as --layer; if neither, the command contains {NAME}
    std::string unit;       ///< appended to each value; "" for pure numbers and words
    bool numeric = true;    ///< every value is a number (plus the unit)
    std::string gap = " ";  ///< between a value and the unit
};

/// A number to be read from the command's JSON.
struct Wanted {
    std::string name;  ///< name of its column
    std::string path;  ///< in the syntax of json_path.hpp
    int line = 0;      ///< in the study file; 0: unknown
};

/// Resources requested from Slurm; empty or 0: not requested, the cluster's default applies.
struct SlurmOptions {
    std::string partition, account, time, memory;
    int cpus_per_task = 1;
    std::vector<std::string> options{};  ///< more options of sbatch, one word each
};

/// Immutable once made. It contains the rows as they are run: their origin (a file, a seed) may change afterwards.
struct Plan {
    std::string study;                 ///< its name
    std::string study_file;            ///< for messages
    std::string version;               ///< of the program that made the plan
    std::string fingerprint;           ///< of version, study file, table and files named by the command: 16 hex digits
    std::filesystem::path folder;      ///< absolute; working directory of the rows
    std::vector<std::string> command;  ///< from the command's name on
    Design design = Design::grid;
    std::size_t samples = 0;  ///< n of a sensitivity study
    std::vector<Key> keys;
    std::vector<Wanted> results;
    std::vector<std::vector<std::string>> rows;  ///< (rows, keys), without units
    double row_limit_s = 0;                      ///< wall time of a row; 0: none
    std::size_t rows_per_chunk = 1;
    SlurmOptions slurm{};

    [[nodiscard]] std::size_t chunk_count() const { return (rows.size() + rows_per_chunk - 1) / rows_per_chunk; }
    [[nodiscard]] std::size_t chunk_of(std::size_t row) const { return row / rows_per_chunk; }
    /// Rows [begin, end) of a chunk.
    [[nodiscard]] std::size_t chunk_begin(std::size_t chunk) const { return chunk * rows_per_chunk; }
    [[nodiscard]] std::size_t chunk_end(std::size_t chunk) const;
};

/// The command line of a row, including `--json`. `row_folder` replaces {row}.
[[nodiscard]] std::vector<std::string> row_words(const Plan& plan, std::size_t row,
                                                 const std::filesystem::path& row_folder);
/// True if the command contains {row}.
[[nodiscard]] bool wants_row_folder(const Plan& plan);

/// A chunk size that keeps some hundred tasks busy: at most 200 rows, and at most 1,000 chunks, the size of a job array
/// that clusters accept.
[[nodiscard]] std::size_t usual_rows_per_chunk(std::size_t rows);

/// plan.json, written and parsed. Errors of parsing: not a plan, or an inconsistent one.
[[nodiscard]] std::string plan_json(const Plan& plan);
[[nodiscard]] Result<Plan> parse_plan(std::string_view text, const std::string& file);

}  // namespace pliant::study
