// Runs the rows of a study here: all of them, or those of some chunks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "loop/study/plan.hpp"
#include "loop/study/pool.hpp"

namespace pliant::study {

struct RunSettings {
    WorkerProgram worker;
    int jobs = 1;                      ///< rows at a time
    std::vector<std::size_t> chunks;   ///< to be run, in this order; of those of others only what they leave
    bool wait_for_others = true;       ///< until all rows of the chunks are recorded, by whomsoever
    bool stop_at_missing_path = true;  ///< the first row of all has no such result: nobody wants the others
    int most_begun = 0;                ///< a row that ended so many tasks is a failure; 0: there is no such thing
    std::string place;                 ///< for the accounts: the machine and its task
};

/// What this process did.
struct RunAccount {
    std::size_t rows = 0;
    double rows_cpu_s = 0;     ///< processor time in rows
    double workers_cpu_s = 0;  ///< of the processes that ran them, with their start
    double wall_s = 0;
};

/// Runs what has no record yet. Records are written as rows end; where it is stopped, by whatever, it goes on from
/// there the next time. Errors: of the disk, a process that does not start, a wanted result that is not there,
/// cancellation.
[[nodiscard]] Result<RunAccount> run_rows(const Plan& plan, const std::filesystem::path& folder,
                                          const RunSettings& settings, Progress& progress);

/// Every chunk, beginning with the `share`-th of `shares` equal parts: processes that start together meet late.
[[nodiscard]] std::vector<std::size_t> all_chunks(const Plan& plan, std::size_t share = 0, std::size_t shares = 1);

}  // namespace pliant::study
