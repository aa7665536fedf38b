#include "printing/operate/resume_hint.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>

#include <utility>

#include "base/core/file_handle.hpp"
#include "base/core/files.hpp"
#include "base/core/shell_word.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/resume_point.hpp"
#include "printing/operate/programs.hpp"

namespace pliant::operate {
namespace {

/// Whether a host prints with this journal at the moment.
bool is_in_use(const std::filesystem::path& journal) {
    const FileHandle file(::open(journal.c_str(), O_RDONLY | O_CLOEXEC));
    return file.is_open() && ::flock(file.number(), LOCK_SH | LOCK_NB) != 0;
}

struct Interrupted {
    host::JournalFacts facts;
    long last_record = 0;
};

std::optional<Interrupted> interrupted_print(const std::filesystem::path& journal, const std::string& digest,
                                             const std::string& printer) {
    const Result<std::string> text = read_file(journal);
    if (!text || is_in_use(journal)) return {};
    const auto parsed = host::parse_journal(*text, journal.string());
    if (!parsed || parsed->records.empty()) return {};
    auto facts = host::facts_of(parsed->records);
    if (!facts || !host::is_interrupted(*facts)) return {};
    if (facts->digest != digest || facts->printer != printer) return {};
    return Interrupted{std::move(*facts), parsed->records.back().number};
}

}  // namespace

std::string resume_command(const PrintCall& call) {
    std::string line = "pliant print " + shell_word(call.job);
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) line += fmt::format(" {} {}", option, shell_word(value));
    };
    add("--port", call.port.device);
    add("--projector", call.port.projector);
    add("--journal", call.journal);
    add("--emergency-line", call.port.emergency_line);
    add("--after-layer", call.after_layer);
    add("--report", call.report);
    if (call.port.speed != 1) add("--speed", fmt::format("{}", call.port.speed));
    add("--clock", call.port.clock_file.string());
    return line + " --resume";
}

std::optional<long> interrupted_at(const std::filesystem::path& journal, const std::string& digest,
                                   const std::string& printer) {
    const auto print = interrupted_print(journal, digest, printer);
    return print ? std::optional(print->last_record) : std::nullopt;
}

std::vector<std::string> asked_before(const ReadyJob& ready) {
    std::vector<std::string> asked;
    const auto print = interrupted_print(ready.job.journal, ready.job.digest, ready.printer.name);
    if (!print) return asked;
    for (const std::string& text : print->facts.asked) {
        const bool is_refill =
            std::ranges::find(ready.job.refills, text, &host::Refill::text) != ready.job.refills.end();
        if (is_refill && std::ranges::find(asked, text) == asked.end()) asked.push_back(text);
    }
    return asked;
}

Status check_resumable(const ReadyJob& ready) {
    const Result<std::string> text = read_file(ready.job.journal);
    if (!text) return {};
    const auto parsed = host::parse_journal(*text, ready.job.journal.string());
    const auto facts = parsed ? host::facts_of(parsed->records) : tl::unexpected(parsed.error());
    const auto script = host::read_script(ready.job.gcode);
    if (!facts || !script) return {};
    return host::check_way_on(*facts, *script, ready.printer, programs_of(ready.printer).resume);
}

Status expect_journal(const std::filesystem::path& journal, const std::string& job) {
    std::error_code none;
    if (std::filesystem::exists(journal, none)) return {};
    return input_error(
        "--resume: there is no journal {}; name the one of the interrupted print with --journal FILE. Its part may "
        "still "
        "hang on the platform: look before you print {} from its first layer, without --resume",
        journal.string(), job);
}

}  // namespace pliant::operate
