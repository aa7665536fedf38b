#include "robot/file/robot_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>
#include <utility>

#include "base/core/config_text.hpp"
#include "base/core/files.hpp"
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
    const std::vector<std::string> parts = config::path_parts(assignment.substr(0, assignment.find('=')));
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
    return fs::equivalent(path, shorter, ignored) ? shorter : path;
}

fs::path beside(const fs::path& file, const std::string& name) {
    return readable_path(file.parent_path() / name);
}

}  // namespace

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

Result<std::optional<std::string>> base_text(std::string_view text, const fs::path& file) {
    const Result<config::Document> document = config::parse(text, file);
    if (!document) return tl::unexpected(document.error());
    const config::Value* named = entry_of(document->root, "robot");
    const auto* name = named == nullptr ? nullptr : std::get_if<std::string>(&named->data);
    if (name == nullptr) return std::nullopt;
    Result<std::string> base = read_file(beside(file, *name));
    if (!base) return tl::unexpected(base.error());
    return std::optional(std::move(*base));
}

std::vector<fs::path> files_of(const fs::path& file, const std::vector<std::string>& assignments) {
    std::vector<fs::path> files = {file};
    Result<config::Document> document = config::load(file);
    if (!document) return files;
    const config::Value* base = entry_of(document->root, "robot");
    const auto* name = base == nullptr ? nullptr : std::get_if<std::string>(&base->data);
    if (name != nullptr) files.push_back(beside(file, *name));
    document = on_base(std::move(*document));
    if (!document || !set_all(*document, assignments)) return files;
    add_paths(document->root, document->file.parent_path(), files);
    return files;
}

Result<config::Document> on_base(config::Document document) {
    Problems problems(document.file.string());
    Reader root(document.root, problems);
    if (!root.has("robot")) return document;
    const fs::path file = beside(document.file, root.text("robot"));
    const std::vector<std::string> changes = root.texts("set");
    const config::Value* program = root.raw("program");
    if (program != nullptr && !std::holds_alternative<config::Table>(program->data))
        root.problem("program", "must be a table");
    root.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    Result<config::Document> base = config::load(file);
    if (!base) return tl::unexpected(base.error());
    if (Status status = set_all(*base, changes); !status) return tl::unexpected(status.error());
    auto& table = std::get<config::Table>(base->root.data);
    if (program == nullptr) return base;
    config::Value own = *program;
    forget_lines(own);
    const auto there =
        std::find_if(table.begin(), table.end(), [](const config::Entry& entry) { return entry.first == "program"; });
    if (there == table.end())
        table.emplace_back("program", std::move(own));
    else if (auto* theirs = std::get_if<config::Table>(&there->second.data))
        put_over(*theirs, std::get<config::Table>(std::move(own.data)));
    return base;
}

namespace {

/// Including its base file and overrides.
Result<config::Document> whole_document(std::string_view text, const fs::path& file,
                                        const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::parse(text, file);
    if (document) document = on_base(std::move(*document));
    if (!document) return document;
    if (Status status = set_all(*document, assignments); !status) return tl::unexpected(status.error());
    return document;
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

Result<std::string> robot_text(std::string_view text, const fs::path& file, const std::vector<std::string>& assignments,
                               const fs::path& folder) {
    Result<config::Document> document = whole_document(text, file, assignments);
    if (!document) return tl::unexpected(document.error());
    lead_paths(document->root, fs::absolute(document->file).parent_path(), fs::absolute(folder));
    return config::toml_text(document->root);
}

}  // namespace pliant::robot
