// Records of rows: one line each with a checksum, in one append-only file per chunk.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"
#include "loop/study/plan.hpp"

namespace pliant::study {

/// The outcome of a row.
struct RowRecord {
    std::size_t row = 0;
    bool done = false;           ///< false: it failed
    bool missing_path = false;   ///< it failed because a wanted result is missing from the command's output
    std::string reason;          ///< of the failure, one line
    std::vector<double> values;  ///< (results); NaN: missing
    double wall_s = 0, cpu_s = 0;
    bool wrong_input = false;  ///< it failed because of its files or options; not recorded
    std::string warning{};     ///< reasons not to trust its results, as the command gave them; one line
    bool operator==(const RowRecord&) const = default;
};

/// Accounting of a process that ran rows of a chunk, written when it ended.
struct TaskRecord {
    std::string place;             ///< host name, and task of the cluster, if any
    double wall_s = 0, cpu_s = 0;  ///< of the process and its child processes
    double rows_cpu_s = 0;         ///< part of cpu_s spent in rows
    bool operator==(const TaskRecord&) const = default;
};

/// The content of a records file.
struct ChunkRecords {
    std::vector<RowRecord> rows;  ///< the first record of each row, in order of completion
    std::vector<TaskRecord> tasks;
    std::vector<std::size_t> begun;  ///< rows, one entry for each start without an end
    std::size_t damaged = 0;         ///< lines with a wrong checksum: their rows are run again
    std::size_t doubled = 0;         ///< duplicate records of rows
    std::size_t whole_bytes = 0;     ///< end of the last complete line; an interrupted write may follow
};

/// The first line of a chunk's file.
[[nodiscard]] std::string records_header(const Plan& plan, std::size_t chunk);
/// `begin` to `end`: the rows of the chunk; `results`: the numbers per row. An empty text, or an incomplete first line,
/// counts as an empty file. Errors: a different first line.
[[nodiscard]] Result<ChunkRecords> parse_records(std::string_view text, const std::string& file,
                                                 std::string_view header, std::size_t begin, std::size_t end,
                                                 std::size_t results);

[[nodiscard]] std::string record_line(const RowRecord& record);
[[nodiscard]] std::string record_line(const TaskRecord& record);
[[nodiscard]] std::string begun_line(std::size_t row);
[[nodiscard]] std::string given_up_line(std::size_t row);

[[nodiscard]] std::filesystem::path records_file(const std::filesystem::path& folder, std::size_t chunk);

/// Reads a chunk's file without locking it; a missing file is empty.
[[nodiscard]] Result<ChunkRecords> read_records(const Plan& plan, const std::filesystem::path& folder,
                                                std::size_t chunk);

/// A chunk's file, locked by this process; the lock ends with the process, however it dies. Movable.
class RecordFile {
public:
    /// Nothing if another process holds the lock. An incomplete last line of a killed writer is cut off.
    [[nodiscard]] static Result<std::optional<RecordFile>> claim(const Plan& plan, const std::filesystem::path& folder,
                                                                 std::size_t chunk);
    [[nodiscard]] const ChunkRecords& records() const { return records_; }
    /// Passes a line to the system in one write; sync() brings it to the disk.
    [[nodiscard]] Status append(const std::string& line);
    [[nodiscard]] Status sync();

private:
    RecordFile(FileHandle file, std::string name, ChunkRecords records)
        : file_(std::move(file)), name_(std::move(name)), records_(std::move(records)) {}
    FileHandle file_;
    std::string name_;
    ChunkRecords records_;
};

}  // namespace pliant::study
