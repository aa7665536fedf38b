// A journal of arbitrary bytes: whatever can be parsed must give facts and a resume point, or a reason.
#include "printing/host/journal.hpp"

#include <algorithm>
#include <string>

#include "input.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/resume_point.hpp"
#include "tower.hpp"

namespace {

using namespace pliant;

/// Adds correct checksums to records "kind key=value ...", one per line, so that the fuzzer gets past that check.
std::string with_checksums(std::string_view text) {
    std::string journal;
    long number = 0;
    while (!text.empty()) {
        std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        const std::string_view kind = line.substr(0, line.find(' '));
        host::JournalValues values;
        line.remove_prefix(std::min(line.size(), kind.size() + 1));
        while (!line.empty()) {
            const std::string_view pair = line.substr(0, line.find(' '));
            line.remove_prefix(std::min(line.size(), pair.size() + 1));
            const std::size_t equals = std::min(pair.find('='), pair.size());
            std::string value(pair.substr(std::min(pair.size(), equals + 1)));
            for (char& c : value) c = c == '_' ? '\n' : c;  // programs have several lines
            values.emplace_back(std::string(pair.substr(0, equals)), std::move(value));
        }
        journal += host::write_record(++number, kind, values);
    }
    return journal;
}

void go_on(const host::JournalText& text) {
    const host::Script script = host::read_script(
                                    "G28 Z\nG28 X\nG28 Y\nG1 Y0.5 F60\nG1 X355.6\nG1 Y30\nG1 X0\nG1 Z0.05\n"
                                    ";@expose layer=0 material=0 seconds=2.5 image=a.png\nG1 Z5\n")
                                    .value();
    auto facts = host::facts_of(text.records);
    if (!facts) return;
    const auto open = host::close_open_light(*facts, nullptr, {1.0, false}, {"soft"});
    if (!open) return;
    for (const long last_line : {0L, facts->go ? facts->go->line + 2 : 5L}) {
        const auto standing = host::standing_of(*facts, script, tower(), last_line, {});
        if (standing) (void)host::recovery_of(*facts, script, tower(), *standing);
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto raw = host::parse_journal(as_text(data, size), "journal");
    if (raw) go_on(*raw);
    const auto dressed = host::parse_journal(with_checksums(as_text(data, size)), "journal");
    if (dressed) go_on(*dressed);
    return 0;
}
