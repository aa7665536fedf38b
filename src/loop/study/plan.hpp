// A plan of experiments as a value: which command is run with which values, and what is wanted of its result.
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
    latin_hypercube,  ///< one row in each of n equal layers of every key
    sobol,            ///< Sobol's sequence
    sensitivity,      ///< Saltelli's: n (k + 2) rows, from which Sobol indices follow
    table,            ///< rows of a CSV file
};
[[nodiscard]] std::string_view name(Design design);

/// What changes from row to row, and how the command is told.
struct Key {
    std::string name;     ///< heads its column
    std::string set;      ///< key that `--set` takes, or
    std::string option;   ///< option of the command, as in --layer; or neither: the command's words hold {NAME}
    std::string unit;     ///< follows each value; "" for pure numbers and words
    bool numeric = true;  ///< every value is a number (with the unit)
};

/// A number of the command's JSON.
struct Wanted {
    std::string name;  ///< heads its column
    std::string path;  ///< as json_path.hpp reads it
    int line = 0;      ///< of the study file; 0: not known
};

/// What Slurm is asked for; empty or 0: nothing is said, and the cluster's default holds.
struct SlurmOptions {
    std::string partition, account, time, memory;
    int cpus_per_task = 1;
    std::vector<std::string> options{};  ///< further ones of sbatch, a word each
};

/// Immutable once made. The rows stand in it as they are run: what made them (a file, a seed) may change afterwards.
struct Plan {
    std::string study;             ///< its name
    std::string study_file;        ///< for messages
    std::string version;           ///< of the program that made it
    std::string fingerprint;       ///< of version, study file, table and files that the command names: 16 hex digits
    std::filesystem::path folder;  ///< absolute; rows are run in it
    std::vector<std::string> command;  ///< its words, from the command's name on
    Design design = Design::grid;
    std::size_t samples = 0;  ///< of a sensitivity: n
    std::vector<Key> keys;
    std::vector<Wanted> results;
    std::vector<std::vector<std::string>> rows;  ///< (rows, keys), without units
    double row_limit_s = 0;                      ///< wall time of a row; 0: none
    std::size_t rows_per_chunk = 1;
    SlurmOptions slurm{};

    [[nodiscard]] std::size_t chunk_count() const { return (rows.size() + rows_per_chunk - 1) / rows_per_chunk; }
    [[nodiscard]] std::size_t chunk_of(std::size_t row) const { return row / rows_per_chunk; }
    /// [begin, end) of a chunk's rows.
    [[nodiscard]] std::size_t chunk_begin(std::size_t chunk) const { return chunk * rows_per_chunk; }
    [[nodiscard]] std::size_t chunk_end(std::size_t chunk) const;
};

/// The words of a row's command line, `--json` among them. `row_folder` is what {row} stands for.
[[nodiscard]] std::vector<std::string> row_words(const Plan& plan, std::size_t row,
                                                 const std::filesystem::path& row_folder);
/// True where a word of the command holds {row}.
[[nodiscard]] bool wants_row_folder(const Plan& plan);

/// As many chunks as keep some hundred tasks busy, of at most 200 rows, and at most 1,000 chunks: what a cluster takes
/// as one array.
[[nodiscard]] std::size_t usual_rows_per_chunk(std::size_t rows);

/// plan.json, and back. Errors of reading: not a plan, or one whose parts do not fit together.
[[nodiscard]] std::string plan_json(const Plan& plan);
[[nodiscard]] Result<Plan> parse_plan(std::string_view text, const std::string& file);

}  // namespace pliant::study
