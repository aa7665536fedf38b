// Records of rows: a line each, with a checksum, in one file a chunk that only grows.
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

/// What became of a row.
struct RowRecord {
    std::size_t row = 0;
    bool done = false;           ///< else it failed
    bool missing_path = false;   ///< it failed because a wanted result is not in what the command gave
    std::string reason;          ///< why it failed, one line
    std::vector<double> values;  ///< (results); NaN: there was none
    double wall_s = 0, cpu_s = 0;
    bool operator==(const RowRecord&) const = default;
};

/// A process that ran rows of a chunk, as it ended.
struct TaskRecord {
    std::string place;             ///< the machine, and the task of the cluster if it was one
    double wall_s = 0, cpu_s = 0;  ///< of the process and all that it started
    double rows_cpu_s = 0;         ///< of it in rows
    bool operator==(const TaskRecord&) const = default;
};

/// What a file of records holds.
struct ChunkRecords {
    std::vector<RowRecord> rows;  ///< the first of each row, in the order in which they ended
    std::vector<TaskRecord> tasks;
    std::vector<std::size_t> begun;  ///< rows, once for each time that one was begun and has no end
    std::size_t damaged = 0;         ///< lines with a wrong checksum: their rows are run again
    std::size_t doubled = 0;         ///< further records of a row
    std::size_t whole_bytes =
        0;  ///< up to the end of the last whole line; what follows was cut off while it was written
};

/// The first line of a chunk's file.
[[nodiscard]] std::string records_header(const Plan& plan, std::size_t chunk);
/// `begin` to `end`: the rows of the chunk; `results`: how many numbers a row has. An empty text, or less than a first
/// line, is an empty file. Errors: the first line is another.
[[nodiscard]] Result<ChunkRecords> parse_records(std::string_view text, const std::string& file,
                                                 std::string_view header, std::size_t begin, std::size_t end,
                                                 std::size_t results);

[[nodiscard]] std::string record_line(const RowRecord& record);
[[nodiscard]] std::string record_line(const TaskRecord& record);
[[nodiscard]] std::string begun_line(std::size_t row);
[[nodiscard]] std::string given_up_line(std::size_t row);

[[nodiscard]] std::filesystem::path records_file(const std::filesystem::path& folder, std::size_t chunk);

/// What a chunk's file holds, without a claim to it; an absent file is empty.
[[nodiscard]] Result<ChunkRecords> read_records(const Plan& plan, const std::filesystem::path& folder,
                                                std::size_t chunk);

/// A chunk's file, held by this process alone: a lock that ends with it, by whatever death. Movable.
class RecordFile {
public:
    /// Nothing where another process holds it. What a killed writer left of a line is cut off.
    [[nodiscard]] static Result<std::optional<RecordFile>> claim(const Plan& plan, const std::filesystem::path& folder,
                                                                 std::size_t chunk);
    [[nodiscard]] const ChunkRecords& records() const { return records_; }
    /// A line goes to the system in one write, and to the disk with sync().
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
