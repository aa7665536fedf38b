// The journal of a print: an append-only text file beside the job. Every step is written and synced before it is taken,
// so after any interruption (kill -9, a power cut, a pulled cable) the file says what was done and what was about to
// be. One record per line:
//
//     5f3a9c21 17 light step=120 layer=3 material=0 planned=2.5 at=1234.567
//
// checksum (CRC-32 of the rest), number (from 1, without gaps), kind, values. docs/reference/journal.md lists the
// kinds.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"

namespace pliant::host {

struct JournalRecord {
    long number = 0;
    std::string kind;
    std::vector<std::pair<std::string, std::string>> values;

    [[nodiscard]] const std::string* find(std::string_view key) const;  ///< nullptr: missing
    /// Errors name record and key.
    [[nodiscard]] Result<std::string> text(std::string_view key) const;
    [[nodiscard]] Result<double> number_of(std::string_view key) const;
    [[nodiscard]] Result<long> whole(std::string_view key) const;
};

using JournalValues = std::vector<std::pair<std::string, std::string>>;

/// One line, with its line end. Keys are plain words; values may be anything.
[[nodiscard]] std::string write_record(long number, std::string_view kind, const JournalValues& values);

struct JournalText {
    std::vector<JournalRecord> records;
    std::size_t good_bytes = 0;  ///< length of the valid part; a truncated record may follow
};

/// Parses a journal. A damaged end is what a power cut leaves and is ignored; a damaged record followed by good ones is
/// an error, and so are a gap in the numbers, and a text that cannot be the beginning of a journal.
[[nodiscard]] Result<JournalText> parse_journal(std::string_view text, std::string_view where);

/// An open journal, locked against other hosts. Movable.
class Journal {
public:
    /// Opens or creates the file, locks it, reads its content and cuts off a damaged end. With `sync` every record is
    /// on the disk when append() returns. Errors: locked by another host, not readable, damaged, the disk.
    [[nodiscard]] static Result<Journal> open(const std::filesystem::path& path, bool sync);

    /// The records that the file held when it was opened.
    [[nodiscard]] const std::vector<JournalRecord>& records() const { return records_; }
    /// The number that the next record will have.
    [[nodiscard]] long next_number() const { return last_number_ + 1; }
    /// Deletes all records and starts anew.
    [[nodiscard]] Status clear();
    /// Returns the number of the new record. Errors: the disk is full or broken; then no step may be taken.
    [[nodiscard]] Result<long> append(std::string_view kind, const JournalValues& values);

private:
    Journal(FileHandle file, std::filesystem::path path, bool sync)
        : file_(std::move(file)), path_(std::move(path)), sync_(sync) {}
    [[nodiscard]] Status read_all();
    void reserve() const;

    FileHandle file_;
    std::filesystem::path path_;
    bool sync_ = true;
    long last_number_ = 0;
    std::size_t good_bytes_ = 0;
    std::vector<JournalRecord> records_;
};

}  // namespace pliant::host
