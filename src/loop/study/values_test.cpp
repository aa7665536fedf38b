#include "loop/study/values.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::study;

namespace {

struct Read {
    Choice choice;
    std::string problems;
};

Read read(const std::string& text) {
    const auto document = config::parse("[key]\n" + text, "s.toml");
    REQUIRE(document);
    config::Problems problems("s.toml");
    config::Reader root(document->root, problems);
    config::Reader table = root.table("key");
    Read found{read_choice(table), ""};
    table.finish();
    if (const Status status = problems.status(); !status) found.problems = status.error().message;
    return found;
}

std::vector<std::string> levels(const std::string& text) {
    const Read found = read(text);
    REQUIRE(found.problems == "");
    return levels_of(found.choice);
}

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("numbers with units are read") {
    const auto measure = [](std::string_view text) {
        const auto found = read_measure(text);
        REQUIRE(found);
        return std::pair(found->number, found->unit);
    };
    CHECK(measure("12.5 MPa") == std::pair(12.5, std::string("MPa")));
    CHECK(measure(" -3e-2mm ") == std::pair(-0.03, std::string("mm")));
    CHECK(measure("+7") == std::pair(7.0, std::string()));
    CHECK(measure("1040 kg/m^3") == std::pair(1040.0, std::string("kg/m^3")));
    for (const char* text : {"", "neo-hookean", "1.2.3", "1, 2", "[1, 2]", "nan", "inf", "3 mm long", "2026-01-01",
                             "30A", "3D", "1/2", "0x10", "5%", "10mm.stl"}) {
        CAPTURE(text);
        CHECK_FALSE(read_measure(text));
    }
}

TEST_CASE("levels include both ends, with equal steps or equal ratios") {
    CHECK(levels("range = [0, 1]\nlevels = 5") == Texts{"0", "0.25", "0.5", "0.75", "1"});
    CHECK(levels("range = [\"1 MPa\", \"100 MPa\"]\nscale = \"log\"\nlevels = 3") == Texts{"1", "10", "100"});
    CHECK(levels("range = [2, 5]\nwhole = true") == Texts{"2", "3", "4", "5"});
    CHECK(levels("range = [2, 5]\nwhole = true\nlevels = 2") == Texts{"2", "5"});
    CHECK(levels("values = [\"yeoh\", \"neo-hookean\"]") == Texts{"yeoh", "neo-hookean"});
    CHECK(levels("range = [0, 1]").empty());
}

TEST_CASE("listed numbers of one unit are numeric; others are words") {
    const Read one = read("values = [\"5 MPa\", \"12 MPa\"]");
    CHECK(one.choice.unit == "MPa");
    CHECK(one.choice.numeric);
    CHECK(one.choice.values == Texts{"5", "12"});
    const Read written = read("values = [\"001\", \"1e3\", \"+7\"]");
    CHECK(written.choice.numeric);
    CHECK(written.choice.values == Texts{"001", "1e3", "+7"});
    const Read joined = read("values = [\"5.0mm\", \"6.0mm\"]");
    CHECK(joined.choice.values == Texts{"5.0", "6.0"});
    CHECK(joined.choice.unit == "mm");
    CHECK(joined.choice.gap == "");
    const Read words = read("values = [\"30A\", \"50A\"]");
    CHECK_FALSE(words.choice.numeric);
    CHECK(words.choice.unit == "");
    CHECK(words.choice.values == Texts{"30A", "50A"});
    const Read mixed = read("values = [\"5 MPa\", \"12 kPa\", true]");
    CHECK_FALSE(mixed.choice.numeric);
    CHECK(mixed.choice.values == Texts{"5 MPa", "12 kPa", "true"});
}

TEST_CASE("listed values and whole numbers are all equally likely") {
    const Choice words = read("values = [\"a\", \"b\", \"c\"]").choice;
    CHECK(value_at(words, 0) == "a");
    CHECK(value_at(words, 0.34) == "b");
    CHECK(value_at(words, 0.999999) == "c");
    const Choice whole = read("range = [1, 4]\nwhole = true").choice;
    CHECK(value_at(whole, 0.249) == "1");
    CHECK(value_at(whole, 0.25) == "2");
    CHECK(value_at(whole, 0.999999) == "4");
}

TEST_CASE("mistakes in a range are reported") {
    CHECK(read("range = [2, 1]").problems == "s.toml:2: key.range: is empty: 2 is not below 1");
    CHECK(read("range = [\"1 MPa\", \"2 kPa\"]").problems ==
          "s.toml:2: key.range: its ends have the units \"MPa\" and \"kPa\"; write both in one unit");
    CHECK(read("range = [1]").problems.find("must be two numbers") != std::string::npos);
    CHECK(read("range = [\"soft\", \"hard\"]").problems.find("must be two numbers") != std::string::npos);
    CHECK(read("range = [-1, 1]\nscale = \"log\"").problems.find("\"log\" needs a range above zero") !=
          std::string::npos);
    CHECK(read("range = [0.5, 3]\nwhole = true").problems.find("of whole numbers must begin and end with one") !=
          std::string::npos);
    CHECK(read("range = [0, 1]\nvalues = [1]").problems.find("both range and values") != std::string::npos);
    CHECK(read("unit = \"MPa\"").problems.find("needs a range") != std::string::npos);
    CHECK(read("range = [0, 1]\nlevels = 1").problems.find("must be from 2 to") != std::string::npos);
    CHECK(read("range = [0, 1]\nlevel = 3").problems.find("did you mean \"levels\"?") != std::string::npos);
    CHECK(read("values = []").problems.find("must be a list of values") != std::string::npos);
}
