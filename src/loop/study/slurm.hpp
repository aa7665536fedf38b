// Runs a study on a Slurm cluster: chunks of rows are tasks of a job array, resubmitted while rows are missing.
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
    std::filesystem::path program;  ///< pliant, by its path on the nodes
    int most_tasks = 0;             ///< running at a time; 0: no limit
    double look_every_s = 10;       ///< minimum interval between queries of Slurm; records are read every second
};

/// Summary of the run.
struct SlurmAccount {
    int submissions = 0;
    std::size_t tasks = 0;  ///< number submitted
};

/// Submits chunks with missing records, waits, and resubmits what tasks leave, until no row is missing. The job name is
/// derived from study and folder: after this program or slurmctld died, a new run finds the jobs by it and submits
/// nothing twice. While Slurm does not respond, it waits. Errors: Slurm refuses the job; tasks repeatedly end without
/// completing a row; a missing wanted result; cancellation, which also cancels the jobs.
[[nodiscard]] Result<SlurmAccount> run_on_slurm(const Plan& plan, const std::filesystem::path& folder,
                                                const SlurmSettings& settings, Progress& progress);

/// The job name for a study in a folder.
[[nodiscard]] std::string job_name(const Plan& plan, const std::filesystem::path& folder);
/// "0-3,7": the argument of `--array`. Ascending, without duplicates.
[[nodiscard]] std::string array_text(std::span<const std::size_t> chunks);
/// The command line of sbatch for these chunks.
[[nodiscard]] std::vector<std::string> sbatch_words(const Plan& plan, const std::filesystem::path& folder,
                                                    std::span<const std::size_t> chunks, int most_tasks);
/// The shell script of a task.
[[nodiscard]] std::string task_script(const std::filesystem::path& program, const std::filesystem::path& folder);
/// True if the error is temporary, so that a later attempt may succeed.
[[nodiscard]] bool passes_later(std::string_view errors);

}  // namespace pliant::study
