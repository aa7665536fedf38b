#include "base/core/csv.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace pliant;

namespace {

std::string error_of(const std::string& text) {
    const auto table = parse_csv(text, "a.csv", "x,y");
    if (!table) return table.error().message;
    const auto value = table->number(table->rows.back(), 1, "y");
    return value ? "" : value.error().message;
}

}  // namespace

TEST_CASE("separators, quotes, comments and the lines that messages name") {
    const auto table = parse_csv("\xEF\xBB\xBF\"# made\"\n\n\"x, or so\"; y (mm)\r\n1;+2.5\r\n\n3;4\r\n", "a.csv", "");
    REQUIRE(table);
    CHECK(table->columns == std::vector<std::string>{"x, or so", "y (mm)"});
    REQUIRE(table->rows.size() == 2);
    CHECK(table->rows[1].line == 6);
    CHECK(table->number(table->rows[0], 1, "y").value() == 2.5);
    CHECK(csv_unit(table->columns[1]) == "mm");
    CHECK(csv_unit("force [N]") == "N");
    CHECK(csv_unit("force )N(").empty());
    CHECK(csv_unit("force").empty());
    for (const auto& [column, name, unit] : {std::array<const char*, 3>{"cable[0].target.length_ratio", "", ""},
                                             {"object[0]", "", ""},
                                             {"object[0].mass (g)", "object[0].mass", "g"},
                                             {"softness ( MPa ) ", "softness", "MPa"},
                                             {"force[N]", "force", "N"},
                                             {"strain [%]", "strain", "%"},
                                             {"a (b) c", "", ""},
                                             {"f(x) (N/(mm s))", "f(x)", "N/(mm s)"},
                                             {"force ()", "", ""}}) {
        CAPTURE(column);
        CHECK(without_csv_unit(column) == (*name == '\0' ? column : name));
        CHECK(csv_unit(column) == unit);
    }
    const auto quoted = parse_csv("\"tip, or \"\"end\"\"_x_mm\",y\n1,\"2\"\n\"3,4\n", "a.csv", "");
    CHECK(quoted->columns == std::vector<std::string>{"tip, or \"end\"_x_mm", "y"});
    CHECK(quoted->number(quoted->rows[0], 1, "y").value() == 2);
    CHECK(quoted->rows[1].cells.size() == 1);  // a quote that never closes
    CHECK(parse_csv("a\tb,c\n1\t2", "a.csv", "")->columns.size() == 2);
}

TEST_CASE("rows whose cells are all empty, as spreadsheets write them, are passed over") {
    const auto table = parse_csv(",,\nx,y,z\n1,2,3\n,,\n \t, \"\" ,\n4,5,6\n,,,\n", "t.csv", "x,y,z");
    REQUIRE(table);
    CHECK(table->columns == std::vector<std::string>{"x", "y", "z"});
    CHECK(table->header_line == 2);
    REQUIRE(table->rows.size() == 2);
    CHECK(table->rows[1].line == 6);
    CHECK(table->number(table->rows[1], 2, "z") == 6);
    CHECK_FALSE(parse_csv("x,y,z\n,,\n", "t.csv", "x,y,z"));
}

TEST_CASE("errors in a table name file and line") {
    CHECK(error_of("") == "a.csv: is empty; the first line names the columns: x,y");
    CHECK(error_of("x,y\n# none\n") == "a.csv: has no rows below the names of the columns");
    CHECK(error_of("x,y\n1,2\n3\n") == "a.csv:3: 1 columns, but the first line names more");
    CHECK(error_of("x,y\n1,2\n3,5,4\n") == "a.csv:3: 3 columns, the first line names 2");
    CHECK(error_of("x,y\n1,2,,\n").empty());  // as spreadsheets leave them
    CHECK(error_of("x;y\n1;2,5\n") == "a.csv:2: y \"2,5\" has a comma; write numbers with a decimal point");
    for (const char* bad : {"abc", "nan", "inf", "1e999", "", "1 2", "0x10", "+-5", "++5", "+"})
        CHECK(error_of(std::string("x,y\n1,") + bad + "\n") ==
              std::string("a.csv:2: y \"") + bad + "\" is not a number");
}

TEST_CASE("fields are quoted as RFC 4180 says, and never start a formula") {
    CHECK(csv_field("plain name") == "plain name");
    CHECK(csv_field("a,b") == "\"a,b\"");
    CHECK(csv_field("say \"x\"") == "\"say \"\"x\"\"\"");
    CHECK(csv_field("two\nlines") == "\"two\nlines\"");
    CHECK(csv_field("=1+1") == "'=1+1");
    CHECK(csv_field("") == "");
}

TEST_CASE("a name that was kept from being a formula is found again") {
    for (const char* const name : {"=1+1", "-tip_x_mm", "+a", "@b", "plain", "'quoted'", ""})
        CHECK(csv_name(csv_field(name)) == name);
}
