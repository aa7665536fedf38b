// One test for each behaviour of a real Marlin that a host must cope with, as observed on the wire of Marlin 2.1.1 and
// 2.1.2.1, or read in its source.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "printing/twin/test_peer.hpp"
#include "printing/twin/twin.hpp"

using namespace pliant;
using namespace pliant::twin;
using machine::Axis;
using machine::MarlinRelease;
using pliant::test::holds;
using twin::test::Peer;

namespace {

Options with(Options options, std::vector<Fault> faults) {
    options.faults = std::move(faults);
    return options;
}

Options of(MarlinRelease release) {
    Options options;
    options.release = release;
    return options;
}

}  // namespace

TEST_CASE("framing: the line number is checked before the checksum, and each error says the last good line") {
    Peer p;
    CHECK(p.raw("N5 M400*1\n") == "Error:Line Number is not Last Line Number+1, Last Line: 0\nResend: 1\nok\n");
    CHECK(p.raw("N1 M400*1\n") == "Error:checksum mismatch, Last Line: 0\nResend: 1\nok\n");
    CHECK(p.raw("N1 M400\n") == "Error:No Checksum with line number, Last Line: 0\nResend: 1\nok\n");
}

TEST_CASE("framing: M110 sets the number, numbered or not") {
    Peer p;
    CHECK(p.raw(Peer::line(41, "M110 N41")) == "ok\n");
    CHECK(p.raw(Peer::line(42, "M400")) == "ok\n");
    CHECK(p.raw("M110 N7\n") == "ok\n");
    CHECK(p.raw(Peer::line(8, "M400")) == "ok\n");
}

TEST_CASE("framing: a line that does not begin with N runs unchecked, even with a wrong checksum") {
    Peer p;
    CHECK(p.raw("M118 E1 hi*33\n") == "echo:hi\nok\n");
}

TEST_CASE("framing: text after the checksum is ignored, and two equal bit errors are not detected") {
    Peer p;
    std::string good = Peer::line(1, "M118 E1 ab");
    good.insert(good.size() - 1, "X");
    CHECK(p.raw(good) == "echo:ab\nok\n");
    std::string twice = Peer::line(2, "M118 E1 ab");
    const std::size_t a = twice.find("ab");
    twice[a] ^= 2, twice[a + 1] ^= 2;
    CHECK(p.raw(twice) == "echo:c`\nok\n");
}

TEST_CASE("framing: a line over 95 characters is cut off silently") {
    Peer p;
    const std::string text(120, 'x');
    CHECK(p.raw("M118 " + text + "\n") == std::string(90, 'x') + "\nok\n");
}

TEST_CASE("framing: lower case is no command; comment, backslash and backspace act as in Marlin") {
    Peer p;
    CHECK(p.raw("g28\n") == "echo:Unknown command: \"g28\"\nok\n");
    CHECK(p.raw("M118 a ; b\n") == "a\nok\n");
    CHECK(p.raw("M118 a \\; b\n") == "a ; b\nok\n");
    CHECK(p.raw("M118 ax\bb\n") == "ab\nok\n");
}

TEST_CASE("framing: an empty line or a comment gets no answer, a line of blanks gets one") {
    Peer p;
    CHECK(p.raw("\n").empty());
    CHECK(p.raw("; nothing\n").empty());
    CHECK(p.raw("   \n") == "echo:Unknown command: \"\"\nok\n");
}

TEST_CASE("framing: CR LF, CR or LF ends a line") {
    Peer p;
    CHECK(p.raw("M118 a\r\nM118 b\n") == "a\nok\nb\nok\n");
}

TEST_CASE("answers: ADVANCED_OK with and without line number; M105 answers in its ok line") {
    Options advanced;
    advanced.advanced_ok = true;
    Peer p(advanced);
    CHECK(p.send("M400") == "ok N1 P15 B4\n");
    CHECK(p.raw("M400\n") == "ok P15 B4\n");
    Peer plain;
    CHECK(plain.send("M105").substr(0, 5) == "ok T:");
}

TEST_CASE("answers: a report comes before its ok; a build may report fans without prefix") {
    Peer p;
    CHECK(holds(p.send("M114"), "X:0.000 "));
    Options fans;
    fans.report_fans = true;
    Peer q(fans);
    CHECK(q.send("M106 P0 S255") == "M106 P0 S255\nok\n");
    CHECK(q.send("M107 P0") == "M106 P0 S0\nok\n");
}

TEST_CASE("answers: after a bad line every line already sent gives the same Resend again") {
    Peer p;
    CHECK(p.raw("N1 M400*1\n") == "Error:checksum mismatch, Last Line: 0\nResend: 1\nok\n");
    for (long n = 2; n <= 4; ++n) {
        const std::string said = p.raw(Peer::line(n, "M400"));
        CHECK(holds(said, "Resend: 1\nok\n"));
    }
    CHECK(p.raw(Peer::line(1, "M400")) == "ok\n");
}

TEST_CASE("answers: up to 2.1.1 a repeated line gives a Resend of the next number") {
    Peer p(of(MarlinRelease::v2_1_1));
    p.send("M400");
    CHECK(holds(p.raw(Peer::line(1, "M400")), "Resend: 2\nok\n"));
    Peer fresh(of(MarlinRelease::v2_1_1));
    CHECK(holds(fresh.raw(Peer::line(0, "M400")), "Last Line: 0\nResend: 1\nok\n"));
}

TEST_CASE("answers: since 2.1.2 a line with the last number or the one before is dropped silently") {
    for (const auto release : {MarlinRelease::v2_1_2, MarlinRelease::v2_1_3}) {
        Peer p(of(release));
        CHECK(p.raw(Peer::line(0, "M118 E1 dropped")).empty());  // a fresh start: 0 is the last line
        CHECK(p.raw("N-1 M400*1\n").empty());
        for (int i = 0; i < 5; ++i) p.send("M400");
        CHECK(p.raw(Peer::line(5, "M118 E1 dropped")).empty());
        CHECK(p.raw(Peer::line(4, "M118 E1 dropped")).empty());
        CHECK(p.raw("N5 M400*1\n").empty());  // its checksum is not verified
        CHECK(holds(p.raw(Peer::line(3, "M400")), "Error:Line Number is not Last Line Number+1, Last Line: 5\n"));
        CHECK(p.raw(Peer::line(6, "M118 E1 taken")) == "echo:taken\nok\n");
        p.twin.reset();
        (void)p.twin.take_output();
        CHECK(p.raw(Peer::line(0, "M400")).empty());
    }
    Peer p;  // the release of the printer file's board
    CHECK(p.twin.release() == MarlinRelease::v2_1_2);
    CHECK(p.raw(Peer::line(0, "M400")).empty());
}

TEST_CASE("answers: a far number with a wrong checksum gives the last line on every release, and is not taken") {
    for (const auto release : {MarlinRelease::v2_1_1, MarlinRelease::v2_1_2, MarlinRelease::v2_1_3}) {
        Peer p(of(release));
        CHECK(holds(p.raw("N2147483640 M400*0\n"), "Last Line: 0\nResend: 1\nok\n"));
        p.send("M400");
        CHECK(holds(p.raw("N2147483640 M400*0\n"), "Last Line: 1\nResend: 2\nok\n"));
        CHECK(p.send("M400") == "ok\n");
    }
}

TEST_CASE("framing: M110 sets the number when it is received, and again when it runs") {
    Peer p;
    p.send("G4 S5");
    CHECK(p.raw(Peer::line(100, "M110 N100")).empty());        // waits behind the pause, but already acts
    CHECK(p.raw(Peer::line(101, "M118 E1 between")).empty());  // so this one is accepted
    CHECK(holds(p.raw("", 6), "ok\nok\necho:between\nok\n"));  // and then 100 is the last line again
    CHECK(holds(p.raw(Peer::line(102, "M400")), "Last Line: 100\nResend: 101\nok\n"));
    CHECK(p.raw(Peer::line(101, "M118 E1 again")) == "echo:again\nok\n");
}

TEST_CASE("faults on the wire: a line that loses its number runs unchecked, and is asked for again") {
    Peer p(with({}, {{Fault::Kind::lose_number, 2, 0}}));
    p.send("M400");
    CHECK(p.send("M118 E1 twice") == "echo:twice\nok\n");
    CHECK(holds(p.send("M400"), "Last Line: 1\nResend: 2\nok\n"));
    CHECK(p.raw(Peer::line(2, "M118 E1 twice")) == "echo:twice\nok\n");
}

TEST_CASE("machine: with NO_MOTION_BEFORE_HOMING, moves of axes not homed are left out, with ok") {
    Options options;
    options.homes_first = true;
    Peer p(options);
    p.send("M84 S0");
    const int before_um = p.z_um();
    CHECK(p.send("G1 Z300 F1200") == "echo:Home Z First\nok\n");
    CHECK(p.send("G1 X10 Z300") == "echo:Home XZ First\nok\n");
    CHECK(p.z_um() == before_um);
    CHECK(p.twin.log().violations.empty());
    p.home();
    CHECK(p.send("G1 Z300 F1200") == "ok\n");
}

TEST_CASE("stopping: a move continues for 0.9 s after M112 alone, and stops at once after M410") {
    const auto way_um = [](bool quick) {
        Peer p;
        p.send("M84 S0");
        p.home();
        p.send("G1 Z200 F900");
        p.raw("", 4);
        const int before_um = p.z_um_now();
        CHECK(before_um < 400000);
        if (quick) p.raw("M410\n", 0.01);
        p.raw("M112\n", 5);
        CHECK_FALSE(p.twin.interlock().homed(Axis::platform));
        return before_um - p.z_um();
    };
    CHECK(way_um(false) == near(13500, {.relative = 1e-12}));  // 15 mm/s for 0.9 s
    CHECK(way_um(true) == 0);
}

TEST_CASE("homing to a dead switch pushes for 1.5 times the travel, then halts the firmware") {
    Peer p(with({}, {{Fault::Kind::dead_switch, 1, 0}}));
    CHECK(holds(p.send("M119"), "x_min: open\n"));  // parked at its switch, which should be pressed
    CHECK(p.send("G28 Z", 100) != "");
    const double travel_mm = 358;
    const double longest_s = 1.5 * travel_mm / p.printer.axis(Axis::carriage).homing_speed_mm_s;
    CHECK_FALSE(holds(p.send("G28 X", longest_s - 1), "Homing Failed"));
    CHECK(holds(p.raw("", 2), "echo:Homing Failed\nError:Printer halted. kill() called!\n"));
    CHECK(p.twin.log().pushed_s > longest_s / 3 - 1);
    CHECK(p.send("M400", 20).empty());
    p.twin.reset();
    (void)p.twin.take_output();
    CHECK(p.raw(Peer::line(1, "M400")) == "ok\n");
}

TEST_CASE("answers: M999 gives a Resend and two oks; with S one ok") {
    Peer p;
    CHECK(p.send("M999") == "Resend: 2\nok\nok\n");
    CHECK(p.send("M999 S1") == "ok\n");
}

TEST_CASE("answers: an idle build with NO_TIMEOUTS says wait every second, others say nothing") {
    Options waits;
    waits.wait_every_s = 1;
    Peer p(waits);
    CHECK(p.raw("", 3.5) == "wait\nwait\nwait\n");
    Peer q;
    CHECK(q.raw("", 3.5).empty());
}

TEST_CASE("boot: silence, then start and its cause; the line number starts again") {
    Options slow;
    slow.boot_s = 2;
    const auto printer = machine::load_printer("examples/printers/tower.toml").value();
    Twin twin(printer, slow);
    twin.receive("M400\n");
    twin.advance_to(1.9);
    CHECK(twin.take_output().empty());
    twin.advance_to(2.1);
    CHECK(twin.take_output().substr(0, 14) == "start\nPowerUp\n");
    Peer p;
    p.send("M400");
    p.twin.reset();
    CHECK(p.twin.take_output().substr(0, 21) == "start\nExternal Reset\n");
    CHECK(p.raw(Peer::line(1, "M400")) == "ok\n");
}

TEST_CASE("busy: sent every two seconds while a command blocks; M113 changes the interval, S0 switches it off") {
    Peer p;
    CHECK(p.send("G4 P5000", 4.9) == "echo:busy: processing\necho:busy: processing\n");
    CHECK(p.raw("", 0.2) == "ok\n");
    p.send("M113 S0");
    CHECK(p.send("G4 S5", 5.1) == "ok\n");
    p.send("M113 S1");
    CHECK(p.send("G4 S2", 1.5) == "echo:busy: processing\n");
}

TEST_CASE("pause: M0 waits with prompts, M108 continues, and each gives an ok") {
    Peer p;
    const std::string said = p.send("M0", 2.5);
    CHECK(holds(said, "//action:prompt_begin M0 Stop\n"));
    CHECK(holds(said, "echo:busy: paused for user\n"));
    CHECK_FALSE(holds(said, "ok\n"));
    const std::string after = p.raw("M108\n");
    CHECK(after == "//action:prompt_end\nok\nok\n");
}

TEST_CASE("synchronising: ok does not mean motion is done; M400, G4 P0 and an echo after M400 do") {
    Peer p;
    p.home();
    CHECK(p.send("G1 Z300 F1200") == "ok\n");
    CHECK(p.send("G4 P0").empty());
    CHECK(holds(p.raw("", 6), "ok\n"));
    CHECK(p.send("G1 Z400 F1200") == "ok\n");
    p.raw(Peer::line(p.number + 1, "M400") + Peer::line(p.number + 2, "M118 E1 tok 9"));
    CHECK(holds(p.raw("", 6), "ok\necho:tok 9\nok\n"));
}

TEST_CASE("synchronising: a build for NanoDLP blocks on platform moves and says Z_move_comp") {
    Options nano;
    nano.z_sync = true;
    Peer p(nano);
    p.home();
    CHECK(p.send("G1 Z300 F1200", 5).find("Z_move_comp") == std::string::npos);
    CHECK(p.raw("", 0.3) == "Z_move_comp\nok\n");
    CHECK(p.send("G1 X1") == "ok\n");
}

TEST_CASE("synchronising: M114 gives the target of the move, not the present position") {
    Peer p;
    p.home();
    p.send("G1 Z300 F1200");
    CHECK(holds(p.send("M114"), "Z:300.000"));
}

TEST_CASE("stopping: without the emergency parser M410 and M112 wait in the queue; numbered they always do") {
    Options late;
    late.emergency_parser = false;
    Peer p(late);
    CHECK(holds(p.send("M115"), "Cap:EMERGENCY_PARSER:0"));
    p.send("G4 S10");
    CHECK(p.raw("M112\n").empty());
    CHECK(holds(p.raw("", 11), "Printer halted"));
    Peer q;
    q.send("G4 S10");
    CHECK(q.send("M112").empty());
    CHECK(holds(q.raw("", 11), "Printer halted"));
}

TEST_CASE("stopping: M112 halts at once, and then not even M999 is answered") {
    Peer p;
    p.send("G4 S10");
    CHECK(p.raw("M112\n") == "echo:M112 Shutdown\nError:Printer halted. kill() called!\n//action:poweroff\n");
    CHECK(p.send("M999", 20).empty());
}

TEST_CASE("stopping: after M410 queued commands still run, and axes must be homed again") {
    Peer p;
    p.home();
    p.send("G1 Z300 F1200");
    p.send("M400");
    p.send("M118 E1 still here");
    p.twin.advance_to(p.twin.now() + 2);
    (void)p.twin.take_output();
    CHECK(p.raw("M410\n", 0.9).empty());  // the planner accepts no moves for a second
    CHECK(holds(p.raw("", 0.2), "ok\necho:still here\nok\n"));
    CHECK(p.z_um() > 300000);
    CHECK_FALSE(p.twin.interlock().homed(Axis::platform));
}

TEST_CASE("machine: idle motors switch off after two minutes, extra axes too, unless M84, M18 or M85 S0") {
    for (const char* keep : {"M84 S0", "M18 S0", "M85 S0"}) {
        Peer p;
        p.send(keep);
        p.home();
        p.raw("", 500);
        CHECK(p.send("G1 Z300") == "ok\n");
    }
    Peer p;
    p.home();
    p.raw("", 121);
    p.send("G1 Y10");
    CHECK_FALSE(p.twin.interlock().homed(Axis::tower));
    Peer q;
    q.home();
    q.send("M18");
    CHECK_FALSE(q.twin.interlock().homed(Axis::platform));
}

TEST_CASE("machine: a move beyond a homed axis' travel is cut off silently, and the twin records it") {
    Peer p;
    p.home();
    CHECK(p.send("G1 Z500") == "ok\n");
    CHECK(p.z_um() == 400000);
    CHECK(p.twin.log().clamped_moves == 1);
    CHECK(p.twin.log().violations.size() == 1);
}

TEST_CASE("machine: commands for hot ends and sensors it lacks are unknown, and still get ok") {
    Peer p;
    for (const char* command : {"M104 S200", "M140 S60", "M155 S1", "M413", "M1000"}) {
        const std::string said = p.send(command);
        CHECK(holds(said, "echo:Unknown command: "));
        CHECK(holds(said, "ok\n"));
    }
}

TEST_CASE("machine: an output switches when the moves before it are done") {
    Peer p;
    p.send("M84 S0");
    p.home();
    for (const char* line : {"G90", "G1 Y0.5", "G1 X355.6", "G1 Y30", "G1 X0", "G1 X355.6"}) p.send(line, 60);
    const double before = p.twin.now();
    p.send("G1 Y0.5 F600");  // 3 s off the hooks
    p.send("M106 P1 S255");
    CHECK(p.twin.now() == before);
    p.send("M400", 10);
    p.send("M107 P1");
    CHECK(p.twin.interlock().pump_runs() == false);
}

TEST_CASE("machine: a limit switch follows the axis' true position, also during a move and after lost steps") {
    Peer p(with({}, {{Fault::Kind::missed_steps, 2, 2}}));
    CHECK(holds(p.send("M119"), "x_min: TRIGGERED\nz"));  // parked at its switch, homed or not
    p.home();
    CHECK(holds(p.send("M119"), "z_max: TRIGGERED"));
    p.send("G1 Z300 F600");
    p.raw("", 5);
    CHECK(holds(p.send("M119"), "z_max: open"));
    p.raw("", 60);
    p.send("G1 Z400 F600", 60);  // stops 2 mm short, unknown to the controller
    CHECK(holds(p.send("M114"), "Z:400.000"));
    CHECK(holds(p.send("M119"), "z_max: open"));
}

TEST_CASE("machine: a stuck switch and a far switch are reported by M119") {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.limit_switches.push_back({Axis::carriage, true, false});
    Options options;
    options.faults = {{Fault::Kind::stuck_switch, 4, 0}};
    Twin twin(printer, options);
    twin.receive("M119\n");
    CHECK(holds(twin.take_output(), "x_min: TRIGGERED\nz_max: open\ny_min: open\nx_max: TRIGGERED\nok"));
}

TEST_CASE("machine: the door's switch is on its input, and exposure with an open door is counted") {
    const auto printer = machine::load_printer("examples/printers/single.toml").value();
    Options options;
    options.faults = {{Fault::Kind::door_open, 1, 20}};
    Twin twin(printer, options);
    const auto says = [&] {
        (void)twin.take_output();
        twin.receive("M119\n");
        return twin.take_output();
    };
    twin.receive("M84 S0\nG28 Z\nG1 Z1 F1200\nM400\n");
    twin.advance_to(60);
    CHECK(holds(says(), "y_max: open"));
    const job::Image white{printer.projector.width_px, printer.projector.height_px,
                           std::vector<std::uint8_t>(static_cast<std::size_t>(printer.projector.width_px) *
                                                         static_cast<std::size_t>(printer.projector.height_px),
                                                     255)};
    twin.light_on(white);
    twin.advance_to(61);
    CHECK(twin.door_is_open());
    CHECK(holds(says(), "y_max: TRIGGERED"));
    twin.advance_to(62);
    twin.light_off();
    CHECK(twin.log().lit_while_open_s == near(1.5, {.relative = 1e-12}));
    twin.advance_to(81);
    CHECK(holds(says(), "y_max: open"));
}

TEST_CASE("machine: a door set open stays open until it is shut") {
    Twin twin(machine::load_printer("examples/printers/single.toml").value());
    const auto says = [&] {
        (void)twin.take_output();
        twin.receive("M119\n");
        return twin.take_output();
    };
    CHECK(holds(says(), "y_max: open"));
    twin.set_door(true);
    twin.advance_to(1000);
    CHECK(holds(says(), "y_max: TRIGGERED"));
    twin.set_door(false);
    CHECK(holds(says(), "y_max: open"));
    twin.set_door(false);
    CHECK(twin.log().mishaps.size() == 1);
}

TEST_CASE("machine: two fans are independent; M112 switches all outputs off, and the relay until a reset") {
    Peer p;
    p.send("M106 P0 S255");
    p.raw("", 2);
    p.send("M106 P2 S255");
    p.raw("", 3);
    p.send("M107 P0");
    CHECK(p.twin.log().fan_s == std::vector<double>{5, 0});
    p.raw("M112\n");
    CHECK(p.twin.log().fan_s == std::vector<double>{5, 3});
    CHECK(p.twin.log().power_cut);
    p.twin.reset();
    CHECK_FALSE(p.twin.log().power_cut);
}

TEST_CASE("faults on the wire: a lost or flipped byte is caught by the checksum") {
    Peer lost(with({}, {{Fault::Kind::lose_byte, 5, 0}}));
    CHECK(holds(lost.send("M400"), "Error:"));
    Peer flipped(with({}, {{Fault::Kind::flip_byte, 5, 0}}));
    CHECK(holds(flipped.send("M400"), "Error:checksum mismatch"));
}

TEST_CASE("faults on the wire: a resend loop refuses good lines a given number of times") {
    Peer p(with({}, {{Fault::Kind::resend_loop, 1, 2}}));
    CHECK(holds(p.raw(Peer::line(1, "M400")), "Resend: 1"));
    CHECK(holds(p.raw(Peer::line(1, "M400")), "Resend: 1"));
    CHECK(p.raw(Peer::line(1, "M400")) == "ok\n");
}

TEST_CASE("faults on the wire: a stalled controller answers late") {
    Peer p(with({}, {{Fault::Kind::stall, 2, 60}}));
    CHECK(p.send("M400") == "ok\n");
    CHECK(p.send("M400", 59).empty());
    CHECK(p.raw("", 2) == "ok\n");
}

TEST_CASE("faults of the mechanics cause no message on the wire") {
    Peer p(with({}, {{Fault::Kind::missed_steps, 1, 0.5}}));
    p.home();
    CHECK(p.send("G1 Z300") == "ok\n");
    REQUIRE(p.twin.log().mishaps.size() == 1);
    CHECK(holds(p.twin.log().mishaps[0], "the platform misses 0.500 mm"));
}
