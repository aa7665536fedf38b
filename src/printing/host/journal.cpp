#include "printing/host/journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "base/core/parse_all.hpp"

namespace pliant::host {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 28;
constexpr off_t reserve_bytes = 1 << 16;  // for the last records of a print when the disk is full

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = 0xffffffffU;
    for (const char byte : bytes) {
        crc ^= static_cast<unsigned char>(byte);
        for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
    }
    return ~crc;
}

bool is_plain(char c) {
    return c > ' ' && c < '\x7f' && c != '%' && c != '=';
}

std::string escaped(std::string_view value) {
    std::string text;
    for (const char c : value) {
        if (is_plain(c))
            text += c;
        else
            text += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    }
    return text;
}

std::optional<std::string> unescaped(std::string_view text) {
    std::string value;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            if (!is_plain(text[i])) return std::nullopt;
            value += text[i];
            continue;
        }
        unsigned code = 0;
        if (i + 2 >= text.size()) return std::nullopt;
        const auto [end, error] = std::from_chars(text.data() + i + 1, text.data() + i + 3, code, 16);
        if (error != std::errc() || end != text.data() + i + 3) return std::nullopt;
        value += static_cast<char>(code);
        i += 2;
    }
    return value;
}

std::string_view take_word(std::string_view& text) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    return word;
}

/// A line without its end; nullopt if it is invalid.
std::optional<JournalRecord> parse_record(std::string_view line) {
    std::uint32_t sum = 0;
    const std::string_view written = take_word(line);
    if (written.size() != 8 || !parse_all(written, sum, 16) || sum != crc32(line)) return std::nullopt;
    JournalRecord record;
    if (!parse_all(take_word(line), record.number)) return std::nullopt;
    record.kind = take_word(line);
    while (!line.empty()) {
        const std::string_view pair = take_word(line);
        const std::size_t equals = pair.find('=');
        if (equals == std::string_view::npos) return std::nullopt;
        auto value = unescaped(pair.substr(equals + 1));
        if (!value) return std::nullopt;
        record.values.emplace_back(std::string(pair.substr(0, equals)), std::move(*value));
    }
    return record;
}

/// True for what a host that died while it wrote its first record may have left: a part of a checksum and a number.
bool may_begin_record(std::string_view text) {
    constexpr std::size_t sum_digits = 8;
    if (text.find('\n') != std::string_view::npos) return false;
    const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
    const std::string_view sum = text.substr(0, sum_digits), rest = text.substr(sum.size());
    const std::string_view begin = " 1 ";  // of what follows the checksum
    return std::ranges::all_of(sum, is_hex) && rest.substr(0, begin.size()) == begin.substr(0, rest.size());
}

Status write_all(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::write(file, bytes.data(), bytes.size());
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return failure("{}", std::strerror(errno));
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return {};
}

/// A new file is safe on the disk only once its folder is synced.
void sync_folder(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    const FileHandle handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (handle.is_open()) ::fsync(handle.number());
}

}  // namespace

const std::string* JournalRecord::find(std::string_view key) const {
    const auto found =
        std::find_if(values.begin(), values.end(), [&](const auto& value) { return value.first == key; });
    return found == values.end() ? nullptr : &found->second;
}

Result<std::string> JournalRecord::text(std::string_view key) const {
    if (const std::string* value = find(key)) return *value;
    return input_error("journal record {} ({}) has no {}", number, kind, key);
}

Result<double> JournalRecord::number_of(std::string_view key) const {
    const std::string* value = find(key);
    double result = 0;
    if (value != nullptr) {
        const auto [end, code] = std::from_chars(value->data(), value->data() + value->size(), result);
        if (code == std::errc() && end == value->data() + value->size() && result > -1e12 && result < 1e12)
            return result;
    }
    return input_error("journal record {} ({}): {} is not a number", number, kind, key);
}

Result<long> JournalRecord::whole(std::string_view key) const {
    const std::string* value = find(key);
    long result = 0;
    if (value != nullptr && parse_all(*value, result) && result > -1'000'000'000'000 && result < 1'000'000'000'000)
        return result;
    return input_error("journal record {} ({}): {} is not a whole number", number, kind, key);
}

std::string write_record(long number, std::string_view kind, const JournalValues& values) {
    std::string text = fmt::format("{} {}", number, kind);
    for (const auto& [key, value] : values) text += fmt::format(" {}={}", key, escaped(value));
    return fmt::format("{:08x} {}\n", crc32(text), text);
}

Result<JournalText> parse_journal(std::string_view text, std::string_view where) {
    JournalText journal;
    const std::string_view all = text;
    int bad_line = 0;
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        const auto record = end == std::string_view::npos ? std::nullopt : parse_record(text.substr(0, end));
        if (!record) {
            if (bad_line == 0) bad_line = number;
        } else if (bad_line > 0) {
            return input_error("{}: line {} is damaged in the middle of the journal, which can no longer be trusted",
                               where, bad_line);
        } else if (record->number != static_cast<long>(journal.records.size()) + 1) {
            return input_error("{}: line {} has number {}, {} was expected", where, number, record->number,
                               journal.records.size() + 1);
        } else {
            journal.records.push_back(*record);
            journal.good_bytes += end + 1;
        }
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    if (journal.records.empty() && !all.empty() && !may_begin_record(all))
        return input_error("{}: this is not a journal; give another name with --journal", where);
    return journal;
}

// The file.

Result<Journal> Journal::open(const std::filesystem::path& path, bool sync) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (file < 0) return input_error("{}: {}", path.string(), std::strerror(errno));
    Journal journal(FileHandle(file), path, sync);
    struct stat status {};
    if (::fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) return input_error("{}: not a file", path.string());
    if (::flock(file, LOCK_EX | LOCK_NB) != 0)
        return input_error("{}: another host is printing this job", path.string());
    if (Status read = journal.read_all(); !read) return tl::unexpected(read.error());
    if (sync) sync_folder(path);
    journal.reserve();
    return journal;
}

Status Journal::read_all() {
    std::string text;
    std::array<char, 65536> part;
    for (ssize_t got = 0;
         (got = ::pread(file_.number(), part.data(), part.size(), static_cast<off_t>(text.size()))) != 0;) {
        if (got < 0) return input_error("{}: {}", path_.string(), std::strerror(errno));
        text.append(part.data(), static_cast<std::size_t>(got));
        if (text.size() > most_bytes) return input_error("{}: too long for a journal", path_.string());
    }
    auto parsed = parse_journal(text, path_.string());
    if (!parsed) return tl::unexpected(parsed.error());
    if (parsed->good_bytes < text.size() && ::ftruncate(file_.number(), static_cast<off_t>(parsed->good_bytes)) != 0)
        return failure("{}: {}", path_.string(), std::strerror(errno));
    good_bytes_ = parsed->good_bytes;
    records_ = std::move(parsed->records);
    last_number_ = static_cast<long>(records_.size());
    return {};
}

/// Allocates space beyond the end, so that the last records of a print fit even if others have filled the disk.
/// Optional: not all file systems support it.
void Journal::reserve() const {
    struct stat status {};
    if (::fstat(file_.number(), &status) == 0)
        (void)::fallocate(file_.number(), FALLOC_FL_KEEP_SIZE, status.st_size, reserve_bytes);
}

Status Journal::clear() {
    if (::ftruncate(file_.number(), 0) != 0) return failure("{}: {}", path_.string(), std::strerror(errno));
    records_.clear();
    last_number_ = 0;
    good_bytes_ = 0;
    reserve();
    return {};
}

Result<long> Journal::append(std::string_view kind, const JournalValues& values) {
    const std::string line = write_record(last_number_ + 1, kind, values);
    Status status = write_all(file_.number(), line);
    if (status && sync_ && ::fdatasync(file_.number()) != 0) status = failure("{}", std::strerror(errno));
    if (!status) {
        (void)::ftruncate(file_.number(),
                          static_cast<off_t>(good_bytes_));  // remove a partial record before the next one
        return failure("{}: the journal cannot be written, so no step is taken: {}", path_.string(),
                       status.error().message);
    }
    good_bytes_ += line.size();
    return ++last_number_;
}

}  // namespace pliant::host
