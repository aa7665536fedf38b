// Plan, host and twin together: a job becomes G-code, the host sends it over a bad wire, and the virtual printer's
// block is held against the job.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "plan/check.hpp"
#include "plan/plan.hpp"
#include "twin/inspect.hpp"
#include "twin_bench.hpp"

using namespace pliant;

namespace {

using twin::Fault;

constexpr int width = 8, height = 6, layers = 5;

/// Left half soft, right half rigid, with a grey column between them that both share.
Result<job::Image> halves(int, int material) {
    job::Image image{width, height, std::vector<std::uint8_t>(width * height)};
    for (int i = 0; i < width * height; ++i) {
        const int x = i % width;
        const int soft = x < 4 ? 255 : (x == 4 ? 100 : 0);
        image.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(material == 0 ? soft : 255 - soft);
    }
    return image;
}

machine::Printer small_tower() {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.projector.width_px = width;
    printer.projector.height_px = height;
    return printer;
}

/// Pixels of 158.75 um: soft covers 24 + 6 * 100/255 of them, rigid the rest of 48.
job::Manifest small_job() {
    job::Manifest job;
    job.name = "halves";
    job.width_px = width;
    job.height_px = height;
    job.pixel_um = 158.75;
    job.bottom_layers = 2;
    const double pixel_mm2 = 0.15875 * 0.15875;
    const double soft_mm2 = pixel_mm2 * (24 + 6 * 100.0 / 255);
    const double rigid_mm2 = pixel_mm2 * 48 - soft_mm2;
    job.materials = {{"soft", "semi-flex", soft_mm2 * 0.25, 0, 2.5, 12},
                     {"rigid", "rigid-flex", rigid_mm2 * 0.25, 0, 2.5, 12}};
    for (int i = 0; i < layers; ++i) {
        job.layers.push_back(
            {50 * (i + 1),
             50,
             {{0, fmt::format("{}_soft.png", i), soft_mm2}, {1, fmt::format("{}_rigid.png", i), rigid_mm2}}});
    }
    return job;
}

struct Print {
    machine::Printer printer = small_tower();
    job::Manifest job = small_job();
    plan::Plan plan = plan::make_plan(job, printer).value();
    std::string gcode = plan::write_gcode(plan, job, printer);
    host::PrintRecord record;
    Status status;
    twin::Report report;

    void replace(const std::string& from, const std::string& to) {
        const std::size_t at = gcode.find(from);
        REQUIRE(at != std::string::npos);
        gcode.replace(at, from.size(), to);
    }
    void run(twin::Options options = {}) {
        app::TwinBench bench(printer, std::move(options));
        Progress silent;
        status = host::print_job(gcode, halves, bench.devices(), silent, record);
        report = twin::inspect(bench.twin(), job, halves).value();
    }
    void must_pass() const {
        CHECK_MESSAGE(status, (status ? "" : status.error().message));
        CHECK_MESSAGE(report.passed, twin::report_text(report));
    }
};

/// Counts the lines that have been written and not yet answered by an ok.
class CountingWire final : public host::Wire {
public:
    explicit CountingWire(host::Wire& wire) : wire_(wire) {}
    [[nodiscard]] Status write(std::string_view bytes) override {
        under_way_ += static_cast<int>(std::count(bytes.begin(), bytes.end(), '\n'));
        most_ = std::max(most_, under_way_);
        return wire_.write(bytes);
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        Result<std::string> said = wire_.read(timeout_s);
        for (std::size_t at = 0; said && (at = said->find("ok", at)) != std::string::npos; at += 2) --under_way_;
        return said;
    }
    [[nodiscard]] int most() const { return most_; }

private:
    host::Wire& wire_;
    int under_way_ = 0;
    int most_ = 0;
};

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a two-material job of five layers comes out right") {
    Print p;
    REQUIRE(plan::check_gcode(p.gcode, p.printer));
    p.run();
    p.must_pass();
    CHECK(p.report.layers == layers);
    CHECK(p.report.log.swaps == p.plan.swaps);
    CHECK(p.plan.swaps == 5);
    CHECK(p.report.log.bad_lines == 0);
    CHECK(p.record.resends == 0);
    REQUIRE(p.record.exposures.size() == 10);
    for (const host::Exposure& e : p.record.exposures) {
        CHECK(e.on_s == doctest::Approx(e.layer < 2 ? 12 : 2.5));
    }
    const double soft_mm3 = 0.15875 * 0.15875 * (24 + 6 * 100.0 / 255) * 0.25;
    CHECK(p.report.materials[0].cured_mm3 == doctest::Approx(soft_mm3));
    CHECK(p.report.resins[1].left_ml == doctest::Approx(700 - p.plan.vats[1].resin_ml));
}

TEST_CASE("no more lines are under way than the printer file allows") {
    const Print p;
    for (const int lines : {1, 2, 4}) {
        machine::Printer printer = p.printer;
        printer.controller.window_lines = lines;
        app::TwinBench bench(printer);
        CountingWire wire(bench.devices().wire);
        Progress silent;
        host::PrintRecord record;
        const host::Devices devices{wire, bench.devices().projector, bench.devices().clock};
        REQUIRE(host::print_job(p.gcode, halves, devices, silent, record, app::link_options(printer.controller)));
        CHECK(wire.most() == lines);
    }
}

TEST_CASE("the planned time is the machine's, but for where the axes stand when they are homed") {
    Print p;
    p.run();
    REQUIRE(p.status);
    // The plan homes from the far end. The twin starts half-way up in Z (20 s instead of 40 s), at the print position
    // in X (0 s instead of 358/8 s), half-way in Y (36.5 s instead of 73 s).
    const double homing_less = 20 + 358 / 8.0 + 36.5;
    CHECK(p.record.seconds == doctest::Approx(p.plan.seconds.total - homing_less).epsilon(0.002));
}

TEST_CASE("the print survives a damaged, a lost and an unanswered line wherever it happens") {
    long resends = 0;
    for (const auto kind : {Fault::Kind::corrupt_byte, Fault::Kind::lose_line, Fault::Kind::lose_ok}) {
        for (int n = 1; n < 220; n += 3) {
            CAPTURE(n);
            Print p;
            p.run({n % 2 == 0, 2, {{kind, n}}});
            p.must_pass();
            resends += p.record.resends;
            if (kind == Fault::Kind::lose_line && n > 1) CHECK(p.record.resends > 0);
        }
    }
    CHECK(resends > 100);
}

TEST_CASE("a storm of faults is survived too, also where a Resend is lost") {
    Print p;
    twin::Options options;
    for (int n = 3; n < 400; n += 7) options.faults.push_back({Fault::Kind::corrupt_byte, n});
    for (int n = 5; n < 400; n += 31) options.faults.push_back({Fault::Kind::lose_line, n});
    for (int n = 9; n < 400; n += 41) options.faults.push_back({Fault::Kind::lose_ok, n});
    for (int n = 2; n < 40; n += 5) options.faults.push_back({Fault::Kind::lose_resend, n});
    p.run(options);
    p.must_pass();
    CHECK(p.report.log.bad_lines > 20);
}

TEST_CASE("a restart in the middle ends the print, and the report says what is missing") {
    Print p;
    p.run({false, 2, {{Fault::Kind::reset, 150}}});
    REQUIRE_FALSE(p.status);
    CHECK(p.status.error().cause == Cause::failed);
    CHECK(holds(p.status.error().message, "restarted"));
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.missing_layers > 0);
    CHECK(p.record.exposures.size() < 10);
}

TEST_CASE("a command that the machine does not know ends the print") {
    Print p;
    p.replace("; layer 1", "M777\n; layer 1");
    p.run();
    REQUIRE_FALSE(p.status);
    CHECK(holds(p.status.error().message, "M777"));
}

TEST_CASE("a wrong order of vats shows as foreign resin") {
    Print p;
    for (std::vector<int>& images : p.plan.vat_of_image) std::swap(images[0], images[1]);
    p.gcode = plan::write_gcode(p.plan, p.job, p.printer);
    p.run();
    REQUIRE(p.status);
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.materials[0].foreign_mm3 > 0.8 * p.report.materials[0].wanted_mm3);
    CHECK(p.report.materials[0].cured_mm3 < 0.2 * p.report.materials[0].wanted_mm3);
}

TEST_CASE("a missing exposure shows") {
    Print p;
    const std::string line = ";@expose layer=3 material=1 seconds=2.500 image=3_rigid.png\n";
    p.replace(line, "");
    p.run();
    REQUIRE(p.status);
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.materials[1].missing_mm3 == doctest::Approx(p.report.materials[1].wanted_mm3 / 5));
    CHECK(p.report.materials[0].missing_mm3 == 0);
}

TEST_CASE("a wrong height shows") {
    Print p;
    p.replace("G1 Z0.150", "G1 Z0.160");
    p.run();
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.stray_layers >= 1);
}

TEST_CASE("an exposure that is too short, and one that comes twice, show") {
    Print shorter;
    shorter.replace("layer=4 material=0 seconds=2.500", "layer=4 material=0 seconds=1.500");
    shorter.run();
    CHECK_FALSE(shorter.report.passed);
    Print twice;
    const std::string line = ";@expose layer=4 material=0 seconds=2.500 image=4_soft.png\n";
    twice.replace(line, line + line);
    twice.run();
    CHECK_FALSE(twice.report.passed);
    CHECK(twice.report.pixels_lit_twice == 30);  // the grey column too: 100 + 100 + 155
}

TEST_CASE("a forbidden move is refused, stops the print and is reported") {
    Print p;
    p.replace(";@expose layer=2", "G1 X100 F600\n;@expose layer=2");
    REQUIRE_FALSE(plan::check_gcode(p.gcode, p.printer));
    p.run();
    REQUIRE_FALSE(p.status);
    CHECK(holds(p.status.error().message, "interlock"));
    CHECK_FALSE(p.report.passed);
    REQUIRE(p.report.log.violations.size() == 1);
    CHECK(holds(p.report.log.violations[0], "the platform is down"));
}

TEST_CASE("a swap without spray is noticed") {
    Print p;
    for (std::size_t at = p.gcode.find("M106 P1 S255\n"); at != std::string::npos;
         at = p.gcode.find("M106 P1 S255\n")) {
        p.gcode.erase(at, 13);
    }
    p.run();
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.log.short_cleanings == 5);
}

TEST_CASE("a job in resins that the printer does not hold prints once the vats are filled as planned") {
    Print p;
    p.job.materials[1].resin = "wax";
    p.plan = plan::make_plan(p.job, p.printer).value();
    p.gcode = plan::write_gcode(p.plan, p.job, p.printer);
    p.printer = plan::filled_printer(p.plan, p.job, p.printer);
    p.run();
    p.must_pass();
}
