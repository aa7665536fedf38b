#include "printing/machine/define_lines.hpp"

#include <doctest/doctest.h>

#include <string>

using pliant::machine::DefineLines;

namespace {

std::string with(const std::string& text, const std::string& name, const std::string& value) {
    DefineLines lines(text);
    lines.set(name, value);
    return lines.text();
}

}  // namespace

TEST_CASE("a value is replaced in place; indentation, blanks and comment stay") {
    CHECK(with("#define SPEED 10\n", "SPEED", "25") == "#define SPEED 25\n");
    CHECK(with("  #define   SPEED\t 10   // (mm/s)\n", "SPEED", "7") == "  #define   SPEED\t 7   // (mm/s)\n");
    CHECK(with("  //#define SPEED 10 // (mm/s)\n", "SPEED", "7") == "  #define SPEED 7 // (mm/s)\n");
    CHECK(with("#define NAME \"http://a // b\" /* where */\n", "NAME", "\"c\"") == "#define NAME \"c\" /* where */\n");
    CHECK(with("#define AXIS 'A'// one of 'A', 'B'\n", "AXIS", "'C'") == "#define AXIS 'C' // one of 'A', 'B'\n");
    CHECK(with("#define BARE\n", "BARE", "3") == "#define BARE 3\n");
    CHECK(with("#define BARE // why\n", "BARE", "3") == "#define BARE 3 // why\n");
    CHECK(with("#define SPEED 10", "SPEED", "25") == "#define SPEED 25");
}

TEST_CASE("on and off add or remove the comment slashes, and keep the value") {
    CHECK(with("//#define CARD // a slot\n", "CARD", "on") == "#define CARD // a slot\n");
    CHECK(with("  // #define CARD 4\n", "CARD", "on") == "   #define CARD 4\n");
    CHECK(with("\t#define CARD 4\n", "CARD", "off") == "\t//#define CARD 4\n");
    CHECK(with("//#define CARD\n", "CARD", "off") == "//#define CARD\n");
    CHECK(with("#define CARD\n", "CARD", "on") == "#define CARD\n");
}

TEST_CASE("a setting changes in every branch of an #if, and names that begin alike do not") {
    const std::string text =
        "#if ENABLED(CARD)\n  #define SIZE 8\n#else\n  #define SIZE 16\n#endif\n#define SIZE_OF_ALL 3\n#define XSIZE "
        "4\n";
    CHECK(with(text, "SIZE", "32") ==
          "#if ENABLED(CARD)\n  #define SIZE 32\n#else\n  #define SIZE 32\n#endif\n#define SIZE_OF_ALL 3\n"
          "#define XSIZE 4\n");
    CHECK(DefineLines(text).find("SIZE").size() == 2);
}

TEST_CASE("continued lines belong to their setting") {
    const std::string text = "#define ROW { 1, \\\n              2 }  // two\n#define NEXT 1\n";
    CHECK(with(text, "ROW", "{ 3 }") == "#define ROW { 3 }\n#define NEXT 1\n");
    CHECK(DefineLines(text).find("ROW").front().value == "{ 1, 2 }");
    CHECK(with(text, "ROW", "off") == "//#define ROW { 1, \\\n              //2 }  // two\n#define NEXT 1\n");
    CHECK(with(with(text, "ROW", "off"), "ROW", "on") == text);
    CHECK(with(with(text, "ROW", "off"), "ROW", "{ 3 }") == "#define ROW { 3 }\n#define NEXT 1\n");
    CHECK(with("#define LAST { 1, \\", "LAST", "2") == "#define LAST 2");  // cut off in the middle
}

TEST_CASE("definitions in block comments, and macros with arguments, are not settings") {
    const std::string text =
        "/**\n * Its speed:\n#define SPEED 10\n */\n#define MAX(a) (a) /* of\n#define SPEED 11\n*/\n// "
        "\"don't\n#define SPEED 12\n";
    DefineLines lines(text);
    REQUIRE(lines.find("SPEED").size() == 1);
    CHECK(lines.find("SPEED").front().value == "12");
    CHECK(lines.find("MAX").empty());
    CHECK(with(text, "NOBODY", "1") == text);
}

TEST_CASE("the file's line ends are kept") {
    CHECK(with("#define A 1\r\n//#define B\r\n\r\n", "A", "2") == "#define A 2\r\n//#define B\r\n\r\n");
    DefineLines windows("#define A 1\r\n#define B 1");
    windows.append("#define C 1");
    CHECK(windows.text() == "#define A 1\r\n#define B 1\r\n#define C 1\r\n");
    CHECK(DefineLines("").text().empty());
}
