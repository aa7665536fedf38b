#include "loop/study/clashes.hpp"

#include <fmt/format.h>

#include <map>
#include <span>

#include "base/core/config.hpp"
#include "base/core/files.hpp"
#include "loop/study/command_files.hpp"
#include "loop/study/outcome.hpp"

namespace pliant::study {
namespace {

class Clashes {
public:
    /// Takes a column of results.csv.
    void column(const std::string& where, const std::string& title) {
        constexpr std::string_view advice = "every column needs a name of its own";
        const auto [other, is_new] = columns_.emplace(title, where);
        if (is_new) return;
        if (other->second.empty())
            found.push_back({where, fmt::format("is the name of a column that every results.csv has; {}", advice)});
        else
            found.push_back({where, fmt::format("is the name of {} too; in results.csv {}", other->second, advice)});
    }
    /// Takes the option by which a key is passed to the command.
    void option(const std::string& where, const std::string& name) {
        if (name.empty()) return;
        if (const auto [other, is_new] = options_.emplace(name, where); !is_new)
            found.push_back({where, only_one("gives the option", name, other->second)});
    }
    /// Takes the path that a key sets in one of the documents; its first place that another one sets too is told.
    void set(const std::string& where, const std::string& path, std::span<const config::Document> documents) {
        if (path.empty()) return;
        const std::string* clash = nullptr;
        for (const config::Document& document : documents) {
            const auto [other, is_new] = places_.emplace(config::place_of(document, path), where);
            if (!is_new && clash == nullptr) clash = &other->second;
        }
        if (clash != nullptr) found.push_back({where, only_one("sets", path, *clash)});
    }
    std::vector<Clash> found;

private:
    static std::string only_one(std::string_view what, const std::string& name, const std::string& other) {
        return fmt::format("{} \"{}\", as {} does; only one of them may", what, name, other);
    }

    std::map<std::string, std::string> columns_ = {{"row", ""}, {"status", ""}, {"reason", ""}, {"warning", ""}},
                                       options_;
    std::map<config::Place, std::string> places_;
};

/// The files that the command may change by --set, and an empty one, for keys of files that cannot be read yet.
std::vector<config::Document> documents_of(const Plan& plan) {
    std::vector<config::Document> documents(1);
    for (const std::string& word : plan.command) {
        for (const auto& file : files_of(word, plan.folder)) {
            if (lower_extension(file) != ".toml") continue;
            if (auto document = config::load(file)) documents.push_back(std::move(*document));
        }
    }
    return documents;
}

}  // namespace

std::vector<Clash> clashes(const Plan& plan) {
    const std::vector<config::Document> documents = documents_of(plan);
    Clashes clashes;
    for (const Key& key : plan.keys) {
        const std::string where = "key." + key.name;
        clashes.column(where, key.name);
        if (!key.unit.empty()) clashes.column(where, column_of(key));
        clashes.set(where, key.set, documents);
        clashes.option(where, key.option);
    }
    for (const Wanted& wanted : plan.results) clashes.column("result." + wanted.name, wanted.name);
    return std::move(clashes.found);
}

}  // namespace pliant::study
