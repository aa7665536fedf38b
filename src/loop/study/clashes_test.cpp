#include "loop/study/clashes.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

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

TEST_CASE("keys that set the same thing clash however they write it") {
    CHECK(found({{"a", "body.soft.size", "", "mm"}, {"b", "body.\"soft\".size", "", "mm"}}, {}).size() == 1);
    const pliant::test::Folder folder("clashes");
    REQUIRE(pliant::write_file(folder / "finger.toml",
                               "[[cable]]\nname = \"flexor\"\n[[cable]]\nname = \"extensor\"\n[[object]]\nmass = 1\n"));
    const auto clash = [&](const std::string& one, const std::string& other) {
        Plan plan;
        plan.folder = folder.path();
        plan.command = {"simulate", "finger.toml"};
        plan.keys = {{"a", one, "", ""}, {"b", other, "", ""}};
        const auto all = clashes(plan);
        return all.empty() ? "" : all[0].message;
    };
    CHECK(clash("cable.flexor.friction", "cable[0].friction") ==
          "sets \"cable[0].friction\", as key.a does; only one of them may");
    CHECK(clash("cable.0.friction", "cable.'flexor'.friction") != "");
    CHECK(clash("object.0.mass", "object[0].mass") != "");
    CHECK(clash("cable.1.friction", "cable.flexor.friction") == "");
    CHECK(clash("cable.flexor.friction", "cable.flexor.target.tension") == "");
    CHECK(clash("cable.flexor.target.tension", "cable[0].target.tension") != "");
}
