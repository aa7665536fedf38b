#include "../printed.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <string>

using namespace pliant::app;

TEST_CASE("an error is one line, and no control character reaches the terminal") {
    using namespace std::string_literals;
    CHECK(one_line("x.toml: Länge: 5 µm") == "x.toml: Länge: 5 µm");
    CHECK(one_line("a\x1b[31m\a\nb\r\x7f"s + '\0' + "c") == "a\\x1b[31m\\x07\\nb\\x0d\\x7f\\x00c");
    CHECK(one_line("a\tb") == "a\tb");
    CHECK(one_line("a\xc2\x9b"
                   "1m") == "a\\u009b1m");  // a control sequence of one character
    CHECK(one_line("\xff\xc2") == "\xff\xc2");
    CHECK(visible_lines("one\ntwo\x1b") == "one\ntwo\\x1b");
}

TEST_CASE("work that is cancelled by a signal prints JSON too") {
    // The mesher is a program that never answers.
    const std::string command = std::string("timeout 5 env PLIANT_MESH=/bin/sleep '") + PLIANT_PROGRAM +
                                "' check examples/tutorial/finger.toml --json 2>/dev/null";
    std::FILE* pipe = ::popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    std::string said;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) said += static_cast<char>(c);
    ::pclose(pipe);
    CHECK(said == "{\"error\":\"cancelled\"}\n");
}
