#include "robot/file/material_library.hpp"

#include <algorithm>
#include <utility>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"
#include "robot/file/material_file.hpp"

namespace pliant::robot {
namespace {

constexpr std::array<std::string_view, 5> about = {"title", "hardness", "source", "derivation", "stretch"};
constexpr std::array<std::string_view, 10> elastic = {
    "law", "youngs_modulus", "poisson_ratio", "bulk_modulus", "c10", "c01", "c20", "c30", "mu", "alpha"};

bool has_key(const config::Table& table, std::string_view key) {
    return std::any_of(table.begin(), table.end(), [&](const config::Entry& e) { return e.first == key; });
}

template <std::size_t n>
bool contains(const std::array<std::string_view, n>& keys, std::string_view key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

Result<config::Document> parse_file(const EmbeddedFile& file) {
    return config::parse(file.text, "data/materials/" + std::string(file.name) + ".toml");
}

bool replaced(const config::Table& own, std::string_view key) {
    if (has_key(own, key) || contains(about, key)) return true;
    if (has_key(own, "law") && contains(elastic, key)) return true;
    return (key == "poisson_ratio" && has_key(own, "bulk_modulus")) ||
           (key == "bulk_modulus" && has_key(own, "poisson_ratio"));
}

void set_line(config::Value& value, int line) {
    value.line = line;
    if (auto* list = std::get_if<config::Array>(&value.data)) {
        for (config::Value& entry : *list) set_line(entry, line);
    }
}

}  // namespace

Result<LibraryMaterial> library_material(std::string_view name) {
    const EmbeddedFile* file = find_file(library_files(), name);
    if (file == nullptr) return input_error("the library has no material \"{}\"{}", name, library_hint(name));
    Result<config::Document> document = parse_file(*file);
    if (!document) return tl::unexpected(document.error());
    config::Problems problems(document->file.string());
    config::Reader reader(document->root, problems);
    LibraryMaterial material;
    material.spec = read_material(reader, std::string(name));
    material.title = reader.text("title");
    material.hardness = reader.text("hardness", "");
    material.source = reader.text("source");
    material.derivation = reader.text("derivation");
    const auto stretch = reader.numbers("stretch", 2);
    material.stretch = {stretch[0], stretch[1]};
    reader.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    return material;
}

std::string library_hint(std::string_view given) {
    std::string name = lower_case(given);  // as the library writes names
    std::ranges::replace(name, ' ', '-');
    std::vector<std::pair<int, std::string>> near;
    for (const EmbeddedFile& file : library_files()) {
        const int distance = edit_distance(name, file.name);
        const std::string_view stem = file.name.substr(0, file.name.find('-'));
        const bool family =
            name.size() >= 3 && (file.name.find(name) != std::string_view::npos || name.starts_with(stem));
        if (family || distance <= static_cast<int>(name.size()) / 3) near.emplace_back(distance, file.name);
    }
    if (near.empty()) return "; \"pliant materials\" lists the library";
    std::sort(near.begin(), near.end());
    std::vector<std::string> names;
    for (std::size_t i = 0; i < std::min<std::size_t>(near.size(), 4); ++i) names.push_back(near[i].second);
    if (names.size() == 1) return fmt::format("; did you mean \"{}\" of the library?", names[0]);
    return fmt::format("; near it in the library: {}", join_names(names));
}

config::Value with_base(const config::Value& own, std::string_view base) {
    const auto& keys = std::get<config::Table>(own.data);
    config::Value merged{config::Table{}, own.line};
    auto& table = std::get<config::Table>(merged.data);
    for (const config::Entry& entry : keys) {
        if (entry.first != "base") table.push_back(entry);
    }
    const EmbeddedFile* file = find_file(library_files(), base);
    const Result<config::Document> document = parse_file(*file);
    if (!document) return merged;
    for (config::Entry entry : std::get<config::Table>(document->root.data)) {
        if (replaced(keys, entry.first)) continue;
        set_line(entry.second, own.line);  // errors in it are reported at this line
        table.push_back(std::move(entry));
    }
    if (!has_key(table, "resin")) table.emplace_back("resin", config::Value{std::string(base), own.line});
    return merged;
}

}  // namespace pliant::robot
