#include "printing/wire/emergency_line.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::host;
using Signal = machine::EmergencyLine::Signal;

TEST_CASE("an emergency line is parsed from its signal and device") {
    CHECK(parse_emergency_line("none")->signal == Signal::none);
    CHECK(parse_emergency_line("dtr:/dev/ttyUSB1")->signal == Signal::dtr);
    const auto low = parse_emergency_line("file-low:/sys/class/gpio/gpio17/value").value();
    CHECK(low.signal == Signal::file);
    CHECK(low.device == "/sys/class/gpio/gpio17/value");
    CHECK_FALSE(low.stop_high);
    for (const char* text : {"", "dtr", "dtr:", "rst:/dev/ttyUSB1", "file", ":x"}) {
        const auto wrong = parse_emergency_line(text);
        REQUIRE_FALSE(wrong);
        CHECK(wrong.error().message.find("write dtr:PORT") != std::string::npos);
    }
}

TEST_CASE("a pin's file is released on opening, pulled and released again, inverted if asked for") {
    const pliant::test::Folder folder("pin");
    const std::string name = (folder / "value").string();
    REQUIRE(write_file(name, ""));
    for (const bool high : {true, false}) {
        const std::string stop = high ? "1\n" : "0\n", run = high ? "0\n" : "1\n";
        const auto line = open_emergency_line({Signal::file, name, 0, high}).value();
        CHECK(read_file(name).value() == run);
        CHECK(line->pull());
        CHECK(line->pull());
        CHECK(read_file(name).value() == stop);
        CHECK(line->release());
        CHECK(read_file(name).value() == run);
    }
}

TEST_CASE("an emergency line that cannot be used is refused before anything moves; \"none\" is accepted") {
    CHECK(open_emergency_line({Signal::file, "/none/value", 0, true}).error().message.find("/none/value") !=
          std::string::npos);
    CHECK(open_emergency_line({Signal::dtr, "/dev/null", 0, true}).error().message.find("/dev/null") !=
          std::string::npos);
    CHECK(open_emergency_line({Signal::rts, "/dev/ptmx", 0, true}).error().message.find("emergency line") !=
          std::string::npos);  // a terminal without control lines
    CHECK(open_emergency_line({}).value() == nullptr);
    CHECK(open_emergency_line({Signal::controller, "", 12, true}).value() == nullptr);
}
