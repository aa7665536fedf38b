#include "loop/study/record.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "base/core/digest.hpp"
#include "base/core/file_lock.hpp"
#include "base/core/files.hpp"
#include "base/core/json.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;

std::string checksum(std::string_view text) {
    Digest digest;
    digest.add(text.data(), text.size());
    return digest.text();
}

/// "CHECKSUM TEXT\n".
std::string with_checksum(const std::string& text) {
    return checksum(text) + " " + text + "\n";
}

std::string line_of(const nlohmann::json& json) {
    return with_checksum(json_text(json));
}

/// The text after the checksum, if that is correct.
std::optional<std::string_view> checked(std::string_view line) {
    constexpr std::size_t digits = 16;
    if (line.size() <= digits || line[digits] != ' ') return std::nullopt;
    const std::string_view text = line.substr(digits + 1);
    if (checksum(text) != line.substr(0, digits)) return std::nullopt;
    return text;
}

double number_or_nan(const nlohmann::json& json) {
    return json.is_null() ? std::nan("") : json.get<double>();
}

RowRecord row_of(const nlohmann::json& json) {
    RowRecord row;
    row.row = json.at("row").get<std::size_t>();
    row.done = json.at("done").get<bool>();
    row.missing_path = json.value("missing_path", false);
    row.reason = json.at("reason").get<std::string>();
    for (const auto& value : json.at("values")) row.values.push_back(number_or_nan(value));
    row.wall_s = number_or_nan(json.at("wall_s"));
    row.cpu_s = number_or_nan(json.at("cpu_s"));
    row.warning = json.value("warning", "");
    return row;
}

TaskRecord task_of(const nlohmann::json& json) {
    return {json.at("task").get<std::string>(), number_or_nan(json.at("wall_s")), number_or_nan(json.at("cpu_s")),
            number_or_nan(json.at("rows_cpu_s"))};
}

/// Combines lines, in order, into records.
class Collector {
public:
    Collector(std::size_t begin, std::size_t end, std::size_t results) : begin_(begin), end_(end), results_(results) {}

    void take(std::string_view line) {
        const auto text = checked(line);
        if (!text || !understood(*text)) ++found_.damaged;
    }
    ChunkRecords finish() {
        for (const std::size_t row : begun_) {
            if (!met_.contains(row)) found_.begun.push_back(row);
        }
        return std::move(found_);
    }

private:
    bool understood(std::string_view text) try {
        const auto json = parse_json(text);
        if (json.contains("task")) {
            found_.tasks.push_back(task_of(json));
            return true;
        }
        if (json.contains("begun")) {
            begun_.push_back(json["begun"].get<std::size_t>());
            return true;
        }
        if (json.contains("given_up")) {
            const auto last = std::find(begun_.rbegin(), begun_.rend(), json["given_up"].get<std::size_t>());
            if (last != begun_.rend()) begun_.erase(std::next(last).base());
            return true;
        }
        RowRecord row = row_of(json);
        if (row.row < begin_ || row.row >= end_ || row.values.size() != results_) return false;
        if (met_.insert(row.row).second)
            found_.rows.push_back(std::move(row));
        else
            ++found_.doubled;
        return true;
    } catch (const nlohmann::json::exception&) {
        return false;
    }

    std::size_t begin_, end_, results_;
    std::set<std::size_t> met_;
    std::vector<std::size_t> begun_;
    ChunkRecords found_;
};

tl::unexpected<Error> system_failure(const std::string& file, std::string_view what) {
    return failure("{}: {}: {}", file, what, std::strerror(errno));
}

/// True: locked by us. False: by another process.
Result<bool> lock(const FileHandle& file, const std::string& name) {
    const LockOutcome outcome = try_lock(file);
    if (outcome == LockOutcome::ours) return true;
    if (outcome == LockOutcome::taken) return false;
    return failure("{}: cannot be locked: {}; a study needs a file system with locks (NFS 4, Lustre with -o flock)",
                   name, std::strerror(errno));
}

Status write_all(int file, std::string_view bytes, const std::string& name) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return system_failure(name, "cannot be written");
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return {};
}

Result<std::string> read_all(int file, const std::string& name) {
    std::string bytes;
    std::array<char, 65536> piece{};
    for (;;) {
        const ssize_t got = ::read(file, piece.data(), piece.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return system_failure(name, "cannot be read");
        if (got == 0) return bytes;
        bytes.append(piece.data(), static_cast<std::size_t>(got));
    }
}

}  // namespace

std::string records_header(const Plan& plan, std::size_t chunk) {
    return with_checksum(
        fmt::format("pliant study 1 {} chunk {} of {} rows", plan.fingerprint, chunk, plan.rows_per_chunk));
}

std::string record_line(const RowRecord& record) {
    nlohmann::json json = {{"row", record.row},       {"done", record.done},     {"reason", record.reason},
                           {"values", record.values}, {"wall_s", record.wall_s}, {"cpu_s", record.cpu_s}};
    if (record.missing_path) json["missing_path"] = true;
    if (!record.warning.empty()) json["warning"] = record.warning;
    return line_of(json);
}

std::string record_line(const TaskRecord& record) {
    return line_of({{"task", record.place},
                    {"wall_s", record.wall_s},
                    {"cpu_s", record.cpu_s},
                    {"rows_cpu_s", record.rows_cpu_s}});
}

std::string begun_line(std::size_t row) {
    return line_of({{"begun", row}});
}

std::string given_up_line(std::size_t row) {
    return line_of({{"given_up", row}});
}

fs::path records_file(const fs::path& folder, std::size_t chunk) {
    return folder / "records" / fmt::format("{:05}.rows", chunk);
}

Result<ChunkRecords> parse_records(std::string_view text, const std::string& file, std::string_view header,
                                   std::size_t begin, std::size_t end, std::size_t results) {
    Collector collector(begin, end, results);
    std::size_t whole = 0;
    const std::size_t first_end = text.find('\n');
    if (first_end != std::string_view::npos) {
        if (text.substr(0, first_end + 1) != header) return input_error("{}: holds records of another study", file);
        whole = first_end + 1;
        for (std::size_t next = text.find('\n', whole); next != std::string_view::npos; next = text.find('\n', whole)) {
            collector.take(text.substr(whole, next - whole));
            whole = next + 1;
        }
    }
    ChunkRecords records = collector.finish();
    records.whole_bytes = whole;
    return records;
}

Result<ChunkRecords> read_records(const Plan& plan, const fs::path& folder, std::size_t chunk) {
    const fs::path path = records_file(folder, chunk);
    std::error_code error;
    if (!fs::exists(path, error)) return ChunkRecords{};
    const Result<std::string> text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    return parse_records(*text, path.string(), records_header(plan, chunk), plan.chunk_begin(chunk),
                         plan.chunk_end(chunk), plan.results.size());
}

Result<std::optional<RecordFile>> RecordFile::claim(const Plan& plan, const fs::path& folder, std::size_t chunk) {
    const std::string name = records_file(folder, chunk).string();
    FileHandle file(::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_APPEND, 0666));
    if (!file.is_open()) return system_failure(name, "cannot be opened");
    const Result<bool> ours = lock(file, name);
    if (!ours) return tl::unexpected(ours.error());
    if (!*ours) return std::optional<RecordFile>{};
    const Result<std::string> text = read_all(file.number(), name);
    if (!text) return tl::unexpected(text.error());
    const std::string header = records_header(plan, chunk);
    auto records =
        parse_records(*text, name, header, plan.chunk_begin(chunk), plan.chunk_end(chunk), plan.results.size());
    if (!records) return tl::unexpected(records.error());
    if (records->whole_bytes < text->size() &&
        ::ftruncate(file.number(), static_cast<off_t>(records->whole_bytes)) != 0)
        return system_failure(name, "cannot be cut");
    const bool fresh = records->whole_bytes == 0;
    RecordFile claimed(std::move(file), name, std::move(*records));
    if (fresh) {
        if (Status status = claimed.append(header); !status) return tl::unexpected(status.error());
    }
    return std::optional<RecordFile>(std::move(claimed));
}

Status RecordFile::append(const std::string& line) {
    return write_all(file_.number(), line, name_);
}

Status RecordFile::sync() {
    if (::fdatasync(file_.number()) != 0) return system_failure(name_, "cannot be written to the disk");
    return {};
}

}  // namespace pliant::study
