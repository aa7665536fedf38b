#include "printing/twin/twin.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/core/test_text.hpp"
#include "printing/machine/board_report.hpp"
#include "printing/twin/test_peer.hpp"

using namespace pliant;
using namespace pliant::twin;
using machine::Axis;
using pliant::test::holds;
using twin::test::Peer;

TEST_CASE("the twin starts like Marlin and answers queries") {
    const auto printer = machine::load_printer("examples/printers/tower.toml").value();
    Twin twin(printer);
    CHECK(twin.take_output().substr(0, 6) == "start\n");
    Peer b;
    CHECK(holds(b.send("M115"), "Cap:EMERGENCY_PARSER:1\nok\n"));
    CHECK(b.send("M118 E1 tok 5") == "echo:tok 5\nok\n");
    CHECK(b.send("M118 A1 x") == "//x\nok\n");
    b.home();
    CHECK(b.send("M114") == "X:0.000 Z:400.000 Y:0.000 \nok\n");
    CHECK(b.send("M777 S7") == "echo:Unknown command: \"M777\"\nok\n");
    CHECK(b.send("hello") == "echo:Unknown command: \"hello\"\nok\n");
    CHECK(b.raw("\n;x\n").empty());
}

TEST_CASE("the twin's reports pass the check of its board, and fail without emergency parser") {
    for (const bool parser : {true, false}) {
        Options options;
        options.emergency_parser = parser;
        Peer b(options);
        std::string answers;
        for (const char* query : {"M115", "M503", "M211", "M119", "M113"}) answers += b.send(query);
        CHECK(holds(answers, "echo:  M92 X525.21 Z800.00 Y315.13\n"));
        CHECK(holds(answers, "echo:  M204 P200.00 R200.00 T200.00\n"));
        CHECK(holds(answers, "echo:  Min:  X0.00 Z0.00 Y0.00   Max:  X358.00 Z400.00 Y1460.00\n"));
        const auto problems = machine::check_board(machine::parse_board_report(answers), b.printer);
        CHECK(problems.size() == (parser ? 0 : 1));
        b.send("M113 S0");
        CHECK(holds(b.send("M113"), "echo:M113 S0\n"));
        b.send("M211 S0");
        CHECK(holds(b.send("M211"), "echo:  M211 S0 ; OFF\n"));
    }
    Peer b;
    CHECK(holds(b.send("M119"), "z_max: open\n"));
    b.home();
    CHECK(holds(b.send("M119"), "z_max: TRIGGERED\n"));
}

TEST_CASE("a bad line gets Error, Resend and ok; the correct line is then taken") {
    Peer b;
    CHECK(b.raw("N1 M400*1\n") == "Error:checksum mismatch, Last Line: 0\nResend: 1\nok\n");
    CHECK(b.send("M400") == "ok\n");
    CHECK(b.raw(Peer::line(4, "M400")) == "Error:Line Number is not Last Line Number+1, Last Line: 1\nResend: 2\nok\n");
}

TEST_CASE("ok comes when a move is queued, that of M400 when the move is done, and busy meanwhile") {
    Peer b;
    b.home();
    const double start = b.twin.now();
    CHECK(b.send("G1 Z300 F1200") == "ok\n");
    CHECK(b.send("M400").empty());
    // 100 mm at 20 mm/s with ramps of 100 mm/s^2: 5.2 s.
    b.twin.advance_to(start + 5.19);
    CHECK(b.twin.take_output() == "echo:busy: processing\necho:busy: processing\n");
    b.twin.advance_to(start + 5.21);
    CHECK(b.twin.take_output() == "ok\n");
}

TEST_CASE("the queue holds four lines and the receive buffer a limited number; the rest is lost") {
    Peer b;
    std::string lines;
    for (int i = 0; i < 60; ++i) lines += "G4 P1\n";
    b.twin.receive(lines);
    b.twin.advance_to(10);
    const std::string out = b.twin.take_output();
    const auto oks = static_cast<int>(out.size()) / 3;
    CHECK(oks < 60);
    CHECK(oks > 20);
}

TEST_CASE("moves that the interlocks forbid are refused, reported and recorded") {
    Peer b;
    CHECK(holds(b.send("G1 X10"), "Error:interlock: the carriage moves before"));
    b.home();
    CHECK(holds(b.send("G1 Y10 X355.6"), "Error:interlock: the tower moves"));
    CHECK(b.twin.interlock().position()[Axis::platform] == 400000);
    REQUIRE(b.twin.log().violations.size() == 2);
    b.twin.light_on({1920, 1080, std::vector<std::uint8_t>(1920 * 1080)});
    CHECK(holds(b.twin.log().violations.back(), "no vat under the platform"));
}

TEST_CASE("a command to the pin of the emergency line is refused, reported and recorded") {
    Peer b;
    CHECK(holds(b.send("M42 P12 S0"), "Error:interlock: M42 P12: that pin is the emergency line"));
    REQUIRE(b.twin.log().violations.size() == 1);
    CHECK(holds(b.twin.log().violations[0], "that pin is the emergency line"));
    CHECK(b.send("M42 P57 S0") == "ok\n");
}

TEST_CASE("M410 stops a move half-way, and the axes must be homed again") {
    Peer b;
    b.home();
    b.send("G1 Z300 F1200", 2.6);
    CHECK(b.raw("M410\n", 1.1) == "ok\n");
    CHECK(b.twin.interlock().position()[Axis::platform] == 350000);
    CHECK(holds(b.send("G1 Z340"), "Error:interlock: the platform moves before it is homed"));
}

TEST_CASE("after M112 only a reset helps") {
    Peer b;
    CHECK(holds(b.raw("M112\n"), "Error:Printer halted. kill() called!"));
    CHECK(b.send("M114").empty());
    b.twin.reset();
    CHECK(holds(b.twin.take_output(), "start\n"));
    b.number = 0;
    CHECK(b.send("M400") == "ok\n");
}

TEST_CASE("idle motors switch off after two minutes unless M84 S0 was sent") {
    Peer b;
    b.home();
    b.raw("", 121);
    CHECK(holds(b.send("G1 Z300"), "before it is homed"));
    Peer kept;
    kept.send("M84 S0");
    kept.home();
    kept.raw("", 121);
    CHECK(kept.send("G1 Z300") == "ok\n");
}

TEST_CASE("faults given as options happen: a corrupt byte, a lost line, a lost ok, a reset") {
    Peer corrupt({false, 2, {{Fault::Kind::corrupt_byte, 1}}});
    CHECK(holds(corrupt.send("M400"), "Error:"));
    Peer lost({false, 2, {{Fault::Kind::lose_line, 1}}});
    CHECK(lost.send("M400").empty());
    Peer no_ok({false, 2, {{Fault::Kind::lose_ok, 1}}});
    CHECK(no_ok.send("M118 E1 a") == "echo:a\n");
    Peer reset({false, 2, {{Fault::Kind::reset, 2}}});
    reset.send("M400");
    CHECK(holds(reset.send("M400"), "start\n"));
    Peer advanced({true, 2, {}});
    CHECK(advanced.send("M400") == "ok N1 P15 B4\n");
}
