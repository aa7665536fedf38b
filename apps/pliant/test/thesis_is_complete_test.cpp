// docs/thesis.md has every number of the thesis in a heading, in order, each with commands that run; and
// examples/thesis has a row, a place and a command for every figure.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "document.hpp"

using namespace pliant;
using namespace pliant::app;

namespace {

using Names = std::vector<std::string>;

/// The numbered items of the thesis, kind by kind in order. Only sections with claims are included.
const std::map<std::string, Names> thesis_numbers = {
    {"equation", {"T3.1", "T3.2", "T3.3", "T3.4", "T3.5", "T3.6", "T3.7", "T3.8"}},
    {"appendix", {"A.1", "A.2", "A.3", "A.4", "B.1", "B.2", "B.3", "B.4", "B.5"}},
    {"figure", {"F1.1", "F3.1", "F3.2", "F3.3", "F3.4", "F3.5", "F3.6", "F3.7", "F3.8", "F4.1",
                "F4.2", "F4.3", "F4.4", "F4.5", "F4.6", "F4.7", "F4.8", "FB.1", "FB.2", "FB.3"}},
    {"table", {"table 4.1", "table 4.2"}},
    {"section", {"abstract",      "section 1",     "section 2.1",   "section 2.2",   "section 2.2.1", "section 2.2.2",
                 "section 2.2.3", "section 3.1",   "section 3.2",   "section 3.3",   "section 3.3.1", "section 3.3.2",
                 "section 3.4.1", "section 3.4.2", "section 3.5",   "section 3.5.1", "section 3.5.2", "section 3.6",
                 "section 4.1",   "section 4.2.1", "section 4.2.2", "section 4.3",   "section 4.3.1", "section 4.3.2",
                 "section 4.4",   "section 4.4.1", "section 4.4.2", "section 4.5",   "future work"}}};

struct Entry {
    int line = 0;
    std::string heading;
    Names names;       ///< what stands before the colon, in lower case but for the T, F, A and B of numbers
    int commands = 0;  ///< number of commands that run and show their output
};

Names names_of(const std::string& heading) {
    static const std::regex name(R"([^,]+)"), word("^(Abstract|Section|Table|Future work)");
    const std::string list = heading.substr(0, heading.find(':'));
    Names names;
    for (std::sregex_iterator it(list.begin(), list.end(), name), end; it != end; ++it) {
        std::string one = it->str().substr(it->str().find_first_not_of(' '));
        if (std::regex_search(one, word)) one[0] = static_cast<char>(std::tolower(one[0]));
        names.push_back(one);
    }
    return names;
}

/// The sections under `### ` with their commands. A block of commands without any output does not count.
std::vector<Entry> entries_of(const std::string& text) {
    std::vector<Entry> entries;
    std::istringstream in(text);
    int number = 0;
    for (std::string line; std::getline(in, line);) {
        ++number;
        if (line.starts_with("### ")) entries.push_back({number, line.substr(4), names_of(line.substr(4)), 0});
    }
    const auto steps = document_steps(text);
    REQUIRE(steps.has_value());
    for (const DocumentStep& step : *steps) {
        const auto after =
            std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.line > step.line; });
        if (after == entries.begin() || step.kind != DocumentStep::Kind::command || step.output.empty()) continue;
        ++std::prev(after)->commands;
    }
    return entries;
}

int line_of(const std::vector<Entry>& entries, const std::string& name) {
    for (const Entry& entry : entries) {
        if (std::find(entry.names.begin(), entry.names.end(), name) != entry.names.end()) return entry.line;
    }
    return 0;
}

/// Everything that the documents run which show the figures.
std::string all_commands() {
    namespace fs = std::filesystem;
    std::vector<fs::path> documents = {"docs/thesis.md", "examples/printed/README.md"};
    for (const auto& folder : fs::directory_iterator("examples/thesis")) {
        if (folder.is_directory()) documents.push_back(folder.path() / "README.md");
    }
    std::string commands;
    for (const fs::path& document : documents) {
        const auto steps = document_steps(read_file(document).value());
        REQUIRE_MESSAGE(steps.has_value(), document.string());
        for (const DocumentStep& step : *steps) {
            if (step.kind == DocumentStep::Kind::command) commands += step.text + "\n";
        }
    }
    return commands;
}

}  // namespace

TEST_CASE("every equation, figure, table and section of the thesis has an entry, in its order") {
    const auto entries = entries_of(read_file("docs/thesis.md").value());
    for (const auto& [kind, names] : thesis_numbers) {
        int before = 0;
        for (const std::string& name : names) {
            const int line = line_of(entries, name);
            CHECK_MESSAGE(line > 0, "docs/thesis.md has no entry for " << name);
            CHECK_MESSAGE((line == 0 || line >= before), name << " comes too early");
            before = std::max(before, line);
        }
    }
}

TEST_CASE("every entry has a command that runs and an output that is shown") {
    const auto entries = entries_of(read_file("docs/thesis.md").value());
    CHECK(entries.size() > 60);
    const auto is_future = [](const Entry& entry) { return entry.heading.starts_with("Future work: "); };
    CHECK(std::count_if(entries.begin(), entries.end(), is_future) == 12);
    for (const Entry& entry : entries)
        CHECK_MESSAGE(entry.commands > 0, "docs/thesis.md:" << entry.line << ": no command: " << entry.heading);
}

TEST_CASE("a missing number and an entry without a command are found") {
    const std::string text =
        "## Chapter\n### T3.1, section 3.2: a\n```\n$ pliant plan\nx\n```\n### Table 4.1: b\n"
        "<!-- run: not it is long -->\n```\n$ pliant plan\nx\n```\n### F3.1: c\n```\n$ pliant plan -q\n```\n";
    const auto entries = entries_of(text);
    REQUIRE(entries.size() == 3);
    CHECK(line_of(entries, "T3.1") == 2);
    CHECK(line_of(entries, "section 3.2") == 2);
    CHECK(line_of(entries, "table 4.1") == 7);
    CHECK(line_of(entries, "T3.2") == 0);
    CHECK(entries[0].commands == 1);
    CHECK(entries[1].commands == 0);  // not run
    CHECK(entries[2].commands == 0);  // shows nothing
}

TEST_CASE("every figure has a row with a place that exists and a command that the suite runs") {
    const std::string text = read_file("examples/thesis/README.md").value(), commands = all_commands();
    static const std::regex row(
        R"(\| ([0-9B]\.[0-9]) ?[a-zA-C]? \|[^|]*\| \[[^\]]*\]\(([^)#]*)[^)]*\) \| `([^`]*)` \|)");
    std::map<std::string, int> rows;
    for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it) {
        const std::string place = (*it)[2], command = (*it)[3];
        ++rows["F" + (*it)[1].str()];
        CHECK_MESSAGE(std::filesystem::exists("examples/thesis/" + place), place);
        CHECK_MESSAGE(commands.find(command) != std::string::npos, "no document runs " << command);
    }
    for (const std::string& figure : thesis_numbers.at("figure"))
        CHECK_MESSAGE(rows[figure] > 0, "examples/thesis/README.md has no row for " << figure);
}

TEST_CASE("every folder of a figure is in the suite: its numbers, and its document") {
    const std::string examples = read_file("examples/CMakeLists.txt").value();
    const std::string documents = read_file("apps/pliant/test/CMakeLists.txt").value();
    for (const auto& folder : std::filesystem::directory_iterator("examples/thesis")) {
        if (!folder.is_directory()) continue;
        const std::string name = "thesis/" + folder.path().filename().string();
        CHECK_MESSAGE(documents.find("examples/" + name + "/README") != std::string::npos, name);
        if (std::filesystem::exists(folder.path() / "expected.json"))
            CHECK_MESSAGE(examples.find(name) != std::string::npos, name);
    }
}
