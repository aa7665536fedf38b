// A virtual print is interrupted after any record of its journal and its machine is discarded; another one is restored
// to that state, and the print continues: the part equals that of an undisturbed print.
#include "printing/rehearse/replay.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "halves.hpp"
#include "printing/host/control.hpp"
#include "printing/operate/programs.hpp"
#include "printing/plan/plan.hpp"
#include "virtual_bench.hpp"

using namespace pliant;
using namespace pliant::app;
using pliant::test::holds;

namespace {

constexpr int layers = 4;

/// Exposure that was not journaled did not take place.
class NoLight final : public host::Guard {
public:
    Status announced(long light) override {
        last_ = light;
        return {};
    }
    void lit(double) override {}
    void dark(double) override {}
    [[nodiscard]] std::optional<double> lit_s(long light) override {
        return light == last_ ? std::nullopt : std::optional(0.0);
    }
    void forget() override { last_ = 0; }

private:
    long last_ = 0;
};

struct Bench {
    const pliant::test::Folder folder;
    machine::Printer printer;
    job::Manifest job = halves::job({layers});
    host::PrintJob ready;
    std::filesystem::path journal = folder / "halves.journal";

    explicit Bench(const char* file) : printer(machine::load_printer(file).value()) {
        printer.projector.pixel_um = halves::pixel_um;
        printer.projector.width_px = halves::width_px;
        printer.projector.height_px = halves::height_px;
        job.materials[0].resin = printer.vats.front().resin;
        job.materials[1].resin = printer.vats.back().resin;
        ready = print_job(job, plan::write_gcode(plan::make_plan(job, printer).value(), job, printer), halves::image);
    }
    /// The journal's first `count` records as text, as a program that was killed leaves them.
    [[nodiscard]] static std::string text_of(const std::vector<host::JournalRecord>& records, std::size_t count) {
        std::string text;
        for (std::size_t i = 0; i < count; ++i)
            text += host::write_record(records[i].number, records[i].kind, records[i].values);
        return text;
    }
    [[nodiscard]] std::vector<host::JournalRecord> records() const {
        return host::parse_journal(read_file(journal).value(), "journal").value().records;
    }
    /// Another twin continues from the journal, and the part is inspected.
    [[nodiscard]] twin::Report gone_on() {
        twin::Twin twin(printer);
        const Status replayed = rehearse::replay(records(), ready, twin);
        REQUIRE_MESSAGE(replayed.has_value(), (replayed ? "" : replayed.error().message));
        rehearse::TwinProjector projector(twin);
        rehearse::TwinClock clock(twin);
        NoLight guard;
        host::ControlSetup setup{.printer = printer,
                                 .open_wire = [&]() -> Result<std::unique_ptr<host::Wire>> {
                                     return std::make_unique<rehearse::TwinWire>(twin);
                                 },
                                 .projector = projector,
                                 .clock = clock,
                                 .programs = operate::programs_of(printer),
                                 .link = operate::link_options(printer.controller),
                                 .guard = &guard,
                                 .clock_name = "virtual"};
        host::Control control(std::move(setup));
        host::PrintJob job_here = ready;
        job_here.journal = journal;
        job_here.sync_journal = false;
        REQUIRE(control.load(job_here).has_value());
        control.serve_until_idle();
        CHECK(control.snapshot().can_resume);
        REQUIRE(control.start({true, {}}).has_value());
        control.serve_until_idle();
        const host::Snapshot end = control.snapshot();
        REQUIRE_MESSAGE(end.finished, end.message);
        for (const auto& violation : twin.log().violations) FAIL_CHECK(violation);
        return twin::inspect(twin, job, twin::ImageSource(halves::image)).value();
    }
};

/// Interrupts an undisturbed print after every n-th record.
void break_off_everywhere(const char* file, std::size_t every) {
    Bench b(file);
    const Printed whole(b.printer, b.job, b.ready, halves::image);
    REQUIRE_MESSAGE(whole.status.has_value(), (whole.status ? "" : whole.status.error().message));
    CHECK(whole.report.passed);
    const std::vector<host::JournalRecord> all = whole.print->records().value();
    std::size_t tried = 0;
    for (std::size_t count = 3; count < all.size(); count += every) {
        CAPTURE(count);
        CAPTURE(all[count - 1].kind);
        REQUIRE(write_file(b.journal, Bench::text_of(all, count)).has_value());
        CHECK(b.gone_on().passed);
        ++tried;
    }
    CHECK(tried > 5);
}

}  // namespace

TEST_CASE("on the tower a print resumes from wherever it was broken off") {
    break_off_everywhere("examples/printers/tower.toml", 5);
}

TEST_CASE("on other kinds of machine, or broken off twice, a print resumes too") {
    for (const std::string name : {"linear", "single", "wall", "rotary", "tower_magnet"}) {
        CAPTURE(name);
        break_off_everywhere((("examples/printers/" + name + ".toml").c_str()), 4);
    }
    Bench b("examples/printers/tower.toml");
    const Printed whole(b.printer, b.job, b.ready, halves::image);
    const std::vector<host::JournalRecord> all = whole.print->records().value();
    const std::size_t first = all.size() / 3;
    for (std::size_t further = 3; further < 60; further += 4) {
        CAPTURE(further);
        REQUIRE(write_file(b.journal, Bench::text_of(all, first)).has_value());
        CHECK(b.gone_on().passed);
        // The journal now has two sessions; it is torn again in the second.
        const std::vector<host::JournalRecord> twice = b.records();
        REQUIRE(twice.size() > first + further);
        REQUIRE(write_file(b.journal, Bench::text_of(twice, first + further)).has_value());
        CHECK(b.gone_on().passed);
    }
}

TEST_CASE("replay: a journal of another job is refused; one that ends before anything began moves nothing") {
    Bench b("examples/printers/tower.toml");
    const Printed whole(b.printer, b.job, b.ready, halves::image);
    const std::vector<host::JournalRecord> all = whole.print->records().value();
    const std::vector<host::JournalRecord> half(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
    twin::Twin twin(b.printer);
    host::PrintJob other = b.ready;
    other.digest = "0000000000000000";
    CHECK(holds(rehearse::replay(half, other, twin).error().message, "another job"));
    CHECK(twin.now() == 0);
    const std::vector<host::JournalRecord> begin(all.begin(), all.begin() + 2);
    CHECK(rehearse::replay(begin, b.ready, twin).has_value());
    CHECK(twin.now() == 0);
}
