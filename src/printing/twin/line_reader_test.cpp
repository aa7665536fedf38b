#include "printing/twin/line_reader.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <vector>

using namespace pliant::twin;

namespace {

std::vector<ReceivedLine> read(LineReader& reader, std::string_view bytes) {
    std::vector<ReceivedLine> lines;
    for (const char byte : bytes) {
        if (auto line = reader.feed(byte)) lines.push_back(*line);
    }
    return lines;
}

}  // namespace

TEST_CASE("a numbered line with the right checksum is taken") {
    // xor of "N1 G28 Z": N^1 = 0x7f, then ' ' 'G' '2' '8' ' ' 'Z'.
    CHECK(checksum("N1 G28 Z") == ('N' ^ '1' ^ ' ' ^ 'G' ^ '2' ^ '8' ^ ' ' ^ 'Z'));
    LineReader reader;
    const auto lines = read(reader, fmt::format("N1 G28 Z*{}\r\n", checksum("N1 G28 Z")));
    REQUIRE(lines.size() == 1);
    CHECK(lines[0].error.empty());
    CHECK(lines[0].command == "G28 Z");
    CHECK(lines[0].number == 1);
    CHECK(reader.last_number() == 1);
}

TEST_CASE("errors come in Marlin's order: number, then presence, then value of the checksum") {
    LineReader reader;
    CHECK(read(reader, "N2 G28*1\n")[0].error == "Line Number is not Last Line Number+1");
    CHECK(read(reader, "N1 G28\n")[0].error == "No Checksum with line number");
    CHECK(read(reader, "N1 G28*1\n")[0].error == "checksum mismatch");
    CHECK(reader.last_number() == 0);
}

TEST_CASE("M110 sets the line number") {
    LineReader reader;
    const std::string line = "N0 M110 N41";
    REQUIRE(read(reader, fmt::format("{}*{}\n", line, checksum(line)))[0].error.empty());
    CHECK(reader.last_number() == 41);
}

TEST_CASE("lines without a number are not checked; comments, blanks and empty lines are removed") {
    LineReader reader;
    CHECK(read(reader, " M400*33\n")[0].command == "M400");
    CHECK(read(reader, "\n\r\n;only\n").empty());
    CHECK(read(reader, "G28 ; home\n")[0].command == "G28");
    CHECK(read(reader, "G2x\b8\n")[0].command == "G28");
    CHECK(read(reader, "G1 " + std::string(200, '1') + "\n")[0].command.size() == 95);
    CHECK(read(reader, "N\n")[0].error == "Line Number is not Last Line Number+1");
    CHECK(read(reader, "N1*\n")[0].error == "checksum mismatch");
    CHECK(read(reader, "   \n")[0].command.empty());
}
