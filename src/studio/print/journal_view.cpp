#include "studio/print/journal_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "printing/host/journal.hpp"
#include "printing/host/journal_facts.hpp"
#include "studio/base/dumped.hpp"
#include "studio/base/limits.hpp"
#include "studio/print/journal_names.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t most_records = 2000, longest_record_text = 300;

Result<host::JournalText> read_journal(const std::filesystem::path& file) {
    const Result<std::string> text = read_file(file, largest_journal);
    if (!text) return tl::unexpected(text.error());
    return host::parse_journal(*text, file.filename().string());
}

const char* state_of(const host::JournalFacts& facts) {
    if (!facts.begun) return "not begun";
    if (facts.ended) return "complete";
    return facts.cancelled ? "cancelled" : "interrupted";
}

Json line_of(const std::string& name, const host::JournalFacts& facts) {
    const auto given = [](const auto& light) { return light.second.complete; };
    return {{"name", name},
            {"file", job_of_journal(name)},
            {"virtual", is_virtual_journal(name)},
            {"job", facts.job},
            {"printer", facts.printer},
            {"state", state_of(facts)},
            {"lights", std::count_if(facts.lights.begin(), facts.lights.end(), given)},
            {"layer", facts.last_light ? facts.lights.at(*facts.last_light).layer : -1}};
}

/// "layer=3 material=0 planned=2.5", the first line of a program.
std::string record_text(const host::JournalRecord& record) {
    std::string text;
    for (const auto& [key, value] : record.values) {
        const std::string_view line = std::string_view(value).substr(0, value.find('\n'));
        text += fmt::format("{}{}={}{}", text.empty() ? "" : " ", key, line, line.size() < value.size() ? " …" : "");
    }
    if (text.size() > longest_record_text) {
        text.resize(longest_record_text);
        text += "…";
    }
    return text;
}

}  // namespace

std::string journal_line_json(const std::filesystem::path& file, const std::string& name) {
    const Result<host::JournalText> journal = read_journal(file);
    const Result<host::JournalFacts> facts =
        journal ? host::facts_of(journal->records) : Result<host::JournalFacts>(tl::unexpected(journal.error()));
    if (!facts)
        return dumped({{"name", name},
                       {"file", job_of_journal(name)},
                       {"virtual", is_virtual_journal(name)},
                       {"state", "damaged"},
                       {"error", facts.error().message}});
    return dumped(line_of(name, *facts));
}

Result<std::string> journal_json(const std::filesystem::path& file, const std::string& name) {
    const Result<host::JournalText> journal = read_journal(file);
    if (!journal) return tl::unexpected(journal.error());
    const Result<host::JournalFacts> facts = host::facts_of(journal->records);
    if (!facts) return tl::unexpected(facts.error());
    Json json = line_of(name, *facts), records = Json::array();
    const auto& all = journal->records;
    for (std::size_t i = all.size() - std::min(all.size(), most_records); i < all.size(); ++i)
        records.push_back({{"number", all[i].number}, {"kind", all[i].kind}, {"text", record_text(all[i])}});
    json["records"] = std::move(records);
    json["open_light"] =
        facts->last_light && facts->lights.at(*facts->last_light).open_light != 0 && !facts->ended && !facts->cancelled;
    return dumped(json);
}

}  // namespace pliant::studio
