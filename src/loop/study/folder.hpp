// The folder of a study: its plan, the records of rows, results.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"
#include "loop/study/plan.hpp"
#include "loop/study/record.hpp"

namespace pliant::study {

/// What a folder may contain when a study begins.
enum class Begin {
    fresh,   ///< no records
    resume,  ///< records of this study
};

/// Creates the folder with the plan in it, or opens it, and returns the plan in the folder: rows continue as they were
/// planned, in the folder of `plan`. A fresh study replaces another one that has no records yet. Safe to call from any
/// number of processes at once. Errors: the folder holds another study, or this one before a file changed; it holds
/// records and `begin` is fresh; it contains something else.
[[nodiscard]] Result<Plan> open_folder(const Plan& plan, const std::filesystem::path& folder, Begin begin);

/// Reads the plan of a folder.
[[nodiscard]] Result<Plan> load_plan(const std::filesystem::path& folder);

/// A lock held by the process that leads the study. Error: another process holds it.
[[nodiscard]] Result<FileHandle> lead(const std::filesystem::path& folder);

/// The state of all rows.
struct Collected {
    std::vector<std::optional<RowRecord>> rows;  ///< (rows)
    std::vector<TaskRecord> tasks;
    std::size_t done = 0, failed = 0;      ///< rows
    std::size_t warned = 0;                ///< rows that are done and have a warning
    std::size_t damaged = 0, doubled = 0;  ///< records
    [[nodiscard]] std::size_t recorded() const { return done + failed; }
};

/// Reads the records of all chunks. Cost: proportional to their size.
[[nodiscard]] Result<Collected> collect(const Plan& plan, const std::filesystem::path& folder);

/// Follows the records while other processes write them: reads only files that have grown.
class Follower {
public:
    Follower(const Plan& plan, std::filesystem::path folder);
    struct Count {
        std::size_t recorded = 0, done = 0, missing_path = 0;
        std::string missing_reason;  ///< of a row that lacks a wanted result
    };
    [[nodiscard]] Result<Count> look();
    /// Chunks with rows without a record, as of the last look().
    [[nodiscard]] std::vector<std::size_t> open_chunks() const;

private:
    struct Seen {
        std::uintmax_t bytes = 0;
        Count count;
    };
    const Plan& plan_;
    std::filesystem::path folder_;
    std::vector<Seen> chunks_;
};

}  // namespace pliant::study
