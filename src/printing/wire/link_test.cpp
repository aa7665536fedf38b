#include "printing/wire/link.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "printing/host/test_devices.hpp"

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::test;
using pliant::test::holds;

namespace {

/// Answers the first line that contains `part` with `first`, otherwise like a faultless Marlin.
struct AnswerOnce {
    std::string part, first;
    bool done = false;
    std::string operator()(const std::string& line) {
        if (done || line.find(part) == std::string::npos) return good_answer(line);
        done = true;
        return first;
    }
};

/// Answers like a faultless Marlin up to the first line of the print.
std::string silent_on_moves(const std::string& line, bool& silent) {
    silent = silent || line.find(" G1 ") != std::string::npos;
    return silent ? "" : good_answer(line);
}

struct Bench {
    CountingClock clock;
    ScriptedWire wire;
    Link link;

    explicit Bench(std::function<std::string(const std::string&)> answer, LinkOptions options = {})
        : wire(clock, std::move(answer)), link(wire, clock, options) {}

    std::string error_of_print() {
        Status status = link.connect();
        for (int i = 1; i <= 6 && status; ++i) status = link.send(fmt::format("G1 X{}", i));
        if (status) status = link.fence();
        return status ? "" : status.error().message;
    }
    int times_written(const std::string& part) const {
        int n = 0;
        for (const std::string& line : wire.written) n += line.find(part) != std::string::npos;
        return n;
    }
};

}  // namespace

TEST_CASE("lines have numbers and checksums, starting with M110") {
    Bench b(good_answer);
    CHECK(b.error_of_print() == "");
    // xor of "N0 M110 N0" and of "N1 G1 X1", by hand.
    CHECK(b.wire.written[0] == "N0 M110 N0*125");
    CHECK(b.times_written("N1 G1 X1*96") == 1);
    CHECK(b.times_written("G1 ") == 6);
    CHECK(b.link.lines_sent() == 8);
    CHECK(b.link.resends() == 0);
}

TEST_CASE("a refused line and those after it are sent again, even if the answer is incomplete") {
    for (const char* answer : {"Error:checksum mismatch, Last Line: 2\nResend: 3\nok\n",  // the normal case
                               "Error:checksum mismatch, Last Line: 2\nResend: 3\n",      // without ok
                               "Error:checksum mismatch, Last Line: 2\nok\n",             // without Resend
                               "Resend: 3\nok\n"}) {
        CAPTURE(answer);
        Bench b(AnswerOnce{"X3*", answer});
        CHECK(b.error_of_print() == "");
        CHECK(b.times_written("X3*") == 2);
        CHECK(b.link.resends() >= 1);
    }
}

TEST_CASE("impossible line numbers in answers are ignored") {
    for (const char* number : {"9223372036854775807", "99999999999999999999", "2147483648", "-3"}) {
        CAPTURE(number);
        Bench b(AnswerOnce{
            "X3*", fmt::format("Error:checksum mismatch, Last Line: {}\nResend: {}\nok\nok\n", number, number)});
        CHECK(b.error_of_print() == "");
        CHECK(b.link.resends() == 0);
    }
    Bench b([](const std::string& line) { return is_probe(line) ? "Resend: 0\nok\n" : good_answer(line); });
    CHECK_FALSE(b.link.last_line());
}

TEST_CASE("a lost ok is found by asking for the last line: nothing is sent again or counted as damage") {
    bool lost = false;
    Bench b(
        [&](const std::string& line) -> std::string {
            if (line.find("X3*") != std::string::npos) return lost = true, "";
            return lost && is_probe(line) ? refusal(3) : good_answer(line);
        },
        {1, 120, 3, 12, 0.2, 10});
    CHECK(b.error_of_print() == "");
    CHECK(lost);
    CHECK(b.times_written("X3*") == 1);
    CHECK(b.times_written("X4*") == 1);
    CHECK(b.link.resends() == 0);
}

TEST_CASE("the last line number is accepted when received twice; a truncated one is not") {
    int asked = 0;
    Bench b([&](const std::string& line) {
        return is_probe(line) ? refusal(++asked == 1 ? 1004 : 1000004) : good_answer(line);
    });
    CHECK(b.link.last_line().value() == 1000004);
    CHECK(asked == 3);
}

TEST_CASE("an ok for another host's line is not taken for that of M110") {
    // M110 is lost; an ok for an old line arrives instead.
    Bench b(AnswerOnce{"M110", "ok N77 P15 B3\n"});
    b.wire.forgets = "M110";
    REQUIRE(b.link.connect(1000000));
    CHECK(b.times_written("M110") == 2);
    CHECK(b.link.send("G1 X1"));
    CHECK(b.link.fence());
    CHECK(b.link.resends() == 0);
}

TEST_CASE("a silent printer: the error names port and baud rate, or the reset button after a halt") {
    const auto silent = [](const std::string&) { return std::string(); };
    CHECK(holds(Bench(silent).error_of_print(), "baud rate? A board that was halted"));
    LinkOptions halted;
    halted.may_be_halted = true;
    halted.most_connects = 3;
    Bench b(silent, halted);
    const std::string message = b.error_of_print();
    CHECK(holds(message, "press the board's reset button"));
    CHECK_FALSE(holds(message, "baud"));
    CHECK(b.clock.now_s < 15);
}

TEST_CASE("halting sends M410, and M112 between 5 and 20 ms later") {
    Bench b(good_answer);
    REQUIRE(b.link.connect());
    const double before_s = b.clock.now_s;
    b.link.halt();
    const auto& said = b.wire.written;
    CHECK(said[said.size() - 2] == "M410");
    CHECK(said.back() == "M112");
    CHECK(b.clock.now_s - before_s == near(0.0125, {.relative = 0.6}));
    CHECK(b.link.has_halted());
}

TEST_CASE("a move that the firmware leaves out, and homing that fails, end the print") {
    CHECK(holds(Bench(AnswerOnce{"X3*", "echo:Home X First\nok\n"}).error_of_print(), "skipped a move: Home X First"));
    const std::string killed = "echo:Homing Failed\nError:Printer halted. kill() called!\n//action:poweroff\n";
    const std::string message = Bench(AnswerOnce{"X3*", killed}).error_of_print();
    CHECK(holds(message, "homing failed"));
    CHECK(holds(message, "reset the board"));
}

TEST_CASE("a fence with a time limit fails at that limit, even while the printer says busy") {
    bool blocked = false;
    Bench b([&](const std::string& line) {
        blocked = blocked || line.find("G28") != std::string::npos;
        return blocked ? std::string() : good_answer(line);
    });
    b.wire.talk = "echo:busy: processing\n";
    REQUIRE(b.link.connect());
    REQUIRE(b.link.send("G28 X"));
    const double before_s = b.clock.now_s;
    CHECK_FALSE(b.link.fence(40));
    CHECK(b.link.ran_late());
    CHECK(b.clock.now_s - before_s == near(40, {.relative = 0.05}));
}

TEST_CASE("busy restarts the timeout") {
    int busy = 0;
    CountingClock clock;
    struct BusyWire final : Wire {
        BusyWire(CountingClock& c, int& n) : clock(c), count(n) {}
        Status write(std::string_view bytes) override {
            if (is_probe(std::string(bytes.substr(1)))) return pending += refusal(0), Status{};
            blocked = bytes.find("M400") != std::string_view::npos;
            pending += blocked ? "" : good_answer(std::string(bytes.substr(1, bytes.size() - 2)));
            return {};
        }
        Result<std::string> read(double timeout_s) override {
            if (!blocked || !pending.empty()) {
                if (pending.empty()) clock.now_s += timeout_s;
                return std::exchange(pending, {});
            }
            clock.now_s += 2;
            if (++count < 30) return std::string("echo:busy: processing\n");
            blocked = false;
            return std::string("ok\n");
        }
        CountingClock& clock;
        int& count;
        bool blocked = false;
        std::string pending = "start\n";
    } wire(clock, busy);
    Link link(wire, clock, {1, 120, 3, 12, 0.2, 2});
    REQUIRE(link.connect());
    CHECK(link.fence());
    CHECK(busy == 30);
    CHECK(link.resends() == 0);
}

TEST_CASE("messages of an unknown command, a restart or a halt end the print") {
    CHECK(holds(Bench(AnswerOnce{"X3*", "echo:Unknown command: \"G1 X3\"\nok\n"}).error_of_print(), "does not know"));
    CHECK(holds(Bench(AnswerOnce{"X3*", "start\necho: External Reset\n"}).error_of_print(), "restarted"));
    CHECK(holds(Bench(AnswerOnce{"X3*", "Watchdog Reset\n"}).error_of_print(), "restarted"));
    CHECK(holds(Bench(AnswerOnce{"X3*", "Error:Printer halted. kill() called!\n"}).error_of_print(), "Printer halted"));
    // A reset whose `start` was lost: line numbers begin anew, long after line 1.
    const std::string anew = "Error:Line Number is not Last Line Number+1, Last Line: 0\nResend: 1\nok\n";
    Bench reset(AnswerOnce{"X6*", "oksta" + anew});
    CHECK(holds(reset.error_of_print(), "restarted"));
    CHECK(reset.times_written("X1*") == 1);
    CHECK(holds(Bench(AnswerOnce{"X3*", "Resend: 77\nok\n"}).error_of_print(), "requests line 77"));
}

TEST_CASE("endless refusals, and endless silence, end with an error") {
    const auto refuse = [](const std::string& line) -> std::string {
        return line.find("X3*") != std::string::npos ? "Error:checksum mismatch, Last Line: 2\nResend: 3\nok\n"
                                                     : good_answer(line);
    };
    CHECK(holds(Bench(refuse).error_of_print(), "too noisy"));
    bool is_silent = false;
    const auto silent = [&](const std::string& line) { return silent_on_moves(line, is_silent); };
    CHECK(holds(Bench(silent).error_of_print(), "stopped answering"));
    CHECK(holds(Bench([](const std::string&) { return std::string(); }).error_of_print(), "does not answer"));
}

TEST_CASE("a printer that sends other lines:") {
    constexpr const char* talk = "T:20.0 /0.0 B:20.0 /0.0\n";
    SUBCASE("one that never answers is given up") {
        Bench b([](const std::string&) { return std::string(); });
        b.wire.talk = talk;
        const Status connected = b.link.connect();
        REQUIRE_FALSE(connected);
        CHECK(holds(connected.error().message, "talks but does not answer"));
        CHECK_FALSE(b.link.last_line());
        CHECK(b.clock.now_s < 200);
    }
    SUBCASE("one that is busy for ever is given up later") {
        Bench b([](const std::string&) { return std::string(); });
        b.wire.talk = "echo:busy: processing\n";
        const Status connected = b.link.connect();
        REQUIRE_FALSE(connected);
        CHECK(holds(connected.error().message, "has been busy for 300 s"));
        CHECK(b.clock.now_s > 300);
        CHECK(b.clock.now_s < 330);
    }
    SUBCASE("a lost ok is found all the same") {
        int seen = 0;
        Bench b(
            [&](const std::string& line) -> std::string {
                if (line.find("X3*") != std::string::npos) return ++seen, "";
                return seen > 0 && is_probe(line) ? refusal(2) : good_answer(line);
            },
            {1, 120, 3, 12, 0.2, 3});
        b.wire.talk = talk;
        REQUIRE(b.link.connect());
        for (int i = 1; i <= 3; ++i) REQUIRE(b.link.send(fmt::format("G1 X{}", i)));
        CHECK_FALSE(b.link.fence());
        CHECK(seen > 1);
        CHECK(b.clock.now_s < 200);
    }
}

TEST_CASE("garbage between the lines is ignored") {
    Bench b([](const std::string& line) {
        if (is_probe(line)) return good_answer(line);
        return "T:0 B:0\n\x01\xff\necho:busy: procesing\nResnd: 1\n//action:notification hi\n" +
               (line.find("X3") != std::string::npos ? "ok\nok\n" : good_answer(line)) + std::string(5000, 'x') + "\n";
    });
    CHECK(b.error_of_print() == "");
}

TEST_CASE("the window limits the lines and bytes that are under way") {
    // Nothing is answered: only what fits the window is written.
    bool is_silent = false;
    const auto silent = [&](const std::string& line) { return silent_on_moves(line, is_silent); };
    Bench lines(silent, {2, 120, 3, 12, 0.2, 1});
    CHECK_FALSE(lines.error_of_print().empty());
    CHECK(lines.times_written("N2 ") > 0);
    CHECK(lines.times_written("N3 ") == 0);
    is_silent = false;
    Bench bytes(silent, {4, 27, 3, 12, 0.2, 1});  // "\nN1 G1 X1*96\n" has 13 bytes
    CHECK_FALSE(bytes.error_of_print().empty());
    CHECK(bytes.times_written("N2 ") > 0);
    CHECK(bytes.times_written("N3 ") == 0);
}

TEST_CASE("a command that the wire cannot carry is refused") {
    Bench b(good_answer);
    REQUIRE(b.link.connect());
    CHECK_FALSE(b.link.send(""));
    CHECK_FALSE(b.link.send("G1 X1\nG1 X2"));
    CHECK_FALSE(b.link.send("G1 ; there"));
    CHECK_FALSE(b.link.send(std::string(81, 'G')));
}

TEST_CASE("a wire that damages every third line is refused, one that damages every tenth is used") {
    for (const long every : {3L, 10L}) {
        CAPTURE(every);
        long damaged = 0;
        Bench b([&](const std::string& line) {
            const long number = line[0] == 'N' && !is_probe(line) ? std::atol(line.c_str() + 1) : 0;
            if (number == 0 || number % every != 0 || number == damaged) return good_answer(line);
            damaged = number;
            return fmt::format("Error:checksum mismatch, Last Line: {}\nResend: {}\nok\n", number - 1, number);
        });
        Status status = b.link.connect();
        for (int i = 1; i <= 1000 && status; ++i) {
            status = b.link.send("M400");
            if (status) status = b.link.listen_for(0);
        }
        CHECK(status.has_value() == (every == 10));
        if (!status) CHECK(holds(status.error().message, "the wire damages"));
        if (!status) CHECK(b.link.lines_sent() < 400);
    }
}
