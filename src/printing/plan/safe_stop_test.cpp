#include "printing/plan/safe_stop.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "printing/machine/gcode.hpp"
#include "printing/plan/check.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/recover.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;

namespace {

constexpr int all_lines = std::numeric_limits<int>::max();

std::string first_lines(const std::string& text, int lines) {
    std::size_t end = 0;
    for (; lines > 0 && end < text.size(); --lines) end = text.find('\n', end) + 1;
    return text.substr(0, end);
}

struct Program {
    machine::Printer printer;
    std::string text;

    explicit Program(machine::Printer p) : printer(std::move(p)) {
        std::vector<std::string> resins;
        for (const machine::Vat& vat : printer.vats) resins.push_back(vat.resin);
        const int last = static_cast<int>(resins.size()) - 1;
        const job::Manifest job = plan::test::make_job_for(printer, {{0, last}, {0}}, resins);
        text = write_gcode(make_plan(job, printer).value(), job, printer);
    }
    [[nodiscard]] int lines() const { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }
};

/// Continues from a state: tries the moves and outputs of a program on it.
void run_on(machine::Interlock& state, const machine::Printer& p, const std::string& text) {
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t stop = text.find('\n', begin);
        const std::string line(machine::strip_comment(text.substr(begin, stop - begin)));
        begin = stop + 1;
        if (line.empty()) continue;
        const auto command = machine::parse_command(line).value();
        REQUIRE(state.output(command));
        if (!command.is('G', 1)) continue;
        const Status moved = state.move(machine::move_target(p, command, state.position()).value());
        REQUIRE_MESSAGE(moved, (moved ? "" : moved.error().message));
    }
}

}  // namespace

TEST_CASE("property: a print can be cancelled after any line, and every vat is then in its slot") {
    for (const machine::Printer& printer : plan::test::machines()) {
        const Program p(printer);
        for (int n = 0; n <= p.lines(); ++n) {
            CAPTURE(n);
            const std::string begun = first_lines(p.text, n);
            const machine::Interlock state = replay_gcode(begun, p.printer, all_lines).value();
            const auto end = replay_gcode(begun + cancel_program(state, p.printer), p.printer, all_lines);
            REQUIRE_MESSAGE(end, (end ? "" : end.error().message));
            CHECK_FALSE(end->pump_runs());
            const auto up_um = p.printer.axis(machine::Axis::platform).home_um();
            if (state.homed(machine::Axis::platform)) CHECK(end->position()[machine::Axis::platform] == up_um);
            if (!printer.has_carriage()) continue;
            for (const machine::Vat& vat : p.printer.vats) CHECK(end->vat_in_slot(vat.slot));
        }
    }
}

TEST_CASE("property: a print can pause after any line and continue to the same end") {
    for (const machine::Printer& printer : plan::test::machines()) {
        const Program p(printer);
        for (int n = 0; n <= p.lines(); ++n) {
            CAPTURE(n);
            const std::string begun = first_lines(p.text, n);
            const machine::Interlock state = replay_gcode(begun, p.printer, all_lines).value();
            const Pause pause = pause_program(state, p.printer);
            const auto waiting = replay_gcode(begun + pause.begin, p.printer, all_lines);
            REQUIRE_MESSAGE(waiting, (waiting ? "" : waiting.error().message));
            const std::string all = begun + pause.begin + pause.end + p.text.substr(begun.size());
            const Status status = check_gcode(all, p.printer);
            REQUIRE_MESSAGE(status, (status ? "" : status.error().message));
        }
    }
}

TEST_CASE("property: from any state that manual control allows, the machine can be stopped safely") {
    std::mt19937 random(77);
    for (const machine::Printer& p : plan::test::machines()) {
        for (int walk = 0; walk < 60; ++walk) {
            machine::Interlock state(p);
            for (const machine::Axis axis : machine::homing_order(p)) REQUIRE(state.home(axis));
            for (int step = 0; step < 60; ++step) {
                machine::Position to = state.position();
                const int slot = 1 + static_cast<int>(random() % static_cast<unsigned>(p.slot_count()));
                const int x[] = {p.carriage.print_um, p.carriage.print_um + p.carriage.shear_um,
                                 p.drain_begin_um(),  p.carriage.tower_um - p.carriage.back_off_um,
                                 p.carriage.tower_um, static_cast<int>(random() % 300000)};
                const int z[] = {100, p.clear_um(0), p.axis(machine::Axis::platform).home_um()};
                const bool at_wall = p.store() == machine::Store::wall && random() % 2 == 0;
                const int level_um = p.has_carriage() ? (at_wall ? p.row_um(slot) : p.level_um(slot)) : 0;
                const int low_um = level_um - (at_wall ? p.wall.lift_off_um : p.hooks.travel_um);
                switch (random() % 9) {
                    case 0:
                        to[machine::Axis::platform] = z[random() % 3];
                        break;
                    case 1:
                        if (p.has_carriage()) to[machine::Axis::carriage] = x[random() % 6];
                        break;
                    case 2:
                        if (p.has_carriage()) to[machine::Axis::tower] = low_um;
                        break;
                    case 3:
                        if (p.has_carriage()) to[machine::Axis::tower] = level_um;
                        break;
                    case 4:
                        if (p.has_table()) to[machine::Axis::table] = at_wall ? p.column_um(slot) : p.station_um(slot);
                        break;
                    case 5:
                        if (p.store() == machine::Store::wall) (void)state.fork(random() % 2 == 0);
                        break;
                    case 6:
                        if (p.hooks.magnet.present()) (void)state.magnet(random() % 2 == 0);
                        break;
                    case 7:
                        if (p.has_carriage()) (void)state.home(machine::Axis::tower);
                        break;
                    default:
                        (void)state.pump(random() % 2 == 0);
                }
                (void)state.move(to);
            }
            const std::string end = cancel_program(state, p);
            CAPTURE(end);
            machine::Interlock copy = state;
            run_on(copy, p, end);
            if (!p.has_carriage()) continue;
            // A manual operation may have put a vat into another slot.
            std::size_t stored = 0;
            for (int slot = 1; slot <= p.slot_count(); ++slot) stored += copy.vat_in_slot(slot) ? 1 : 0;
            CHECK(stored == p.vats.size());
        }
    }
}

TEST_CASE("a tower that was homed while its vat was out takes that vat back") {
    int towers = 0;
    for (const machine::Printer& p : plan::test::machines()) {
        if (p.store() != machine::Store::tower) continue;
        machine::Interlock out(p);
        for (const machine::Axis axis : machine::homing_order(p)) REQUIRE(out.home(axis));
        const int slot = p.vats.back().slot;
        run_on(out, p, vat_program(out, p, slot).value());
        REQUIRE(out.hooked_vat());
        if (!out.home(machine::Axis::tower)) continue;
        ++towers;
        machine::Interlock cancelled = out, put_away = out;
        run_on(cancelled, p, cancel_program(out, p));
        CHECK(cancelled.vat_in_slot(slot));
        run_on(put_away, p, vat_program(out, p, 0).value());
        CHECK(put_away.vat_in_slot(slot));
    }
    CHECK(towers > 0);
}
