#include "loop/study/clashes.hpp"

#include <fmt/format.h>

#include <map>

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
    /// Takes what a key passes to the command.
    void use(const std::string& where, const std::string& what, const std::string& name) {
        if (name.empty()) return;
        const auto [other, is_new] = uses_.emplace(what + name, where);
        if (!is_new)
            found.push_back(
                {where, fmt::format("{} \"{}\", as {} does; only one of them may", what, name, other->second)});
    }
    std::vector<Clash> found;

private:
    std::map<std::string, std::string> columns_ = {{"row", ""}, {"status", ""}, {"reason", ""}}, uses_;
};

}  // namespace

std::vector<Clash> clashes(const Plan& plan) {
    Clashes clashes;
    for (const Key& key : plan.keys) {
        const std::string where = "key." + key.name;
        clashes.column(where, key.name);
        if (!key.unit.empty()) clashes.column(where, column_of(key));
        clashes.use(where, "sets", key.set);
        clashes.use(where, "gives the option", key.option);
    }
    for (const Wanted& wanted : plan.results) clashes.column("result." + wanted.name, wanted.name);
    return std::move(clashes.found);
}

}  // namespace pliant::study
