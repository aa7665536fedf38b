#include "loop/study/clashes.hpp"

#include <doctest/doctest.h>

using namespace pliant::study;

namespace {

std::vector<Clash> found(std::vector<Key> keys, std::vector<Wanted> results) {
    Plan plan;
    plan.keys = std::move(keys);
    plan.results = std::move(results);
    return clashes(plan);
}

}  // namespace

TEST_CASE("names that would be two columns of results.csv clash") {
    const std::vector<Key> keys{{"pull", "a", "", "N"}, {"law", "b", "", ""}};
    CHECK(found(keys, {{"tension", "t"}, {"pulled", "p"}}).empty());
    const auto same = found(keys, {{"pull", "t"}});
    REQUIRE(same.size() == 1);
    CHECK(same[0].where == "result.pull");
    CHECK(same[0].message == "is the name of key.pull too; in results.csv every column needs a name of its own");
    CHECK(found(keys, {{"pull (N)", "t"}}).size() == 1);  // as the column of the key is titled
    for (const char* reserved : {"row", "status", "reason"}) {
        CAPTURE(reserved);
        CHECK(found({{reserved, "a", "", ""}}, {}).size() == 1);
        const auto result = found(keys, {{reserved, "t"}});
        REQUIRE(result.size() == 1);
        CHECK(result[0].message.find("is the name of a column that every results.csv has") != std::string::npos);
    }
}

TEST_CASE("keys that set the same thing clash") {
    const auto set = found({{"a", "mesh.size", "", "mm"}, {"b", "mesh.size", "", "mm"}}, {});
    REQUIRE(set.size() == 1);
    CHECK(set[0].where == "key.b");
    CHECK(set[0].message == "sets \"mesh.size\", as key.a does; only one of them may");
    CHECK(found({{"a", "", "--layer", "um"}, {"b", "", "--layer", ""}}, {}).size() == 1);
    CHECK(
        found({{"a", "", "", ""}, {"b", "", "", ""}, {"c", "--layer", "", ""}, {"d", "", "--layer", ""}}, {}).empty());
}
