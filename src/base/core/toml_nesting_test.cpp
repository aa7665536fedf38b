#include "base/core/toml_nesting.hpp"

#include <doctest/doctest.h>

#include <string>

#include "base/core/config.hpp"
#include "base/core/toml_edit.hpp"

using namespace pliant;
using namespace pliant::config;

namespace {

std::string repeated(const std::string& piece, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += piece;
    return text;
}

}  // namespace

TEST_CASE("brackets and the dots of a key are counted outside strings and comments") {
    const auto check = [](std::string_view text, int brackets, int dots) {
        INFO(text);
        CHECK(nesting_of(text).brackets == brackets);
        CHECK(nesting_of(text).dots == dots);
    };
    check("", 0, 0);
    check("a.b.c = [1.5, [2.5, 3.5]] # [[[ x.y.z.u.v\n", 2, 2);
    check("[a.b]\nc = { d.e.f.g = 1 }\n", 1, 3);
    check("a = \"[[[ \\\" [[ . . .\"\nb = '[[ \\'\nc = [1]\n", 1, 0);
    check("a = \"\"\"\n[[ \\\"\"\" [[\n\"\"\"\"\nb.c = 1\n", 0, 1);
    check("a = '''[[\n.\n'''\nb = [1]\n", 1, 0);
    check("\"a.b,=\" . 'c' . d = 1\n", 0, 2);
    check("x = { s = \"\"\"\n\"\"\", a.b.c.d = 1 }\n", 1, 3);
    check("not closed = \"[[[\n[a]\n", 1, 0);
    check("\"", 0, 0);
    check("a = \"\"\"[[[", 0, 0);
    check("a = \"\\", 0, 0);
}

TEST_CASE("a small text with deep nesting is refused before it is parsed") {
    const std::string key = "a" + repeated(".a", 200'000);
    for (const std::string& text :
         {key + " = 1\n", "[" + key + "]\n", "[[" + key + "]]\n", "x = { " + key + " = 1 }\n",
          "x = { s = \"\"\"\n\"\"\", " + key + " = 1 }\n", "a = " + repeated("[", 100'000) + repeated("]", 100'000)}) {
        INFO(text.substr(0, 20));
        CHECK(nested_too_deep(text));
        CHECK(parse(text, "deep.toml").error().message == "deep.toml: keys or brackets are nested too deep");
        CHECK_FALSE(with_value(text, "name", "1"));
        CHECK_FALSE(with_entry(text, "marker", {{"name", "1"}}));
    }
    CHECK_FALSE(with_value("a = 1\n", key, "1"));
    Document document = parse("a = 1\n", "robot.toml").value();
    CHECK(set(document, "b" + key.substr(1) + "=1").error().message.ends_with("the key has too many parts"));
}
