#include "robot/file/robot_document.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "base/core/config_text.hpp"
#include "base/core/digest.hpp"
#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "base/core/text.hpp"

namespace pliant::robot {
namespace {

namespace fs = std::filesystem;
using config::Problems;
using config::Reader;

/// Merges the values of `from` into `into`, replacing existing ones, as `--set` does; without line numbers.
void put_over(config::Table& into, config::Table from) {
    for (auto& [key, value] : from) {
        const auto is_it = [&key = key](const config::Entry& entry) { return entry.first == key; };
        const auto there = std::find_if(into.begin(), into.end(), is_it);
        if (there == into.end())
            into.emplace_back(key, std::move(value));
        else
            there->second = std::move(value);
    }
}

void forget_lines(config::Value& value) {
    value.line = 0;
    if (auto* list = std::get_if<config::Array>(&value.data)) {
        for (config::Value& entry : *list) forget_lines(entry);
    }
    if (auto* table = std::get_if<config::Table>(&value.data)) {
        for (auto& [key, entry] : *table) forget_lines(entry);
    }
}

}  // namespace

const config::Value* entry_of(const config::Value& value, std::string_view key) {
    const auto* table = std::get_if<config::Table>(&value.data);
    if (table == nullptr) return nullptr;
    const auto found = std::ranges::find(*table, key, [](const config::Entry& entry) { return entry.first; });
    return found == table->end() ? nullptr : &found->second;
}

namespace {

constexpr std::array<std::string_view, 3> tables_of_names = {"material", "parameters", "shape"};

/// A table entry that an assignment has added, such as material.soft.
struct AddedName {
    std::string kind, name;
};

/// The entry that this assignment is about to add, if any.
std::optional<AddedName> added_name(const config::Document& document, std::string_view assignment) {
    const std::vector<std::string> parts = config::path_parts(trimmed(assignment.substr(0, assignment.find('='))));
    if (parts.size() < 2) return std::nullopt;
    const AddedName added{parts[0], parts[1]};
    if (std::ranges::find(tables_of_names, added.kind) == tables_of_names.end()) return std::nullopt;
    const config::Value* table = entry_of(document.root, added.kind);
    if (table != nullptr && entry_of(*table, added.name) != nullptr) return std::nullopt;
    return added;
}

/// Some text is the name, or a formula that holds it.
bool is_mentioned(const config::Value& value, const std::string& name) {
    if (const auto* text = std::get_if<std::string>(&value.data))
        return *text == name || (text->starts_with("=") && text->find(name) != std::string::npos);
    if (const auto* list = std::get_if<config::Array>(&value.data))
        return std::ranges::any_of(*list, [&](const config::Value& entry) { return is_mentioned(entry, name); });
    const auto* table = std::get_if<config::Table>(&value.data);
    return table != nullptr &&
           std::ranges::any_of(*table, [&](const config::Entry& entry) { return is_mentioned(entry.second, name); });
}

tl::unexpected<Error> not_used(const config::Document& document, const AddedName& added) {
    std::vector<std::string> others;
    if (const auto* table = std::get_if<config::Table>(&entry_of(document.root, added.kind)->data)) {
        for (const auto& [name, value] : *table)
            if (name != added.name) others.push_back(name);
    }
    const std::string near = nearest_name(added.name, others);
    const std::string hint = !near.empty()    ? fmt::format("; did you mean \"{}\"?", near)
                             : others.empty() ? ""
                                              : fmt::format("; the file has {}", join_names(others));
    return input_error("--set {}.{}: the file has no {} \"{}\", and nothing would use it{}", added.kind, added.name,
                       added.kind == "parameters" ? "parameter" : added.kind, added.name, hint);
}

/// Keys whose values are file names, in any table.
constexpr std::array<std::string_view, 4> path_keys = {"geometry", "surface", "file", "path"};

void lead_paths(config::Value& value, const fs::path& from, const fs::path& to) {
    if (auto* list = std::get_if<config::Array>(&value.data)) {
        for (config::Value& entry : *list) lead_paths(entry, from, to);
        return;
    }
    auto* table = std::get_if<config::Table>(&value.data);
    if (table == nullptr) return;
    for (auto& [key, entry] : *table) {
        auto* text = std::get_if<std::string>(&entry.data);
        const bool path = text != nullptr && std::ranges::find(path_keys, key) != path_keys.end();
        std::error_code ignored;
        if (path && fs::path(*text).is_relative() && fs::exists(from / *text, ignored))
            *text = fs::relative(from / *text, to).generic_string();
        else
            lead_paths(entry, from, to);
    }
}

void add_paths(const config::Value& value, const fs::path& folder, std::vector<fs::path>& files) {
    if (const auto* list = std::get_if<config::Array>(&value.data))
        for (const config::Value& entry : *list) add_paths(entry, folder, files);
    const auto* table = std::get_if<config::Table>(&value.data);
    if (table == nullptr) return;
    for (const auto& [key, entry] : *table) {
        const auto* text = std::get_if<std::string>(&entry.data);
        std::error_code ignored;
        if (text == nullptr || std::ranges::find(path_keys, key) == path_keys.end())
            add_paths(entry, folder, files);
        else if (fs::is_regular_file(folder / *text, ignored))
            files.push_back(folder / *text);
    }
}

/// Without ".." where that is the same file: behind a folder that is a link it is another one.
fs::path readable_path(const fs::path& path) {
    std::error_code ignored;
    fs::path shorter = path.lexically_normal();
    // Folders are compared, since there may be no file.
    const auto folder_of = [](const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; };
    return fs::equivalent(folder_of(path), folder_of(shorter), ignored) ? shorter : path;
}

fs::path beside(const fs::path& file, const std::string& name) {
    return readable_path(file.parent_path() / name);
}

}  // namespace

bool set_goal_times(const std::vector<std::string>& assignments) {
    return std::ranges::any_of(assignments, [](const std::string& assignment) {
        const auto parts = config::path_parts(trimmed(std::string_view(assignment).substr(0, assignment.find('='))));
        return parts.size() > 1 && parts.front() == "goal" && parts.back() == "times";
    });
}

Status set_all(config::Document& document, const std::vector<std::string>& assignments) {
    std::vector<AddedName> all;
    for (const std::string& assignment : assignments) {
        std::optional<AddedName> added = added_name(document, assignment);
        if (Status status = config::set(document, assignment); !status) return status;
        if (added) all.push_back(std::move(*added));
    }
    for (const AddedName& added : all) {
        if (!is_mentioned(document.root, added.name)) return not_used(document, added);
    }
    return {};
}

namespace {

/// The file that the document names as robot = "FILE.toml"; none without that key, or where it is no text.
std::optional<fs::path> named_base(const config::Document& document) {
    const config::Value* named = entry_of(document.root, "robot");
    const auto* name = named == nullptr ? nullptr : std::get_if<std::string>(&named->data);
    return name == nullptr ? std::nullopt : std::optional(beside(document.file, *name));
}

/// The same for every name of one file.
fs::path place_of(const fs::path& file) {
    std::error_code ignored;
    return fs::weakly_canonical(fs::absolute(file, ignored), ignored);
}

/// The files of a chain, each of which stands on the next.
class Chain {
public:
    explicit Chain(const fs::path& first) { (void)add(first); }
    /// False: it is one of them already.
    bool add(const fs::path& file) {
        names_.push_back(file.filename().string());
        return places_.insert(place_of(file)).second;
    }
    [[nodiscard]] std::string text() const { return fmt::format("{}", fmt::join(names_, " -> ")); }

private:
    std::vector<std::string> names_;
    std::set<fs::path> places_;
};

/// What a file changes of the robot that it stands on.
struct Changes {
    fs::path base;
    std::vector<std::string> assignments;
    std::optional<config::Value> program;
};

Result<Changes> read_changes(const config::Document& document, Chain& chain) {
    Problems problems(document.file.string());
    Reader root(document.root, problems);
    Changes changes{beside(document.file, root.text("robot")), root.texts("set"), std::nullopt};
    if (const config::Value* program = root.raw("program")) changes.program = *program;
    if (changes.program && !std::holds_alternative<config::Table>(changes.program->data))
        root.problem("program", "must be a table");
    if (!root.unreadable("robot") && !chain.add(changes.base))
        root.problem("robot", "stands on itself: " + chain.text());
    root.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    return changes;
}

/// Steps and tolerances alone leave a program what it was.
bool has_course(const config::Value& program) {
    return entry_of(program, "duration") != nullptr || entry_of(program, "key") != nullptr;
}

Status apply(config::Document& document, Changes changes) {
    if (Status status = set_all(document, changes.assignments); !status) return status;
    if (!changes.program) return {};
    forget_lines(*changes.program);
    auto& table = std::get<config::Table>(document.root.data);
    const auto there =
        std::find_if(table.begin(), table.end(), [](const config::Entry& entry) { return entry.first == "program"; });
    if (there == table.end())
        table.emplace_back("program", *std::move(changes.program));
    else if (auto* theirs = std::get_if<config::Table>(&there->second.data))
        put_over(*theirs, std::get<config::Table>(std::move(changes.program->data)));
    return {};
}

}  // namespace

Result<std::optional<std::string>> base_text(std::string_view text, const fs::path& file) {
    Result<config::Document> document = config::parse(text, file);
    std::optional<std::string> all;
    Chain chain(file);
    while (document) {
        const std::optional<fs::path> base = named_base(*document);
        if (!base || !chain.add(*base)) return all;
        const Result<std::string> next = read_file(*base);
        if (!next) return tl::unexpected(next.error());
        all = all ? *all + "\nstands on\n" + *next : *next;
        document = config::parse(*next, *base);
    }
    return tl::unexpected(document.error());
}

std::vector<fs::path> files_of(const fs::path& file, const std::vector<std::string>& assignments) {
    std::vector<fs::path> files = {file};
    const Result<config::Document> first = config::load(file);
    Chain chain(file);
    for (Result<config::Document> at = first; at; at = config::load(files.back())) {
        const std::optional<fs::path> base = named_base(*at);
        if (!base || !chain.add(*base)) break;
        files.push_back(*base);
    }
    if (!first) return files;
    Result<BasedDocument> based = on_base(*first);
    if (!based || !set_all(based->document, assignments)) return files;
    add_paths(based->document.root, based->document.file.parent_path(), files);
    return files;
}

Result<BasedDocument> on_base(config::Document document) {
    BasedDocument based;
    std::vector<Changes> above;
    Chain chain(document.file);
    while (entry_of(document.root, "robot") != nullptr) {
        Result<Changes> changes = read_changes(document, chain);
        if (!changes) return tl::unexpected(changes.error());
        Result<config::Document> base = config::load(changes->base);
        if (!base) return tl::unexpected(base.error());
        based.has_other_program = based.has_other_program || changes->program;
        based.has_other_course = based.has_other_course || (changes->program && has_course(*changes->program));
        based.sets_goal_times = based.sets_goal_times || set_goal_times(changes->assignments);
        above.push_back(std::move(*changes));
        document = std::move(*base);
    }
    based.document = std::move(document);
    for (; !above.empty(); above.pop_back())
        if (Status status = apply(based.document, std::move(above.back())); !status)
            return tl::unexpected(status.error());
    return based;
}

namespace {

/// Including its base file and overrides.
Result<config::Document> whole_document(std::string_view text, const fs::path& file,
                                        const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::parse(text, file);
    if (!document) return document;
    Result<BasedDocument> based = on_base(std::move(*document));
    if (!based) return tl::unexpected(based.error());
    if (Status status = set_all(based->document, assignments); !status) return tl::unexpected(status.error());
    return std::move(based->document);
}

}  // namespace

Result<std::vector<std::pair<std::string, double>>> free_parameters(std::string_view text, const fs::path& file,
                                                                    const std::vector<std::string>& assignments) {
    const Result<config::Document> document = whole_document(text, file, assignments);
    if (!document) return tl::unexpected(document.error());
    std::vector<std::pair<std::string, double>> found;
    for (const auto& [key, value] : std::get<config::Table>(document->root.data)) {
        const auto* table = key == "parameters" ? std::get_if<config::Table>(&value.data) : nullptr;
        if (table == nullptr) continue;
        for (const auto& [name, number] : *table) {
            if (const auto* real = std::get_if<double>(&number.data)) found.emplace_back(name, *real);
            if (const auto* whole = std::get_if<std::int64_t>(&number.data))
                found.emplace_back(name, static_cast<double>(*whole));
        }
    }
    return found;
}

Result<std::string> digest_of_named_files(std::string_view text, const fs::path& file,
                                          const std::vector<std::string>& assignments) {
    const Result<config::Document> document = whole_document(text, file, assignments);
    if (!document) return tl::unexpected(document.error());
    std::vector<fs::path> files;
    add_paths(document->root, document->file.parent_path(), files);
    Digest digest;
    for (const fs::path& named : files) {
        const Result<std::string> content = read_file(named);
        if (!content) return tl::unexpected(content.error());
        const std::size_t size = content->size();
        digest.add(&size, sizeof size);
        digest.add(content->data(), size);
    }
    return files.empty() ? "" : digest.text();
}

Result<std::string> robot_text(std::string_view text, const fs::path& file, const std::vector<std::string>& assignments,
                               const fs::path& folder) {
    Result<config::Document> document = whole_document(text, file, assignments);
    if (!document) return tl::unexpected(document.error());
    std::error_code error;
    const auto whole = [&](const fs::path& path) { return fs::absolute(path.empty() ? "." : path, error); };
    const fs::path from = whole(document->file).parent_path();
    const fs::path to = error ? fs::path() : whole(folder);
    if (error) return input_error("{}: the working directory cannot be read: {}", file.string(), error.message());
    lead_paths(document->root, from, to);
    return config::toml_text(document->root);
}

namespace {

/// The last key of the program that drives this; empty: none does. "program.key[1].flexor".
std::string last_key_of(const config::Document& document, const std::string& name) {
    const config::Value* program = entry_of(document.root, "program");
    const config::Value* list = program != nullptr ? entry_of(*program, "key") : nullptr;
    const auto* keys = list != nullptr ? std::get_if<config::Array>(&list->data) : nullptr;
    if (keys == nullptr) return "";
    for (std::size_t k = keys->size(); k > 0; --k) {
        if (entry_of((*keys)[k - 1], name) != nullptr)
            return fmt::format("program.key[{}].{}", k - 1, config::path_part(name));
    }
    return "";
}

/// True if `place` is the value of a target, of whatever kind, of this cable or chamber.
bool is_target_value(const config::Place& place, const config::Value& actuator) {
    constexpr std::string_view not_driven = "offset";
    if (place.value == &actuator)
        return place.rest.size() == 2 && place.rest[0] == "target" && place.rest[1] != not_driven;
    const config::Value* target = entry_of(actuator, "target");
    const auto* kinds = target != nullptr ? std::get_if<config::Table>(&target->data) : nullptr;
    return kinds != nullptr && place.rest.empty() && std::ranges::any_of(*kinds, [&](const config::Entry& kind) {
               return place.value == &kind.second && kind.first != not_driven;
           });
}

}  // namespace

std::string why_idle(const config::Document& document, std::string_view path) {
    const config::Place place = config::place_of(document, path);
    for (const std::string_view list : {"cable", "chamber"}) {
        const config::Value* value = entry_of(document.root, list);
        const auto* actuators = value != nullptr ? std::get_if<config::Array>(&value->data) : nullptr;
        for (std::size_t k = 0; actuators != nullptr && k < actuators->size(); ++k) {
            const config::Value& actuator = (*actuators)[k];
            const config::Value* given = entry_of(actuator, "name");
            const auto* name = given != nullptr ? std::get_if<std::string>(&given->data) : nullptr;
            if (name == nullptr || !is_target_value(place, actuator)) continue;
            const std::string key = last_key_of(document, *name);
            if (key.empty()) return "";
            return fmt::format(
                "{} changes nothing, since keys of the program drive {} \"{}\" and say its targets; set {} instead",
                path, list, *name, key);
        }
    }
    return "";
}

}  // namespace pliant::robot
