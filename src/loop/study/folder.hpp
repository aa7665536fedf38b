// The folder of a study: the plan as it was made, records of rows, results.
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

/// What a folder may hold when a study begins.
enum class Begin {
    fresh,   ///< no records
    resume,  ///< records of this study
};

/// Makes the folder with the plan in it, or opens it, and gives the plan that is in it: rows go on as they were
/// planned. A fresh study takes the place of another one that has no records yet. Any number of processes may call it
/// at one time. Errors: the folder holds another study, or this one before a file changed; it holds records and `begin`
/// is fresh; something else stands there.
[[nodiscard]] Result<Plan> open_folder(const Plan& plan, const std::filesystem::path& folder, Begin begin);

/// The plan of a folder.
[[nodiscard]] Result<Plan> load_plan(const std::filesystem::path& folder);

/// Held by the process that leads the study, as long as it lives. Error: another does.
[[nodiscard]] Result<FileHandle> lead(const std::filesystem::path& folder);

/// What is known of all rows.
struct Collected {
    std::vector<std::optional<RowRecord>> rows;  ///< (rows)
    std::vector<TaskRecord> tasks;
    std::size_t done = 0, failed = 0;      ///< rows
    std::size_t damaged = 0, doubled = 0;  ///< records
    [[nodiscard]] std::size_t recorded() const { return done + failed; }
};

/// Reads the records of all chunks. Cost: all bytes of them.
[[nodiscard]] Result<Collected> collect(const Plan& plan, const std::filesystem::path& folder);

/// Follows the records while others write them: only files that have grown are read again.
class Follower {
public:
    Follower(const Plan& plan, std::filesystem::path folder);
    struct Count {
        std::size_t recorded = 0, done = 0, missing_path = 0;
        std::string missing_reason;  ///< of a row whose wanted result is not there
    };
    [[nodiscard]] Result<Count> look();
    /// Chunks with rows that have no record, as of the last look().
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
