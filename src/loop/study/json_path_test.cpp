#include "loop/study/json_path.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

using namespace pliant;
using namespace pliant::study;

namespace {

const nlohmann::json& sample() {
    static const auto json = nlohmann::json::parse(R"({
        "converged": true, "nodes": 12, "robot": "bar", "energy": null,
        "steps": [{"cables": {"flexor": {"tension_N": 1.5}}, "markers": {"tip": [1, 2, 3]}},
                  {"cables": {"flexor": {"tension_N": 2.5}, "left one": {"tension_N": 4}}, "markers": {"tip": [4, 5, 6]}}]})");
    return json;
}

double number(std::string_view path) {
    const auto parsed = JsonPath::parse(path);
    REQUIRE_MESSAGE(parsed, (parsed ? "" : parsed.error().message));
    const auto found = parsed->number_in(sample());
    REQUIRE_MESSAGE(found, (found ? "" : found.error().message));
    return *found;
}

std::string path_mistake(std::string_view path) {
    const auto parsed = JsonPath::parse(path);
    if (!parsed) return parsed.error().message;
    const auto found = parsed->number_in(sample());
    return found ? "" : found.error().message;
}

}  // namespace

TEST_CASE("keys, indices, and indices from the end") {
    CHECK(number("nodes") == 12);
    CHECK(number("steps[0].cables.flexor.tension_N") == 1.5);
    CHECK(number("steps[-1].cables.flexor.tension_N") == 2.5);
    CHECK(number("steps[-2].markers.tip[2]") == 3);
    CHECK(number("steps[1].cables[\"left one\"].tension_N") == 4);
}

TEST_CASE("a path that is not found at the top is looked up in the last step") {
    CHECK(number("markers.tip[2]") == 6);
    CHECK(number("cables.flexor.tension_N") == 2.5);
}

TEST_CASE("true is 1, null is not a number") {
    CHECK(number("converged") == 1);
    CHECK(std::isnan(number("energy")));
}

TEST_CASE("a missing path is reported with the keys that exist") {
    CHECK(path_mistake("cables.flexr.tension_N") ==
          "steps[-1].cables has no \"flexr\"; did you mean \"flexor\"?: there is flexor and left one");
    CHECK(path_mistake("steps[2].markers") == "steps has no [2]: it is a list of 2, [0] to [1]");
    CHECK(path_mistake("markers.tip") == "steps[-1].markers.tip is not a number: it is a list of 3, [0] to [2]");
    CHECK(path_mistake("robot") == "robot is not a number: it is a text");
    CHECK(path_mistake("nodes.more") == "nodes has no \"more\": there is a single value");
    CHECK(path_mistake("tension") ==
          "the result has no \"tension\": there is converged, energy, nodes, robot and steps");
}

TEST_CASE("an invalid path is reported with the position") {
    CHECK(path_mistake("").starts_with("\"\": a key is missing at letter 1"));
    CHECK(path_mistake("steps.").starts_with("\"steps.\": a key is missing at letter 7"));
    CHECK(path_mistake("steps[x]").starts_with("\"steps[x]\": a whole number and ] are expected at letter 7"));
    CHECK(path_mistake("steps[1").starts_with("\"steps[1\": a whole number and ]"));
    CHECK(path_mistake("steps[1]x").starts_with("\"steps[1]x\": a dot or [ is expected at letter 9"));
    CHECK(path_mistake("a..b").starts_with("\"a..b\": a key is expected at letter 3"));
    CHECK(path_mistake(std::string(2000, 'a')).starts_with("a path of 2000 letters"));
}
