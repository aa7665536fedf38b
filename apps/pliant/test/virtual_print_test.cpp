// Prints on the virtual printer with the engine for real machines: prompts, pauses, the door, interlocks, guard,
// cancelling.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "halves.hpp"
#include "printing/plan/plan.hpp"
#include "virtual_bench.hpp"

using namespace pliant;
using namespace pliant::app;
using pliant::test::holds;
using rehearse::VirtualPrint;

namespace {

constexpr int layers = 5;

struct Bench {
    machine::Printer printer = machine::load_printer("examples/printers/tower.toml").value();
    job::Manifest job = halves::job({layers});
    std::vector<host::Refill> refills;
    std::string gcode;

    Bench() {
        printer.projector.width_px = halves::width_px;
        printer.projector.height_px = halves::height_px;
    }
    Printed run(rehearse::Options options = {}) {
        gcode = plan::write_gcode(plan::make_plan(job, printer).value(), job, printer);
        host::PrintJob ready = print_job(job, gcode, halves::image);
        ready.refills = refills;
        Printed printed(printer, job, std::move(ready), halves::image, std::move(options));
        const bool told = printed.status || !printed.status.error().message.empty();
        CHECK(told);
        return printed;
    }
};

/// The kinds of the journal's records, in order, restricted to those named.
std::string kinds(const Printed& printed, const std::vector<std::string>& wanted) {
    std::string text;
    const std::vector<host::JournalRecord> records = printed.print->records().value();
    for (const host::JournalRecord& record : records) {
        if (std::find(wanted.begin(), wanted.end(), record.kind) != wanted.end()) text += record.kind + " ";
    }
    return text;
}

const host::JournalRecord* first(const std::vector<host::JournalRecord>& records, const std::string& kind) {
    const auto found = std::find_if(records.begin(), records.end(), [&](auto& r) { return r.kind == kind; });
    return found == records.end() ? nullptr : &*found;
}

/// Acts once, at a given point of the print.
rehearse::Options when(std::function<bool(const host::Snapshot&)> reached, std::function<Status(host::Control&)> act) {
    rehearse::Options options;
    options.meanwhile = [reached = std::move(reached), act = std::move(act), done = false](host::Control& c) mutable {
        if (done || !reached(c.snapshot())) return;
        done = true;
        CHECK(act(c));
    };
    return options;
}

bool in_the_light_of_layer_2(const host::Snapshot& s) {
    return s.lit && s.layer == 2 && s.lit_s > 0.5;
}

struct CancelAfter final : Progress {
    explicit CancelAfter(int n) : left(n) {}
    [[nodiscard]] bool cancelled() const override { return --left < 0; }
    mutable int left;
};

}  // namespace

TEST_CASE("a virtual print keeps the same journal as a real one: session, permissions, exposures, end") {
    Bench b;
    const Printed printed = b.run();
    REQUIRE(printed.status);
    CHECK(printed.report.passed);
    const auto records = printed.print->records().value();
    CHECK(records.front().kind == "begin");
    CHECK(*records.front().find("digest") == host::job_digest(b.gcode));
    CHECK(records[1].kind == "session");
    CHECK(*records[1].find("boot") == "virtual");
    CHECK(records.back().kind == "end");
    CHECK(std::count_if(records.begin(), records.end(), [](auto& r) { return r.kind == "light"; }) == 2 * layers);
    CHECK(first(records, "go") != nullptr);
    CHECK(first(records, "pause") == nullptr);
}

TEST_CASE("resin that is asked for during a virtual print is filled in, and the journal holds the request") {
    Bench b;
    const double layer_ml = halves::soft_mm2 * 0.05 / 1000;
    const Printed whole = b.run();
    // A vat with just enough resin for two layers.
    machine::Vat& vat = b.printer.vats.front();
    vat.fill_ml = b.printer.vat_shape.least_ml + 2.2 * layer_ml;
    const auto plan = plan::make_plan(b.job, b.printer).value();
    REQUIRE_FALSE(plan.refills.empty());
    const Printed dry = b.run();
    REQUIRE(dry.status);  // nobody is asked
    for (const plan::RefillBefore& refill : plan.refills)
        b.refills.push_back({refill.layer, refill.slot, fmt::format("refill slot {}", refill.slot)});
    const Printed filled = b.run();
    REQUIRE(filled.status);
    CHECK_MESSAGE(filled.report.passed, twin::report_text(filled.report));
    const auto count = static_cast<long>(plan.refills.size());
    const auto records = filled.print->records().value();
    CHECK(std::count_if(records.begin(), records.end(), [](auto& r) { return r.kind == "pause"; }) == count);
    CHECK(std::count_if(records.begin(), records.end(), [](auto& r) { return r.kind == "resume"; }) == count);
    const host::JournalRecord* pause = first(records, "pause");
    REQUIRE(pause != nullptr);
    CHECK(*pause->find("asked") == "refill slot 1");
    CHECK(filled.report.resins[0].left_ml > dry.report.resins[0].left_ml);
    CHECK(filled.lights() == whole.lights());
}

TEST_CASE("all requests before one layer are answered in one pause") {
    Bench b;
    const std::string text = "refill the vat of slot 1; refill the vat of slot 2";
    b.refills = {{2, 1, text}, {2, 2, text}, {4, 1, "refill the vat of slot 1"}};
    const Printed printed = b.run();
    REQUIRE(printed.status);
    CHECK(printed.report.passed);
    CHECK(kinds(printed, {"pause", "resume"}) == "pause resume pause resume ");
    const Printed plain = Bench().run();
    for (const std::size_t resin : {0, 1})
        CHECK(printed.report.resins[resin].left_ml > plain.report.resins[resin].left_ml);
}

TEST_CASE("a fixed vat that is refilled many times in a row never ends below its least") {
    Bench b;
    b.printer = machine::load_printer("examples/printers/single.toml").value();
    b.printer.projector.pixel_um = halves::pixel_um;
    b.printer.projector.width_px = halves::width_px;
    b.printer.projector.height_px = halves::height_px;
    b.job.materials.pop_back();
    for (job::Layer& layer : b.job.layers) layer.images.pop_back();
    b.printer.vats.front().fill_ml = b.printer.vat_shape.least_ml + 1.2 * halves::soft_mm2 * 0.05 / 1000;
    const auto plan = plan::make_plan(b.job, b.printer).value();
    REQUIRE(plan.refills.size() == layers - 1);
    for (const plan::RefillBefore& refill : plan.refills)
        b.refills.push_back({refill.layer, refill.slot, "refill the vat"});
    const Printed printed = b.run();
    REQUIRE(printed.status);
    CHECK_MESSAGE(printed.report.passed, twin::report_text(printed.report));
    CHECK(printed.report.resins[0].left_ml >= b.printer.vat_shape.least_ml);
}

TEST_CASE("after a pause during an exposure the rest of the exposure is given") {
    Bench b;
    const Printed printed =
        b.run(when(in_the_light_of_layer_2, [](host::Control& c) { return c.pause(host::PauseWhen::now); }));
    REQUIRE(printed.status);
    CHECK_MESSAGE(printed.report.passed, twin::report_text(printed.report));
    CHECK(printed.lights() == 2 * layers + 1);
    CHECK(kinds(printed, {"pause", "resume"}) == "pause resume ");
    const auto records = printed.print->records().value();
    CHECK(first(records, "pause")->find("asked") == nullptr);
    CHECK(std::any_of(records.begin(), records.end(),
                      [](auto& r) { return r.kind == "dark" && *r.find("done") == "0"; }));
}

TEST_CASE("door opened during an exposure: dark, no motion until it is shut, then the rest of the exposure") {
    Bench b;
    b.printer.door.input = "y_max";
    rehearse::Options options;
    options.printer.faults = {{twin::Fault::Kind::door_open, 5, 40}};
    const Printed printed = b.run(std::move(options));
    REQUIRE(printed.status);
    CHECK_MESSAGE(printed.report.passed, twin::report_text(printed.report));
    CHECK(printed.report.log.lit_while_open_s > 0);
    CHECK(printed.report.log.lit_while_open_s < 0.5);
    CHECK(kinds(printed, {"door", "pause", "resume"}) == "door pause resume door ");
    CHECK(holds(*first(printed.print->records().value(), "pause")->find("asked"), "the door is open"));
}

TEST_CASE("a dead limit switch ends the virtual print with the reason") {
    Bench b;
    rehearse::Options options;
    options.printer.faults = {{twin::Fault::Kind::dead_switch, 2}};
    const Printed printed = b.run(std::move(options));
    REQUIRE_FALSE(printed.status);
    CHECK(printed.status.error().cause == Cause::failed);
    CHECK(holds(printed.status.error().message, "homing failed"));
    CHECK(kinds(printed, {"stop", "end"}) == "stop ");
    CHECK(printed.lights() == 0);
}

TEST_CASE("a virtual print cancelled anywhere parks: no vat on the hooks, pump off, no forbidden move") {
    for (const int looks : {0, 50, 400, 900, 1500}) {
        CAPTURE(looks);
        Bench b;
        b.gcode = plan::write_gcode(plan::make_plan(b.job, b.printer).value(), b.job, b.printer);
        const auto print = VirtualPrint::make(b.printer, print_job(b.job, b.gcode, halves::image), {}).value();
        CancelAfter cancel(looks);
        const Status status = print->print(cancel);
        REQUIRE_FALSE(status);
        CHECK(status.error().cause == Cause::cancelled);
        const auto records = print->records().value();
        // While it connects, there is nothing to be cancelled.
        if (looks > 0) REQUIRE_FALSE(records.empty());
        if (!records.empty()) CHECK(records.back().kind == "cancel");
        CHECK_FALSE(print->twin().interlock().hooked_vat());
        CHECK_FALSE(print->twin().interlock().pump_runs());
        CHECK(print->twin().log().violations.empty());
        CHECK(print->lights().size() < 2 * layers);
    }
}

TEST_CASE("the guard is told of every exposure, and knows how long it lasted if the host died") {
    machine::Printer printer = machine::load_printer("examples/printers/tower.toml").value();
    twin::Twin twin(printer);
    rehearse::TwinGuard guard(twin);
    REQUIRE(guard.announced(7));
    guard.lit(twin.now());
    twin.advance_to(1.5);
    CHECK_FALSE(guard.lit_s(7));  // the host is alive
    guard.host_died();
    CHECK(guard.lit_s(7).value() == near(1.5, {.relative = 1e-12}));
    CHECK_FALSE(guard.lit_s(8));
    REQUIRE(guard.announced(9));
    guard.host_died();
    CHECK(guard.lit_s(9).value() == 0);
}

TEST_CASE("the command after a layer is called once for every layer") {
    Bench b;
    std::vector<int> seen;
    rehearse::Options options;
    options.after_layer = [&](int layer) { seen.push_back(layer); };
    const Printed printed = b.run(std::move(options));
    REQUIRE(printed.status);
    CHECK(seen == std::vector<int>{0, 1, 2, 3, 4});
}
