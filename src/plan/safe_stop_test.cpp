#include "plan/safe_stop.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

#include "plan/check.hpp"
#include "plan/plan.hpp"
#include "plan/test_jobs.hpp"

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
        const job::Manifest job = test::make_job_for(printer, {{0, last}, {0}}, resins);
        text = write_gcode(make_plan(job, printer).value(), job, printer);
    }
    [[nodiscard]] int lines() const { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }
};

}  // namespace

TEST_CASE("property: a print can be cancelled after any line, and every vat is in its slot again") {
    for (const machine::Printer& printer : test::machines()) {
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
            if (printer.store() != machine::Store::tower) continue;
            for (const machine::Vat& vat : p.printer.vats) CHECK(end->vat_in_slot(vat.slot));
        }
    }
}

TEST_CASE("property: a print can pause after any line and goes on to its end as if nothing had been") {
    for (const machine::Printer& printer : test::machines()) {
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
