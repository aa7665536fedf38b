#include "printing/host/replace_journal.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <cerrno>
#include <cstring>

#include "base/core/file_handle.hpp"
#include "base/core/files.hpp"
#include "printing/host/journal_facts.hpp"

namespace pliant::host {
namespace {

Status check_replaced(const std::filesystem::path& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return tl::unexpected(text.error());
    const auto journal = parse_journal(*text, path.string());
    if (!journal) return tl::unexpected(journal.error());
    if (journal->records.empty() && !text->empty())
        return input_error("{}: this is not a journal; give another name with --journal", path.string());
    const auto facts = facts_of(journal->records);
    if (!facts) return tl::unexpected(facts.error());
    if (is_interrupted(*facts))
        return input_error(
            "{}: this is the journal of a print that was interrupted; give another name with --journal, or delete it "
            "if nobody will resume that print",
            path.string());
    return {};
}

/// The old journal, locked and checked; nothing is open where there is no file that would be lost.
Result<FileHandle> hold_replaced(const std::filesystem::path& path) {
    std::error_code none;
    if (!std::filesystem::is_regular_file(path, none)) return FileHandle();
    FileHandle file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (!file.is_open()) return input_error("{}: {}", path.string(), std::strerror(errno));
    if (::flock(file.number(), LOCK_EX | LOCK_NB) != 0)
        return input_error("{}: another host is printing with this journal; give another name with --journal",
                           path.string());
    if (Status checked = check_replaced(path); !checked) return tl::unexpected(checked.error());
    return file;
}

}  // namespace

Status may_replace_journal(const std::filesystem::path& path) {
    const Result<FileHandle> held = hold_replaced(path);
    return held ? Status{} : tl::unexpected(held.error());
}

Status replace_journal(const std::filesystem::path& path, std::string_view text) {
    const Result<FileHandle> held = hold_replaced(path);
    return held ? write_file(path, text) : tl::unexpected(held.error());
}

}  // namespace pliant::host
