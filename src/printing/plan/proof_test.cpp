#include "printing/plan/proof.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <functional>

#include "base/core/test_text.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;
using pliant::test::holds;

namespace {

/// A job, its plan and its program, for the tests to modify.
struct Case {
    machine::Printer printer;
    job::Manifest job;
    Plan plan;
    std::string gcode;

    [[nodiscard]] std::string error() const {
        const Status status = prove_program(gcode, plan, job, printer);
        return status ? "" : status.error().message;
    }
};

Case case_of(machine::Printer printer, const std::vector<std::vector<int>>& layers,
             const std::vector<std::string>& resins) {
    Case c{std::move(printer), {}, {}, {}};
    c.job = plan::test::make_job_for(c.printer, layers, resins);
    c.plan = make_plan(c.job, c.printer).value();
    c.gcode = write_gcode(c.plan, c.job, c.printer);
    return c;
}

/// Resins of the printer's first vats.
std::vector<std::string> first_resins(const machine::Printer& printer, std::size_t count) {
    std::vector<std::string> resins;
    for (std::size_t v = 0; v < count; ++v) resins.push_back(printer.vats[v % printer.vats.size()].resin);
    return resins;
}

Case two_materials() {
    const machine::Printer tower = plan::test::tower();
    return case_of(tower, {{0}, {0, 1}, {0, 1}, {1}, {0}}, {tower.vats[0].resin, tower.vats[1].resin});
}

/// Changes the `nth` line that begins with `begin`; `change` gets the whole line without its end.
void change_line(std::string& gcode, const std::string& begin, int nth,
                 const std::function<std::string(std::string)>& change) {
    std::size_t at = 0;
    for (int seen = 0; at < gcode.size(); ++seen) {
        while (at < gcode.size() && gcode.compare(at, begin.size(), begin) != 0) at = gcode.find('\n', at) + 1;
        REQUIRE(at < gcode.size());
        const std::size_t end = gcode.find('\n', at);
        if (seen == nth) {
            gcode.replace(at, end - at, change(gcode.substr(at, end - at)));
            return;
        }
        at = end + 1;
    }
    FAIL("no such line: " << begin);
}

}  // namespace

TEST_CASE("the planner's G-code passes the proof on every machine, for every job") {
    for (const machine::Printer& printer : plan::test::machines()) {
        CAPTURE(printer.name);
        const std::size_t n = std::min<std::size_t>(3, printer.vats.size());
        std::vector<std::vector<int>> layers = {{0}, {}, {0}};
        for (int m = 0; m < 3; ++m) layers.push_back({m});
        layers.insert(layers.end(), {{0, 1}, {1, 2}, {0, 1, 2}, {2}});
        CHECK(case_of(printer, layers, first_resins(printer, std::max<std::size_t>(3, n))).error() == "");
        CHECK(case_of(printer, {}, first_resins(printer, 1)).error() == "");
    }
}

TEST_CASE("the proof accepts given exposures, refills, long and short cleaning, and resins filled in") {
    Case c = two_materials();
    c.job.layers[1].images[1].exposure_s = 7.1234;
    c.job.bottom_layers = 1;
    for (job::Layer& layer : c.job.layers) layer.images.front().area_mm2 = 5e6;  // 250 ml a layer
    c.printer.cleaning.spray_s = 95;
    c.printer.cleaning.pairs = {{c.printer.vats[0].resin, c.printer.vats[1].resin, 1.5, 0}};
    c.plan = make_plan(c.job, c.printer).value();
    c.gcode = write_gcode(c.plan, c.job, c.printer);
    CHECK(!c.plan.refills.empty());
    CHECK(c.error() == "");
    CHECK(case_of(plan::test::tower(), {{0, 1}, {0, 1}}, {"glue", "jelly"}).error() == "");
    machine::Printer still = plan::test::tower();
    still.cleaning.stroke_x_um = still.cleaning.stroke_z_um = 0;
    still.cleaning.dry_s = 3;
    still.fans.clear();
    CHECK(case_of(still, {{0, 1}, {0, 1}}, first_resins(still, 2)).error() == "");
}

TEST_CASE("the proof finds an exposure missing, repeated, too long, too short or of another image") {
    const Case good = two_materials();
    REQUIRE(good.error() == "");
    const auto changed = [&](const std::function<std::string(std::string)>& change) {
        Case c = good;
        change_line(c.gcode, ";@expose", 3, change);
        return c.error();
    };
    const auto with = [](const char* what, const char* instead) {
        return [=](std::string line) { return line.replace(line.find(what), std::string(what).size(), instead); };
    };
    CHECK(holds(changed([](const std::string&) { return std::string(); }), "layer 3: the exposure of \""));
    CHECK(holds(changed([](const std::string& line) { return line + "\n" + line; }), "a second time"));
    CHECK(holds(changed(with("seconds=12.000", "seconds=11.990")), "lasts 11.99 s, the manifest says 12 s"));
    CHECK(holds(changed(with("seconds=12.000", "seconds=24.000")), "lasts 24 s"));
    CHECK(holds(changed(with("layers/2", "layers/1")), "shows layers/1_"));
    CHECK(holds(changed(with("layer=2", "layer=1")), "layer 2: "));
    CHECK(holds(changed(with("layer=2", "layer=77")), "the job has 5 layers"));
    CHECK(holds(changed(with("material=", "material=4")), "is in this layer"));
    CHECK(changed(with("layer=2", "layer=1")).starts_with("G-code line "));
}

TEST_CASE("the proof finds a vat put away with the part too high for its brush") {
    Case c = two_materials();
    // The way up for the first swap, with two layers of part: a brush reaches the part 1 mm above the rim, at 82.55 mm.
    change_line(c.gcode, "G1 Z83.650", 0, [](std::string line) { return line.replace(4, 6, "84.650"); });
    CHECK(holds(c.error(), "is put away with the part 2 mm above its rim, its brush reaches 1 mm"));
    CHECK(holds(c.error(), "layer 2: "));
    Case bare = two_materials();
    bare.printer.cleaning.brush = false;
    CHECK(holds(bare.error(), "the platform is down"));  // without a brush the part must not pass this low
}

TEST_CASE("the proof finds a wrong height, and a missing lift, rest, stroke or approach") {
    const machine::Printer tower = plan::test::tower();
    const Case good = case_of(tower, {{0}, {0}, {0}}, {tower.vats[0].resin});
    const auto changed = [&](const std::string& begin, int nth, const std::function<std::string(std::string)>& change) {
        Case c = good;
        change_line(c.gcode, begin, nth, change);
        return c.error();
    };
    const auto dropped = [](const std::string&) { return std::string(); };
    CHECK(holds(changed("G1 Z0.100", 0, [](std::string l) { return l.replace(0, 9, "G1 Z0.070"); }),
                "layer 2: exposure of \"m0\": the platform stands at 0.070 mm, the layer's height is 0.100 mm"));
    CHECK(holds(changed("G1 Z0.100", 0, [](const std::string&) { return "G1 Z0.100 F6000.0"; }), "goes down faster"));
    const std::string lift = fmt::format("G1 Z{:.3f}", (50 + tower.platform.lift_um) / 1000.0);
    CHECK(holds(changed(lift, 0, dropped), "layer 1: the platform lifts"));
    CHECK(holds(changed(lift, 0, [](const std::string& l) { return l.substr(0, l.find('F')) + "F9000.0"; }),
                "peels the layer faster"));
    if (tower.carriage.shear_um > 0) {
        const std::string shear =
            fmt::format("G1 X{:.3f}", (tower.carriage.print_um + tower.carriage.shear_um) / 1000.0);
        CHECK(holds(changed(shear, 1, dropped), "layer 2: the carriage moves 0 mm aside"));
    }
    if (tower.platform.settle_s > 0) CHECK(holds(changed("G4", 0, dropped), "the resin rests for 0 s"));
    machine::Printer slow = tower;
    slow.projector.delay_s = 0.7;
    Case late = case_of(slow, {{0}, {0}}, {tower.vats[0].resin});
    CHECK(late.error() == "");
    change_line(late.gcode, "G4 P700", 0, dropped);
    CHECK(holds(late.error(), "the projector is dark after 0.7 s"));
}

TEST_CASE("the proof finds cleaning left out, cut short, or without its strokes") {
    const Case good = two_materials();
    const auto cleaned = [&](const std::function<void(std::vector<std::string>&)>& change) {
        Case c = good;
        const std::size_t begin = c.gcode.rfind("; 3 oscillate"), end = c.gcode.find("M400", begin);
        std::vector<std::string> lines;
        for (std::size_t at = begin; at < end; at = c.gcode.find('\n', at) + 1)
            lines.push_back(c.gcode.substr(at, c.gcode.find('\n', at) - at));
        change(lines);
        std::string text;
        for (const std::string& line : lines) text += line + "\n";
        c.gcode.replace(begin, end - begin, text);
        return c.error();
    };
    CHECK(cleaned([](auto&) {}) == "");
    CHECK(holds(cleaned([](auto& lines) { lines.erase(lines.begin() + 3, lines.begin() + 7); }),
                "the part is cleaned for"));
    CHECK(holds(cleaned([](auto& lines) {
                    for (std::size_t i = 1; i + 3 < lines.size(); ++i) lines[i] = "G4 P900";
                }),
                "hangs still"));
    CHECK(holds(cleaned([](auto& lines) { lines.emplace_back("G4 P60000"); }), "the part "));
    Case c = good;
    change_line(c.gcode, good.printer.pump.on, 0, [](const std::string&) { return std::string(); });
    CHECK(holds(c.error(), "the part is cleaned for 0.0 s"));
    c = good;
    change_line(c.gcode, good.printer.pump.on, 0, [](const std::string&) { return "M106 P1 S20"; });
    CHECK(holds(c.error(), "not set as the printer file says"));
    c = good;
    for (std::size_t f = 0; f < good.printer.fans.size(); ++f)
        change_line(c.gcode, good.printer.fans[f].on, 0, [](const std::string&) { return std::string(); });
    CHECK(holds(c.error(), "is not dried"));
    c = good;
    change_line(c.gcode, ";@stop", 0, [](const std::string&) { return std::string(); });
    CHECK(holds(c.error(), "has no line \";@stop"));
    c = good;
    change_line(c.gcode, ";@stop", 0, [](const std::string&) { return ";@stop M84"; });
    CHECK(holds(c.error(), "switches nothing"));
}

TEST_CASE("the proof finds a program cut anywhere before the part is clean and clear") {
    const Case good = two_materials();
    std::vector<std::size_t> ends = {0};
    for (std::size_t at = good.gcode.find('\n'); at != std::string::npos; at = good.gcode.find('\n', at + 1))
        ends.push_back(at + 1);
    int passed = 0;
    for (const std::size_t end : ends) {
        Case c = good;
        c.gcode.resize(end);
        if (c.error().empty()) ++passed;
    }
    CHECK(passed <= 6);  // the comment, the platform's way up and the fence at the end, the carriage's way back
    Case c = good;
    c.gcode.resize(good.gcode.find('\n', good.gcode.size() / 2) + 1);
    CHECK(holds(c.error(), "the last: layer "));
}

TEST_CASE("the proof finds vats with the wrong resins, and vats that run dry") {
    Case c = two_materials();
    std::swap(c.printer.vats[0].resin, c.printer.vats[1].resin);
    c.plan = make_plan(c.job, c.printer).value();
    CHECK(holds(c.error(), "layer 1: exposure of \"m0\": over the vat of slot 1"));
    c = two_materials();
    c.printer.vats[2].resin = c.printer.vats[0].resin;  // the plan changes to the second vat, the program does not
    for (job::Layer& layer : c.job.layers) layer.images.front().area_mm2 = 5e6;
    c.plan = make_plan(c.job, c.printer).value();
    CHECK(holds(c.error(), "has run dry"));
}

TEST_CASE("the proof accepts G-code that another program has rewritten with the same meaning") {
    Case c = two_materials();
    std::string text = "G21\n";
    int number = 0;
    for (std::size_t at = 0; at < c.gcode.size(); at = c.gcode.find('\n', at) + 1) {
        std::string line = c.gcode.substr(at, c.gcode.find('\n', at) - at);
        if (line.starts_with("; ")) continue;
        if (line.starts_with("G1 ")) line = fmt::format("N{} G0{}*9\nM114", ++number, line.substr(2));
        text += line + "\n";
    }
    c.gcode = text;
    CHECK(c.error() == "");
}

TEST_CASE("a job of 2,000 layers and 4,000 swaps is proved in well under a second") {
    const machine::Printer tower = plan::test::tower();
    const Case c = case_of(tower, std::vector<std::vector<int>>(2000, {0, 1}), first_resins(tower, 2));
    const auto begin = std::chrono::steady_clock::now();
    CHECK(c.error() == "");
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    MESSAGE(std::count(c.gcode.begin(), c.gcode.end(), '\n') << " lines in " << seconds << " s");
    CHECK(seconds < 10);  // generous, for a busy machine
}
