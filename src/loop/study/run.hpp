// Runs rows of a study on this machine: all of them, or those of some chunks.
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
    int jobs = 1;                      ///< number of parallel rows
    std::vector<std::size_t> chunks;   ///< to be run, in this order; for chunks of other processes only what these
                                       ///< leave
    bool wait_for_others = true;       ///< until all rows of the chunks are recorded, by any process
    bool stop_at_missing_path = true;  ///< stop if the first row lacks a wanted result: the others would, too
    bool stop_at_wrong_input = true;   ///< stop if the first rows all fail because of their input, whatever the values
    int most_begun = 0;                ///< a row during which this many tasks died counts as failed; 0: no limit
    std::string place;                 ///< host name and task, for the accounting
};

/// Accounting of this process.
struct RunAccount {
    std::size_t rows = 0;
    double rows_cpu_s = 0;     ///< processor time in rows
    double workers_cpu_s = 0;  ///< of the processes that ran them, including their start
    double wall_s = 0;
};

/// Runs all rows without a record. Records are written as rows end; an interrupted run can be continued. Errors: of the
/// disk, a process that does not start, a missing wanted result, first rows that all fail because of their input,
/// cancellation.
[[nodiscard]] Result<RunAccount> run_rows(const Plan& plan, const std::filesystem::path& folder,
                                          const RunSettings& settings, Progress& progress);

/// Every chunk, beginning at part `share` of `shares` equal parts, so that processes started together rarely meet.
[[nodiscard]] std::vector<std::size_t> all_chunks(const Plan& plan, std::size_t share = 0, std::size_t shares = 1);
/// `count` chunks from `first` on, and then, with `others`, all that come after and before them.
[[nodiscard]] std::vector<std::size_t> chunks_from(const Plan& plan, std::size_t first, std::size_t count, bool others);

}  // namespace pliant::study
