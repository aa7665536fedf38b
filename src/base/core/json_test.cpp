#include "base/core/json.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace pliant;

TEST_CASE("JSON becomes text in which every byte is UTF-8") {
    const nlohmann::json name = {{"file", "a\xff.toml"}};
    CHECK(json_text(name) == "{\"file\":\"a\xef\xbf\xbd.toml\"}");
    CHECK(json_text(nlohmann::ordered_json{{"b", 1}, {"a", 2}}, 1) == "{\n \"b\": 1,\n \"a\": 2\n}");
}

TEST_CASE("JSON text is read, and what is no JSON is a discarded value") {
    CHECK(parse_json(R"({"b": [1, 2]})")["b"][1] == 2);
    CHECK(json_text(parse_ordered_json(R"({"b": 1, "a": 2})")) == R"({"b":1,"a":2})");
    for (const char* wrong : {"", "{", "{} {}", "nan"}) {
        CHECK(parse_json(wrong).is_discarded());
        CHECK(parse_ordered_json(wrong).is_discarded());
    }
}
