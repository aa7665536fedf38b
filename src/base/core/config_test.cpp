#include "base/core/config.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::config;

namespace {

Document document_of(std::string_view text) {
    Result<Document> document = parse(text, "test.toml");
    REQUIRE_MESSAGE(document, (document ? "" : document.error().message));
    return *document;
}

std::string message(const Problems& problems) {
    const Status status = problems.status();
    return status ? "" : status.error().message;
}

}  // namespace

TEST_CASE("values of every type are read") {
    const Document document = document_of(R"(
name = "finger"
count = 3
size = "2.5 mm"
flag = true
point = [1, 2.5, -3]
path = [[0, 0, 0], [1, 1, 1]]
[material.soft]
density = "1 g/cm^3"
[[body]]
name = "a"
[[body]]
name = "b"
)");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    CHECK(root.text("name") == "finger");
    CHECK(root.integer("count") == 3);
    CHECK(root.quantity("size", Dimension::length) == near(2.5e-3, {.relative = 1e-12}));
    CHECK(root.boolean("flag", false));
    CHECK(root.vector("point") == Vec3{1, 2.5, -3});
    CHECK(root.vectors("path").size() == 2);
    auto materials = root.named_tables("material");
    REQUIRE(materials.size() == 1);
    CHECK(materials[0].first == "soft");
    CHECK(materials[0].second.quantity("density", Dimension::density) == near(1000, {.relative = 1e-12}));
    auto bodies = root.tables("body");
    REQUIRE(bodies.size() == 2);
    CHECK(bodies[1].text("name") == "b");
    CHECK(root.number("missing", 7) == 7);
    root.finish();
    CHECK(message(problems).empty());
}

TEST_CASE("a value of another type is shown as the file has it") {
    const Document document = document_of(R"(
name = 5
kind = true
count = 2.5
share = nan
width = "wide"
size = {}
note = ["a", 7]
sides = ["1 mm", 2]
)");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    (void)root.text("name");
    (void)root.choice("kind", {"a", "b"});
    (void)root.integer("count");
    (void)root.number("share");
    (void)root.number("width");
    (void)root.number("size");
    (void)root.texts("note");
    (void)root.quantities("sides", Dimension::length, 2);
    CHECK(message(problems) ==
          "test.toml:2: name: is 5, a text in quotes is needed\n"
          "test.toml:3: kind: is true, a text in quotes is needed\n"
          "test.toml:4: count: is 2.5, a whole number is needed\n"
          "test.toml:5: share: is nan, a finite number is needed\n"
          "test.toml:6: width: is \"wide\", a finite number is needed\n"
          "test.toml:7: size: is a table, a finite number is needed\n"
          "test.toml:8: note: holds 7, only texts are allowed\n"
          "test.toml:9: sides: entry 2 has no unit; write a length such as \"2.5 mm\"");
}

TEST_CASE("a value that cannot be read gives one message: nothing is said of what stands for it") {
    const Document document = document_of(R"(
mass = "1 mg"
limits = ["a", "b"]
sides = [1, 2]
place = 7
move = { by = "far" }
odd = 3
)");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    if (!(root.quantity("mass", Dimension::mass) > 0)) root.problem("mass", "must be above zero");
    if (root.numbers("limits", 2)[0] == 0) root.problem("limits", "are empty");
    (void)root.quantities("sides", Dimension::length, 2);
    if (root.numbers("curve", 3)[0] == 0) root.problem("curve", "must rise");
    (void)root.table("place").vector("point");
    if (root.table("move").number("by") == 0) root.problem("move", "must not be zero");
    root.problem("odd", "goes with even");
    for (const char* key : {"mass", "limits", "sides", "curve", "place", "move"}) CHECK(root.unreadable(key));
    CHECK_FALSE(root.unreadable("odd"));
    root.finish();
    CHECK(message(problems) ==
          "test.toml:1: \"curve\" is missing; it is a list of numbers\n"
          "test.toml:2: mass: unknown unit \"mg\"; here the units are kg, g\n"
          "test.toml:3: limits: needs a list of 2 finite numbers\n"
          "test.toml:4: sides: entry 1 has no unit; write a length such as \"2.5 mm\"\n"
          "test.toml:5: place: is 7, a table is needed\n"
          "test.toml:6: move.by: is \"far\", a finite number is needed\n"
          "test.toml:7: odd: goes with even");
}

TEST_CASE("two things that are wrong with a value that was read are both said") {
    const Document document = document_of("limits = [3, 1]\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    (void)root.numbers("limits", 2);
    root.problem("limits", "the lower one stands first");
    root.problem("limits", "must hold 0");
    CHECK(message(problems) == "test.toml:1: limits: the lower one stands first\ntest.toml:1: limits: must hold 0");
}

TEST_CASE("a whole number outside its range is a problem, also where it is too large for 32 bits") {
    const Document document = document_of("lines = 4294967298\nlayers = -1\norder = 2\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    CHECK(root.whole("lines", 1, 4) == 4);
    CHECK(root.whole("layers", 0, 10, 3) == 0);
    CHECK(root.whole("order", 1, 2, 1) == 2);
    CHECK(root.whole("none", 1, 5, 4) == 4);
    CHECK(root.whole("needed", 1, 5) == 1);
    CHECK(message(problems) ==
          "test.toml:1: lines: is 4294967298, must be from 1 to 4\n"
          "test.toml:1: \"needed\" is missing; it is a whole number\n"
          "test.toml:2: layers: is -1, must be from 0 to 10");
}

TEST_CASE("an unread key is an error that names the line and the nearest key") {
    const Document document = document_of("name = \"x\"\n\ngeometri = 3\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    (void)root.text("name");
    (void)root.text("geometry", "");
    root.finish();
    CHECK(message(problems) == "test.toml:3: geometri: unknown key; did you mean \"geometry\"?");
}

TEST_CASE("wrong types and missing keys give one line each") {
    const Document document = document_of("size = 3\npoint = [1, 2]\ncount = 2.5\n[table]\nlaw = \"neohookean\"\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    (void)root.quantity("size", Dimension::length);
    (void)root.vector("point");
    (void)root.integer("count");
    Reader table = root.table("table");
    CHECK(table.choice("law", {"neo-hookean", "shape-blend"}) == "neo-hookean");
    (void)root.text("name");
    (void)root.table("size", false).text("x", "");
    const std::string text = message(problems);
    CAPTURE(text);
    CHECK(text.find("test.toml:1: size: 3 has no unit; write a length such as \"2.5 mm\"") != std::string::npos);
    CHECK(text.find("test.toml:2: point: needs three finite numbers") != std::string::npos);
    CHECK(text.find("test.toml:3: count:") != std::string::npos);
    CHECK(text.find("test.toml:5: table.law: \"neohookean\" is not known, did you mean \"neo-hookean\"?") !=
          std::string::npos);
    CHECK(text.find("\"name\" is missing") != std::string::npos);
}

TEST_CASE("invalid TOML is reported with its line") {
    const auto result = parse("a = 1\nb = = 2\n", "robot.toml");
    REQUIRE_FALSE(result);
    CHECK(result.error().message.find("robot.toml:2:") == 0);
    CHECK_FALSE(parse(std::string(100000, '['), "deep.toml"));
    CHECK_FALSE(parse("a = " + std::string(10000, '[') + std::string(10000, ']'), "deep.toml"));
}

TEST_CASE("--set changes any value, and an unknown key gives the nearest one") {
    Document document =
        document_of("[program]\nsteps = 30\n[[cable]]\nname = \"flexor\"\ntarget = { length_ratio = 0.7 }\n");
    REQUIRE(set(document, "program.steps=5"));
    REQUIRE(set(document, "cable.flexor.target.length_ratio=0.9"));
    REQUIRE(set(document, " program.solver = newton "));
    Problems problems("test.toml");
    Reader root(document.root, problems);
    Reader program = root.table("program");
    CHECK(program.integer("steps") == 5);
    CHECK(program.text("solver") == "newton");
    CHECK(root.tables("cable").at(0).table("target").number("length_ratio") == 0.9);
    CHECK(set(document, "cable.flexxor.target=1").error().message.find("did you mean \"flexor\"?") !=
          std::string::npos);
    REQUIRE(set(document, "new.table.key=1"));
    CHECK_FALSE(set(document, "steps"));
    CHECK_FALSE(set(document, "program..steps=1"));
}

TEST_CASE("--set takes an entry of a list as messages write it") {
    Document document = document_of("[[cable]]\nname = \"flexor\"\npoints = [[0, 0, 0], [1, 0, 0]]\n");
    REQUIRE(set(document, "cable[0].points[1][2]=5"));
    REQUIRE(set(document, "cable[flexor].friction=0.5"));
    Problems problems("test.toml");
    Reader cable = Reader(document.root, problems).tables("cable").at(0);
    CHECK(cable.vectors("points").at(1) == Vec3{1, 0, 5});
    CHECK(cable.number("friction") == 0.5);
    CHECK(problems.empty());
    CHECK(set(document, "cable[1].friction=0.5")
              .error()
              .message.starts_with("--set cable[1].friction: there is no \"cable[1]\" in test.toml"));
}

TEST_CASE("all within a value of --set stands on the line of what it replaces") {
    Document document = document_of("steps = 30\n\ncable = 2\n");
    REQUIRE(set(document, "cable=[{ name = \"flexor\" }]"));
    const Value& cable = std::get<Table>(document.root.data).at(1).second;
    const Value& first = std::get<Array>(cable.data).at(0);
    CHECK(cable.line == 3);
    CHECK(first.line == 3);
    CHECK(std::get<Table>(first.data).at(0).second.line == 3);
    REQUIRE(set(document, "spring=[{ name = \"band\" }]"));
    CHECK(std::get<Array>(std::get<Table>(document.root.data).at(2).second.data).at(0).line == 0);
}

TEST_CASE("parameters may be used in formulas") {
    Document document =
        document_of("[parameters]\ngaps = 6\npitch = \"= 84 / gaps\"\n[a]\nx = [\"= pitch * 2\", 1]\nn = \"= gaps\"\n");
    REQUIRE(set(document, "parameters.gaps=4"));
    REQUIRE(resolve_parameters(document));
    Problems problems("test.toml");
    Reader root(document.root, problems);
    Reader a = root.table("a");
    CHECK(a.numbers("x") == std::vector<double>{42, 1});
    CHECK(a.integer("n") == 4);
    root.finish();
    CHECK(problems.empty());

    Document bad = document_of("[parameters]\na = \"= b + 1\"\n");
    CHECK(resolve_parameters(bad).error().message.find("test.toml:2:") == 0);
}

TEST_CASE("a formula that names what is no parameter says where it stands and what would be right") {
    const auto refused = [](const std::string& text) {
        Document document = document_of(text);
        return resolve_parameters(document).error().message;
    };
    CHECK(refused("[parameters]\nhalf = \"= pitch / 2\"\npitch = 8\n") ==
          "test.toml:2: parameters.half: \"= pitch / 2\": \"pitch\" is defined below; a formula may use the parameters "
          "above it");
    CHECK(refused("[parameters]\npitch = \"= pitch + 1\"\n") ==
          "test.toml:2: parameters.pitch: \"= pitch + 1\": \"pitch\" is what is defined here");
    CHECK(refused("[parameters]\npitch = 8\n[[body]]\nat = [1, \"= ptch / 2\"]\n") ==
          "test.toml:4: body[0].at[1]: \"= ptch / 2\": there is no parameter \"ptch\"; did you mean \"pitch\"?");
}

TEST_CASE("a formula with a decimal comma, or with several values, is refused") {
    const auto refused = [](const std::string& text) {
        Document document = document_of(text);
        return resolve_parameters(document).error().message;
    };
    CHECK(refused("x = [\"= 100,5\", 10]\n") == "test.toml:1: x[0]: \"= 100,5\" has a decimal comma; write a point");
    CHECK(refused("[parameters]\na = \"= 1,5 * 2\"\n") ==
          "test.toml:2: parameters.a: \"= 1,5 * 2\" has a decimal comma; write a point");
    CHECK(refused("[parameters]\na = 1\n[body]\nx = \"= a, 2\"\n") ==
          "test.toml:4: body.x: \"= a, 2\" has several values; one is needed");
    Document document = document_of("x = \"= max(1,5) + min(2, 3)\"\n");
    REQUIRE(resolve_parameters(document));
    CHECK(std::get<double>(std::get<Table>(document.root.data).front().second.data) == 7);
}

TEST_CASE("the beginning of one known key is taken for that key") {
    Document document = document_of("fix = 1\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    CHECK(root.number("fixed", 0.0) == 0);
    CHECK(root.number("body", 0.0) == 0);
    root.finish();
    CHECK(message(problems) == "test.toml:1: fix: unknown key; did you mean \"fixed\"?");
}

TEST_CASE("parameters on one line are defined in the order in which they are written") {
    Document document =
        document_of("parameters = { width = 10, half = \"= width / 2\", a = \"= half / 5\" }\nx = \"= a\"\n");
    REQUIRE(resolve_parameters(document));
    Problems problems("test.toml");
    Reader root(document.root, problems);
    CHECK(root.number("x") == 1);
}

TEST_CASE("a missing table is one error, not one per key, and long lists of errors are cut") {
    const Document document =
        document_of("a = 1\nb = 1\nc = 1\nd = 1\ne = 1\nf = 1\ng = 1\nh = 1\ni = 1\nj = 1\nk = 1\nl = 1\nm = 1\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    Reader axis = root.table("axis").table("x");
    (void)axis.text("letter");
    (void)axis.number("speed");
    axis.problem("speed", "must be above zero");
    CHECK(message(problems) == "test.toml:1: \"axis\" is missing; it is a table");
    root.finish();
    CHECK(message(problems).find("test.toml: and 2 problems more") != std::string::npos);
}

TEST_CASE("an error carries file, line and key as data, and shows them in its message") {
    const Document document = document_of("a = 1\n\n[axis]\nspeed = \"fast\"\n");
    Problems problems("test.toml");
    Reader root(document.root, problems);
    (void)root.integer("a");
    (void)root.table("axis").number("speed");
    const Status status = problems.status();
    REQUIRE_FALSE(status);
    REQUIRE(status.error().problems.size() == 1);
    const Diagnostic& problem = status.error().problems.front();
    CHECK(problem.file == "test.toml");
    CHECK(problem.line == 4);
    CHECK(problem.key == "axis.speed");
    CHECK(shown(problem) == status.error().message);
    CHECK(shown({"a.stl", 0, "", "is empty"}) == "a.stl: is empty");
    CHECK(shown({"", 7, "body \"tip\"", "is empty"}) == "body \"tip\": is empty");

    const auto broken = parse("a = 1\nb = = 2\n", "broken.toml");
    REQUIRE_FALSE(broken);
    REQUIRE(broken.error().problems.size() == 1);
    CHECK(broken.error().problems.front().file == "broken.toml");
    CHECK(broken.error().problems.front().line == 2);
}

TEST_CASE("a file that is not UTF-8 but UTF-16 or UTF-32 is told from one that is damaged") {
    using namespace std::string_literals;
    for (const std::string& text : {"\xff\xfe"s + "a\0=\0"s, "\xfe\xff\0a"s, "a\0=\0"s, "\0\0\xfe\xff"s}) {
        const auto document = config::parse(text, "x.toml");
        REQUIRE_FALSE(document);
        CHECK(document.error().message ==
              "x.toml: is not UTF-8 text but looks like UTF-16 or UTF-32; save it as UTF-8");
        CHECK(parse("a = 1\nname = \"gr\xFC\x6E\"\n", "x.toml").error().message ==
              "x.toml:2: is not UTF-8 text: it has bytes of another encoding; save it as UTF-8");
    }
}
