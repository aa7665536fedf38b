// A study on a cluster with Slurm: chunks of rows as tasks of an array, and those again that are missing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "loop/study/plan.hpp"

namespace pliant::study {

struct SlurmSettings {
    std::filesystem::path program;  ///< pliant, as the nodes find it
    int most_tasks = 0;             ///< at a time; 0: as many as the cluster gives
    double look_every_s = 10;       ///< how often Slurm is asked, at most; records are looked at every second
};

/// What became of it.
struct SlurmAccount {
    int submissions = 0;
    std::size_t tasks = 0;  ///< that were submitted
};

/// Submits what has no record, waits, and submits again what tasks left, until no row is missing. Jobs go by a name
/// that belongs to study and folder: where this program, or slurmctld, died and begins anew, it finds them by it and
/// submits nothing twice. While Slurm does not answer, it waits. Errors: Slurm refuses the job; tasks end again and
/// again without a row; a wanted result is not there; cancellation, with which the jobs end too.
[[nodiscard]] Result<SlurmAccount> run_on_slurm(const Plan& plan, const std::filesystem::path& folder,
                                                const SlurmSettings& settings, Progress& progress);

/// The name of the jobs of a study in a folder.
[[nodiscard]] std::string job_name(const Plan& plan, const std::filesystem::path& folder);
/// "0-3,7": what `--array` takes. In rising order, without doubles.
[[nodiscard]] std::string array_text(std::span<const std::size_t> chunks);
/// The words of sbatch for these chunks.
[[nodiscard]] std::vector<std::string> sbatch_words(const Plan& plan, const std::filesystem::path& folder,
                                                    std::span<const std::size_t> chunks, int most_tasks);
/// What a task runs: a script of the shell.
[[nodiscard]] std::string task_script(const std::filesystem::path& program, const std::filesystem::path& folder);
/// Slurm did not answer, or not now: the same again later may pass.
[[nodiscard]] bool passes_later(std::string_view errors);

}  // namespace pliant::study
