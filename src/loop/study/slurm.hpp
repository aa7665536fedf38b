// Runs a study on a Slurm cluster: some chunks of rows each are tasks of a job array, resubmitted while rows are
// missing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
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
/// Processors of the nodes in the output of `sinfo --format=%C`: lines of allocated/idle/other/total.
[[nodiscard]] std::size_t total_processors(std::string_view text);
/// How many chunks a task takes, where `at_a_time` tasks can run (0: unknown): starting a task takes Slurm up to a
/// second, and a chunk of small rows little more.
[[nodiscard]] std::size_t chunks_for_each_task(std::size_t chunks, std::size_t at_a_time);
/// The first chunk of every task that has one of these; both ascending.
[[nodiscard]] std::vector<std::size_t> tasks_of(std::span<const std::size_t> chunks, std::size_t chunks_of_task);
/// "0-3,7": the argument of `--array`. Ascending, without duplicates.
[[nodiscard]] std::string array_text(std::span<const std::size_t> tasks);
/// The command line of sbatch for these tasks, each named by its first chunk.
[[nodiscard]] std::vector<std::string> sbatch_words(const Plan& plan, const std::filesystem::path& folder,
                                                    std::span<const std::size_t> tasks, int most_tasks);
/// The shell script of a task: it runs its own chunks and then, without a time limit, those that no other task has.
[[nodiscard]] std::string task_script(const Plan& plan, const std::filesystem::path& program,
                                      const std::filesystem::path& folder, std::size_t chunks_of_task);
/// True if the error is temporary, so that a later attempt may succeed.
[[nodiscard]] bool passes_later(std::string_view errors);

}  // namespace pliant::study
