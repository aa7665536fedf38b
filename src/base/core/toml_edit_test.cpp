#include "base/core/toml_edit.hpp"

#include <doctest/doctest.h>

#include "base/core/config_text.hpp"
#include "base/core/test_text.hpp"

using namespace pliant;
using config::with_entry;
using config::with_value;
using pliant::test::holds;

namespace {

constexpr const char* robot = R"(name = "größe"  # a name with more bytes than letters
[parameters]  # numbers
notches = 4   # how many
"odd key" = 1

[material.soft]
youngs_modulus = "1 MPa"  # measured
material_note = { a = 1, b = [2, 3] }
[material]
stiff = { youngs_modulus = "9 MPa" }

# the first one
[[cable]]
name = "flexor"
points = [[0, 1, 2],
          [3, 4, 5]]   # two lines
target = { length_ratio = 0.8 }

[[cable]]
name = "other"
[cable.target]
tension = "1 N"
# the end
)";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
    const std::size_t at = text.find(what);
    REQUIRE(at != std::string::npos);
    return text.replace(at, what.size(), with);
}

}  // namespace

TEST_CASE("a value is replaced, and nothing else") {
    for (const auto& [path, value, what, with] :
         {std::array<const char*, 4>{"name", "\"x\"", "\"größe\"", "\"x\""},
          {"parameters.notches", "7", "= 4   #", "= 7   #"},
          {"parameters.odd key", "2.5", "key\" = 1", "key\" = 2.5"},
          {"material.soft.youngs_modulus", "\"2 MPa\"", "\"1 MPa\"", "\"2 MPa\""},
          {"material.soft.material_note.b", "[7]", "[2, 3]", "[7]"},
          {"material.stiff.youngs_modulus", "\"8 MPa\"", "\"9 MPa\"", "\"8 MPa\""},
          {"cable.flexor.target.length_ratio", "0.75", "= 0.8", "= 0.75"},
          {"cable.flexor.points", "[[1, 1, 1], [2, 2, 2]]", "[[0, 1, 2],\n          [3, 4, 5]]",
           "[[1, 1, 1], [2, 2, 2]]"},
          {"cable.1.target.tension", "\"2 N\"", "\"1 N\"", "\"2 N\""}}) {
        INFO(path);
        const auto text = with_value(robot, path, value);
        REQUIRE(text);
        CHECK(*text == replaced(robot, what, with));
    }
}

TEST_CASE("a missing value is added to its table, and the table if missing") {
    CHECK(with_value(robot, "parameters.width", "3").value() ==
          replaced(robot, "\"odd key\" = 1\n", "\"odd key\" = 1\nwidth = 3\n"));
    CHECK(with_value(robot, "material.stiff.density", "\"1 g/cm^3\"").value() ==
          replaced(robot, "\"9 MPa\" }", "\"9 MPa\", density = \"1 g/cm^3\" }"));
    CHECK(with_value(robot, "cable.flexor.friction", "0.1").value() ==
          replaced(robot, "length_ratio = 0.8 }\n", "length_ratio = 0.8 }\nfriction = 0.1\n"));
    CHECK(with_value(robot, "mesh.size", "\"2 mm\"").value() == std::string(robot) + "\n[mesh]\nsize = \"2 mm\"\n");
    CHECK(with_value("t = { b.c = [1] }  # {}\n", "t.d", "2").value() == "t = { b.c = [1], d = 2 }  # {}\n");
    CHECK(with_value("t = {}\n", "t.d", "2").value() == "t = { d = 2}\n");
    const std::string first = with_value("a = 1", "b", "2").value();
    CHECK(with_value(first, "b", "3").value() == replaced(first, "b = 2", "b = 3"));
}

TEST_CASE("a new entry is added after the last of its list, in the list's style") {
    const config::EntryText entry = {{"name", "\"tip\""}, {"point", "[1, 2, 3]"}};
    CHECK(
        with_entry(robot, "cable", entry).value() ==
        replaced(robot, "tension = \"1 N\"\n", "tension = \"1 N\"\n\n[[cable]]\nname = \"tip\"\npoint = [1, 2, 3]\n"));
    CHECK(with_entry(robot, "marker", entry).value() ==
          std::string(robot) + "\n[[marker]]\nname = \"tip\"\npoint = [1, 2, 3]\n");
    CHECK(with_entry("m = [{ name = \"a\" }]  # one\n", "m", entry).value() ==
          "m = [{ name = \"a\" }, { name = \"tip\", point = [1, 2, 3] }]  # one\n");
    CHECK(with_entry("m = [\n  { name = \"a\" } # the [first]\n]\n", "m", entry).value() ==
          "m = [\n  { name = \"a\" }, { name = \"tip\", point = [1, 2, 3] } # the [first]\n]\n");
    CHECK(with_entry("m = [\n  { name = \"größe\" }, # one\n  # two\n]\n", "m", entry).value() ==
          "m = [\n  { name = \"größe\" }, { name = \"tip\", point = [1, 2, 3] }, # one\n  # two\n]\n");
    CHECK(with_entry("m = [ # none, yet ]\n]\n", "m", entry).value() ==
          "m = [ { name = \"tip\", point = [1, 2, 3] } # none, yet ]\n]\n");
    CHECK(with_entry("m = []\n", "m", entry).value() == "m = [ { name = \"tip\", point = [1, 2, 3] }]\n");
}

TEST_CASE("a key beside one that is written with dots is written with dots too") {
    const std::string text = "[[cable]]\nname = \"a\"\ntarget.tension = 5\nfriction = 1\n";
    CHECK(with_value(text, "cable.a.target.offset", "2").value() == replaced(text, "= 5", "= 5\ntarget.offset = 2"));
    CHECK(with_value("m.soft.a = 1\n", "m.soft.b", "2").value() == "m.soft.a = 1\nm.soft.b = 2\n");
    CHECK(with_value("[m.soft]\na = 1\n", "m.soft.b", "2").value() == "[m.soft]\na = 1\nb = 2\n");
}

TEST_CASE("a table that has no header of its own gets one") {
    CHECK(with_value("a = 1\n\n[[program.key]]\ntime = 1\n", "program.steps", "3").value() ==
          "a = 1\n\n[program]\nsteps = 3\n\n[[program.key]]\ntime = 1\n");
    CHECK(with_value("[a.b.c]\nd = 1\n[e]\nf = 1\n", "a.b.g", "2").value() ==
          "[a.b]\ng = 2\n\n[a.b.c]\nd = 1\n[e]\nf = 1\n");
    CHECK(with_value("[[body]]\nname = \"b\"\n[body.\"v 1.2\".c]\nd = 1\n", "body.b.\"v 1.2\".e", "2").value() ==
          "[[body]]\nname = \"b\"\n[body.\"v 1.2\"]\ne = 2\n\n[body.\"v 1.2\".c]\nd = 1\n");
    CHECK(with_value("[a.b]\nc = 1\n[a]\nd = 1\n", "a.e", "2").value() == "[a.b]\nc = 1\n[a]\nd = 1\ne = 2\n");
    const std::string renamed = with_value(robot, "cable.other.name", "\"third\"").value();
    CHECK(renamed == replaced(robot, "\"other\"", "\"third\""));
}

TEST_CASE("a byte order mark stays where it is and is no column") {
    const std::string mark = "\xEF\xBB\xBF";
    CHECK(with_value(mark + "program.steps =50\n", "program.steps", "7").value() == mark + "program.steps =7\n");
    CHECK(with_value(mark + "[a]\nb = 1\n", "c", "2").value() == mark + "c = 2\n[a]\nb = 1\n");
    CHECK(with_entry(mark + "m = []\n", "m", {{"a", "1"}}).value() == mark + "m = [ { a = 1 }]\n");
}

TEST_CASE("names with dots are parts of a path in quotes") {
    const std::string text =
        "[material.\"ecoflex 00.30\"]\ndensity = 1\n\n[[body]]\nname = \"finger v1.2\"\nmaterial = \"a\"\n";
    CHECK(with_value(text, R"(body."finger v1.2".material)", R"("ecoflex 00.30")").value() ==
          replaced(text, "\"a\"", "\"ecoflex 00.30\""));
    CHECK(with_value(text, "material.'ecoflex 00.30'.density", "2").value() == replaced(text, "= 1", "= 2"));
    CHECK(holds(with_value(text, "material.ecoflex 00.30.density", "2").error().message, "no \"ecoflex 00\""));
    CHECK(with_value("a = 1\n", R"(m."x.y")", "2").value() == "a = 1\n\n[m]\n\"x.y\" = 2\n");
    for (const char* name : {"plain", "v1.2", "\"", "'a'", "a\\.b", "5\" wide.2", ""}) {
        CAPTURE(name);
        const std::string path = "a." + config::path_part(name) + ".b";
        CHECK(config::path_parts(path) == std::vector<std::string>{"a", name, "b"});
    }
    CHECK(config::path_parts("\"a.b") == std::vector<std::string>{"\"a", "b"});
}

TEST_CASE("entries of lists are found by an index in brackets, and what is not there is refused") {
    CHECK(with_value(robot, "cable[0].target.length_ratio", "0.75").value() == replaced(robot, "= 0.8", "= 0.75"));
    CHECK(with_value(robot, "cable[1].target.tension", "\"2 N\"").value() == replaced(robot, "\"1 N\"", "\"2 N\""));
    CHECK(with_value(robot, "cable.flexor.points[1][2]", "7").value() == replaced(robot, "[3, 4, 5]", "[3, 4, 7]"));
    CHECK(with_value(robot, "cable[0].friction", "0.1").value() ==
          with_value(robot, "cable.0.friction", "0.1").value());
    CHECK(with_value("m = [{ name = \"a[0]\", b = 1 }]\n", "m.a[0].b", "2").value() ==
          "m = [{ name = \"a[0]\", b = 2 }]\n");
    for (const char* path :
         {"cable[2].friction", "cable[-1].friction", "cable[].friction", "cabel[0].friction", "cable[0].points[5]",
          "cable[0].pull[0]", "parameters[width]", "new[0]", "new.part[0]", "cable[0][1].friction", "[0]"}) {
        CAPTURE(path);
        const auto text = with_value(robot, path, "1");
        REQUIRE_FALSE(text);
        CHECK(holds(text.error().message, "there is no \""));
    }
}

TEST_CASE("invalid edits are refused with a reason") {
    const auto why = [](const Result<std::string>& text) {
        REQUIRE_FALSE(text);
        return text.error().message;
    };
    CHECK(holds(why(with_value("a = ", "a", "1")), "not valid TOML"));
    CHECK(holds(why(with_value(robot, "name", "one two")), "not a TOML value"));
    CHECK(holds(why(with_value(robot, "name", "1\nb = 2")), "not a TOML value"));
    CHECK(holds(why(with_value(robot, "cable.nobody.friction", "1")), "there is no \"nobody\""));
    CHECK(holds(why(with_value(robot, "name.first", "1")), "\"name\" is not a table"));
    CHECK(holds(why(with_value(robot, "material.none.density", "1")), "there is no \"none\""));
    CHECK(holds(why(with_value(robot, "parameters", "1")), "is a table"));
    CHECK(holds(why(with_value(robot, "cable", "1")), "is a list of tables"));
    CHECK(holds(why(with_entry(robot, "name", {{"a", "1"}})), "is not a list"));
}
