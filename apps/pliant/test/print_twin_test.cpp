// Plan, host and twin together: a job becomes G-code, the host sends it over a bad wire, and the virtual printer's
// block is compared with the job.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "halves.hpp"
#include "printing/operate/programs.hpp"
#include "printing/plan/check.hpp"
#include "printing/plan/plan.hpp"
#include "printing/twin/inspect.hpp"
#include "virtual_bench.hpp"

using namespace pliant;
using pliant::test::holds;

namespace {

using twin::Fault;

using app::halves::height_px;
using app::halves::image;
using app::halves::width_px;

constexpr int layers = 5;
constexpr std::array both_releases = {machine::MarlinRelease::v2_1_1, machine::MarlinRelease::v2_1_2};

machine::Printer small_tower() {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.projector.width_px = width_px;
    printer.projector.height_px = height_px;
    return printer;
}

struct Print {
    machine::Printer printer = small_tower();
    job::Manifest job = app::halves::job({});
    plan::Plan plan = plan::make_plan(job, printer).value();
    std::string gcode = plan::write_gcode(plan, job, printer);
    std::unique_ptr<rehearse::VirtualPrint> print;  ///< once it has run
    Status status;
    twin::Report report;

    void replace(const std::string& from, const std::string& to) {
        const std::size_t at = gcode.find(from);
        REQUIRE(at != std::string::npos);
        gcode.replace(at, from.size(), to);
    }
    void run(twin::Options options = {}) {
        rehearse::Options wanted;
        wanted.printer = std::move(options);
        run(std::move(wanted));
    }
    void run(rehearse::Options options) {
        app::Printed printed(printer, job, app::print_job(job, gcode, image), image, std::move(options));
        print = std::move(printed.print);
        status = std::move(printed.status);
        report = std::move(printed.report);
    }
    [[nodiscard]] long resends() const { return print->snapshot().resends; }
    void must_pass() const {
        CHECK_MESSAGE(status, (status ? "" : status.error().message));
        CHECK_MESSAGE(report.passed, twin::report_text(report));
    }
};

/// Counts the lines sent and not yet acknowledged by an ok.
class CountingWire final : public host::Wire {
public:
    CountingWire(std::unique_ptr<host::Wire> wire, int& most) : wire_(std::move(wire)), most_(most) {}
    [[nodiscard]] Status write(std::string_view bytes) override {
        for (std::size_t i = 1; i < bytes.size(); ++i) under_way_ += bytes[i] == '\n' && bytes[i - 1] != '\n' ? 1 : 0;
        most_ = std::max(most_, under_way_);
        return wire_->write(bytes);
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        Result<std::string> said = wire_->read(timeout_s);
        for (std::size_t at = 0; said && (at = said->find("ok", at)) != std::string::npos; at += 2)
            under_way_ -= at == 0 || (*said)[at - 1] == '\n' ? 1 : 0;  // not the echo of a fence, `tok 7`
        return said;
    }

private:
    std::unique_ptr<host::Wire> wire_;
    int under_way_ = 0;
    int& most_;
};

}  // namespace

TEST_CASE("a two-material job of five layers prints and passes the inspection") {
    Print p;
    REQUIRE(plan::check_gcode(p.gcode, p.printer));
    p.run();
    p.must_pass();
    CHECK(p.report.layers == layers);
    CHECK(p.report.log.swaps == p.plan.swaps);
    CHECK(p.plan.swaps == 5);
    CHECK(p.report.log.bad_lines == 0);
    CHECK(p.resends() == 0);
    REQUIRE(p.print->lights().size() == 10);
    for (const host::Given& light : p.print->lights()) {
        CHECK(light.complete);
        CHECK(light.seconds == near(light.layer < 2 ? 12 : 2.5, {.relative = 1e-12}));
    }
    const double soft_mm3 = 0.15875 * 0.15875 * (24 + 6 * 100.0 / 255) * 0.25;
    CHECK(p.report.materials[0].cured_mm3 == near(soft_mm3, {.relative = 1e-12}));
    CHECK(p.report.resins[1].left_ml == near(700 - p.plan.vats[1].resin_ml, {.relative = 1e-5}));
}

TEST_CASE("the number of lines on the way never exceeds the printer file's window") {
    for (const int lines : {1, 2, 4}) {
        Print p;
        p.printer.controller.window_lines = lines;
        int most = 0;
        rehearse::Options counted;
        counted.wire = [&](std::unique_ptr<host::Wire> wire) {
            return std::make_unique<CountingWire>(std::move(wire), most);
        };
        p.run(std::move(counted));
        p.must_pass();
        CHECK(most == lines);
    }
}

TEST_CASE("the planned time is the machine's time, except for the positions from which the axes are homed") {
    Print p;
    p.run();
    REQUIRE(p.status);
    // The plan homes from the far end. The twin starts half-way up in Z (20 s instead of 40 s), at the print position
    // in X (0 s instead of 358/8 s), half-way in Y (36.5 s instead of 73 s).
    const double homing_less = 20 + 358 / 8.0 + 36.5;
    // After homing an axis the host moves it off its switch and back, to check that the switch is not stuck.
    double tried_s = 0;
    for (const machine::LimitSwitch& limit : p.printer.limit_switches) {
        const machine::AxisSpec& axis = p.printer.axis(limit.axis);
        const double way_mm = (machine::switch_reach_um + 1000) / 1000.0;
        tried_s += 2 * (way_mm / axis.homing_speed_mm_s + axis.homing_speed_mm_s / axis.acceleration_mm_s2);
    }
    const host::Snapshot last = p.print->snapshot();
    CHECK(p.print->twin().now() - last.begun_s.value_or(0) ==
          near(p.plan.seconds.total - homing_less + tried_s, {.relative = 0.002}));
}

TEST_CASE("the print survives a damaged, lost, unanswered or unnumbered line at any place") {
    constexpr int connecting = 4;  // M110, its synchronisation, and the queries for the last line
    for (const auto release : both_releases) {
        long resends = 0;
        for (const auto kind :
             {Fault::Kind::corrupt_byte, Fault::Kind::lose_line, Fault::Kind::lose_ok, Fault::Kind::lose_number}) {
            for (int n = 1; n < 220; n += 3) {
                CAPTURE(n);
                Print p;
                p.run({.advanced_ok = n % 2 == 0, .faults = {{kind, n, 0}}, .release = release});
                p.must_pass();
                resends += p.resends();
                if (kind == Fault::Kind::lose_line && n > connecting) CHECK(p.resends() > 0);
                if (kind == Fault::Kind::lose_ok) CHECK(p.resends() == 0);
            }
        }
        CHECK(resends > 100);
    }
}

TEST_CASE("both releases print with a board that has just started, and with a tenth of the oks lost") {
    for (const auto release : both_releases) {
        CAPTURE(machine::name_of(release));
        Print fresh;
        twin::Options boots;
        boots.release = release;
        boots.boot_s = 1.5;
        fresh.run(boots);
        fresh.must_pass();
        CHECK(fresh.resends() == 0);
        Print lossy;
        twin::Options options;
        options.release = release;
        for (int n = 3; n < 1000; n += 10) options.faults.push_back({Fault::Kind::lose_ok, n});
        lossy.run(options);
        lossy.must_pass();
        CHECK(lossy.resends() == 0);
    }
}

TEST_CASE("the print survives many faults together, lost Resends included") {
    for (const auto release : both_releases) {
        Print p;
        twin::Options options;
        options.release = release;
        for (int n = 3; n < 400; n += 7) options.faults.push_back({Fault::Kind::corrupt_byte, n});
        for (int n = 5; n < 400; n += 31) options.faults.push_back({Fault::Kind::lose_line, n});
        for (int n = 9; n < 400; n += 41) options.faults.push_back({Fault::Kind::lose_ok, n});
        for (int n = 2; n < 40; n += 5) options.faults.push_back({Fault::Kind::lose_resend, n});
        p.run(options);
        p.must_pass();
        CHECK(p.report.log.bad_lines > 20);
    }
}

TEST_CASE("a controller restart during a print ends it, and the inspection counts the missing layers") {
    Print p;
    p.run({.faults = {{Fault::Kind::reset, 150, 0}}});
    REQUIRE_FALSE(p.status);
    CHECK(p.status.error().cause == Cause::failed);
    CHECK(holds(p.status.error().message, "restarted"));
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.missing_layers > 0);
    CHECK(p.print->lights().size() < 10);
}

TEST_CASE("a command that the machine does not know ends the print") {
    Print p;
    p.replace("; layer 1", "M777\n; layer 1");
    p.run();
    REQUIRE_FALSE(p.status);
    CHECK(holds(p.status.error().message, "M777"));
}

TEST_CASE("vats in the wrong order are found as foreign resin") {
    Print p;
    for (std::vector<int>& images : p.plan.vat_of_image) std::swap(images[0], images[1]);
    p.gcode = plan::write_gcode(p.plan, p.job, p.printer);
    p.run();
    REQUIRE(p.status);
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.materials[0].foreign_mm3 > 0.8 * p.report.materials[0].wanted_mm3);
    CHECK(p.report.materials[0].cured_mm3 < 0.2 * p.report.materials[0].wanted_mm3);
}

TEST_CASE("a missing exposure fails the inspection") {
    Print p;
    const std::string line = ";@expose layer=3 material=1 seconds=2.500 image=layers/00003_1.png\n";
    p.replace(line, "");
    p.run();
    REQUIRE(p.status);
    CHECK_FALSE(p.report.passed);
    CHECK(p.report.materials[1].missing_mm3 == near(p.report.materials[1].wanted_mm3 / 5, {.relative = 1e-12}));
    CHECK(p.report.materials[0].missing_mm3 == 0);
}

TEST_CASE("a layer that is too low fails the inspection; one that is too high blocks the next swap and is refused") {
    Print low;
    low.replace("G1 Z0.150", "G1 Z0.140");
    low.run();
    REQUIRE_MESSAGE(low.status, (low.status ? "" : low.status.error().message));
    CHECK_FALSE(low.report.passed);
    CHECK(low.report.stray_layers >= 1);
    Print high;
    high.replace("G1 Z0.150", "G1 Z0.160");
    high.run();
    REQUIRE_FALSE(high.status);
    CHECK(holds(high.status.error().message, "the platform is down"));
}

TEST_CASE("too short an exposure and a repeated exposure fail the inspection") {
    Print shorter;
    shorter.replace("layer=4 material=0 seconds=2.500", "layer=4 material=0 seconds=1.500");
    shorter.run();
    CHECK_FALSE(shorter.report.passed);
    Print twice;
    const std::string line = ";@expose layer=4 material=0 seconds=2.500 image=layers/00004_0.png\n";
    twice.replace(line, line + line);
    twice.run();
    CHECK_FALSE(twice.report.passed);
    CHECK(twice.report.wrong_dose_pixels == 30);
}

TEST_CASE("a forbidden move is refused before it starts; if sent all the same, the machine stops it") {
    Print p;
    p.replace(";@expose layer=2", "G1 X100 F600\n;@expose layer=2");
    REQUIRE_FALSE(plan::check_gcode(p.gcode, p.printer));
    p.run();
    REQUIRE_FALSE(p.status);
    CHECK(holds(p.status.error().message, "the platform is down"));
    CHECK_FALSE(p.report.passed);
    CHECK(p.print->twin().log().homings == 0);
    twin::Twin machine(p.printer);
    const Status sent = app::send_unchecked(machine, p.gcode);
    REQUIRE_FALSE(sent);
    CHECK(holds(sent.error().message, "interlock"));
    REQUIRE(machine.log().violations.size() == 1);
    CHECK(holds(machine.log().violations[0], "the platform is down"));
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

TEST_CASE("a job whose resins the printer does not hold prints when the vats are filled as planned") {
    Print p;
    p.job.materials[1].resin = "wax";
    p.job.any_vat = true;
    p.plan = plan::make_plan(p.job, p.printer).value();
    p.gcode = plan::write_gcode(p.plan, p.job, p.printer);
    p.printer = plan::filled_printer(p.plan, p.job, p.printer);
    p.run();
    p.must_pass();
}

TEST_CASE("on every example printer the printed part equals the drawn part") {
    for (const char* name :
         {"tower", "tower8", "two_towers", "carousel", "tower_magnet", "wall", "rotary", "linear", "single"}) {
        INFO(std::string(name));
        Print p;
        p.printer = machine::load_printer(fmt::format("examples/printers/{}.toml", name)).value();
        p.printer.projector = small_tower().projector;
        const std::size_t last = p.printer.vats.size() - 1;  // the farthest vat there is
        p.job.materials[0].resin = p.printer.vats[0].resin;
        p.job.materials[1].resin = p.printer.vats[last].resin;
        p.plan = plan::make_plan(p.job, p.printer).value();
        p.gcode = plan::write_gcode(p.plan, p.job, p.printer);
        p.run();
        p.must_pass();
        CHECK(p.report.log.swaps == p.plan.swaps);
        CHECK(p.report.log.clamped_moves == 0);
    }
}

namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin);
        all.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return all;
}

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + '\n';
    return text;
}

/// True if host, twin or oracle report an error of the program.
bool noticed(const std::string& gcode) {
    Print p;
    p.gcode = gcode;
    p.run();
    return !p.status || !p.report.passed;
}

/// Lines that can be dropped without affecting the part: comments, synchronisation before a command that waits itself,
/// fans, spray strokes, moves that only peel or settle, and lines whose effect the next one repeats.
bool harmless_to_drop(const std::string& line) {
    if (line[0] == ';') return line.rfind(";@expose", 0) != 0;
    for (const char* start : {"M400", "M107", "M106 P0", "M106 P2", "M84", "G4 "}) {
        if (line.rfind(start, 0) == 0) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("mutation: dropping any line is noticed, or the part is the same") {
    const std::vector<std::string> lines = lines_of(Print().gcode);
    int dropped = 0, seen = 0;
    std::vector<std::string> unseen;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (harmless_to_drop(lines[i])) continue;
        std::vector<std::string> fewer = lines;
        fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
        ++dropped;
        if (noticed(joined(fewer)))
            ++seen;
        else
            unseen.push_back(fmt::format("{}: {}", i + 1, lines[i]));
    }
    // The rest are moves that the next absolute move makes too (strokes, lifts, shears, stops on the way down) and the
    // spray after the last layer.
    for (const std::string& line : unseen) {
        INFO(line);
        const bool stroke = line.find("G1 ") != std::string::npos;
        const bool last_spray = line.find("M106 P1") != std::string::npos;
        CHECK((stroke || last_spray || line.find("G90") != std::string::npos));
    }
    CHECK(dropped > 100);
    CHECK(seen > 90);
    MESSAGE(seen << " of " << dropped << " dropped lines noticed");
}

TEST_CASE("mutation: an exposure dropped, doubled, shortened, swapped or moved in height is noticed") {
    const std::vector<std::string> lines = lines_of(Print().gcode);
    int mutated = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (lines[i].rfind(";@expose", 0) != 0) continue;
        const auto with = [&](std::vector<std::string> instead) {
            std::vector<std::string> other = lines;
            other.erase(other.begin() + static_cast<std::ptrdiff_t>(i));
            other.insert(other.begin() + static_cast<std::ptrdiff_t>(i), instead.begin(), instead.end());
            INFO(lines[i]);
            CHECK(noticed(joined(other)));
            ++mutated;
        };
        with({});
        with({lines[i], lines[i]});
        with({"G1 Z60.000 F240", "M400", lines[i]});
        std::string shorter = lines[i];
        shorter.replace(shorter.find("seconds="), shorter.find(" image") - shorter.find("seconds="), "seconds=1.000");
        with({shorter});
        std::string other_material = lines[i];
        char& material = other_material[other_material.find("material=") + 9];
        material = material == '0' ? '1' : '0';
        with({other_material});
    }
    CHECK(mutated == 50);
}

TEST_CASE("mutation: one changed pixel in any image is noticed, and the layer is named") {
    const Print p;
    for (int layer = 0; layer < layers; ++layer) {
        for (int material = 0; material < 2; ++material) {
            const auto shown = [&](int l, int m) {
                auto changed = image(l, m);
                if (l == layer && m == material) changed->pixels[9] ^= 0x40;
                return changed;
            };
            const app::Printed other(p.printer, p.job, app::print_job(p.job, p.gcode, shown), image);
            REQUIRE(other.status);
            CHECK_FALSE(other.report.passed);
            CHECK(other.report.wrong_pixels >= 1);
            CHECK(holds(other.report.first_deviation, fmt::format("layer {}", layer + 1)));
        }
    }
}

namespace {

/// A random job of the size of the halves, in two resins: its images and exposures.
struct RandomJob {
    std::map<std::pair<int, int>, job::Image> images;
    job::Manifest job = app::halves::job({});

    explicit RandomJob(std::mt19937& random) {
        const auto pick = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
        const int count = 2 + pick(2);
        job.bottom_layers = pick(1);
        job.layers.clear();
        for (job::Material& m : job.materials) {
            m.model_volume_mm3 = 0;
            m.exposure_s = 2 + pick(10) / 10.0;
        }
        for (int layer = 0; layer < count; ++layer) {
            job.layers.push_back({50 * (layer + 1), 50, {}});
            job::Image soft{width_px, height_px, std::vector<std::uint8_t>(width_px * height_px)}, rigid = soft;
            for (std::size_t i = 0; i < soft.pixels.size(); ++i) {
                soft.pixels[i] = static_cast<std::uint8_t>(pick(3) == 0 ? pick(255) : 255 * pick(1));
                rigid.pixels[i] = static_cast<std::uint8_t>(pick(255 - soft.pixels[i]));
            }
            soft.pixels[0] = rigid.pixels[1] = 255;
            soft.pixels[1] = rigid.pixels[0] = 0;
            add(layer, 0, soft);
            add(layer, 1, rigid);
        }
    }
    void add(int layer, int material, const job::Image& image) {
        images[{layer, material}] = image;
        const double area_mm2 =
            static_cast<double>(twin::light_of(twin::runs_of(image))) / 255 * app::halves::pixel_mm2;
        job.layers.back().images.push_back({material, fmt::format("layers/{:05}_{}.png", layer, material), area_mm2});
        job.materials[static_cast<std::size_t>(material)].model_volume_mm3 += area_mm2 * 0.05;
    }
};

using Images = std::map<std::pair<int, int>, job::Image>;

/// Plans and prints a job with a projector that shows `shown`, and compares the block with the archive's images.
twin::Report print_of(const job::Manifest& planned, const RandomJob& asked, const Images& shown,
                      const Images& archived) {
    const machine::Printer printer = small_tower();
    const plan::Plan plan = plan::make_plan(planned, printer).value();
    const auto show = [&](int layer, int material) -> Result<job::Image> { return shown.at({layer, material}); };
    const auto drawn = [&](int layer, int material) -> Result<job::Image> { return archived.at({layer, material}); };
    const app::Printed printed(printer, asked.job,
                               app::print_job(planned, plan::write_gcode(plan, planned, printer), show), drawn);
    REQUIRE_MESSAGE(printed.status, (printed.status ? "" : printed.status.error().message));
    return printed.report;
}

bool has(const twin::Report& report, twin::Finding::Kind kind) {
    return std::any_of(report.findings.begin(), report.findings.end(), [&](auto& f) { return f.kind == kind; });
}

}  // namespace

TEST_CASE("property: random jobs pass; one voxel, one time or two images changed fail with the right finding") {
    using Kind = twin::Finding::Kind;
    std::mt19937 random(9);
    const auto pick = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
    for (int trial = 0; trial < 25; ++trial) {
        CAPTURE(trial);
        const RandomJob job(random);
        const twin::Report good = print_of(job.job, job, job.images, job.images);
        CHECK_MESSAGE(good.passed, twin::report_text(good));
        CHECK(good.findings.empty());

        const int layer = pick(static_cast<int>(job.job.layers.size()) - 1), material = pick(1);
        Images other = job.images;
        other.at({layer, material}).pixels[static_cast<std::size_t>(pick(47))] ^=
            static_cast<std::uint8_t>(1 << pick(7));
        const twin::Report shown = print_of(job.job, job, other, job.images);
        CHECK(shown.wrong_pixels == 1);
        CHECK((has(shown, Kind::missing) || has(shown, Kind::stray) || has(shown, Kind::foreign)));
        CHECK(has(print_of(job.job, job, other, other), Kind::image));

        job::Manifest timed = job.job;
        constexpr std::array<double, 5> factors{0.95, 1.05, 1.5, 2, 4};
        timed.layers[static_cast<std::size_t>(layer)].images[static_cast<std::size_t>(material)].exposure_s =
            job::exposure_s(job.job, static_cast<std::size_t>(layer), static_cast<std::size_t>(material)) *
            factors[static_cast<std::size_t>(pick(4))];
        const twin::Report longer = print_of(timed, job, job.images, job.images);
        CHECK(has(longer, Kind::dose));
        CHECK(longer.wrong_pixels == 0);

        Images exchanged = job.images;
        std::swap(exchanged.at({0, material}), exchanged.at({1, material}));
        const twin::Report swapped = print_of(job.job, job, exchanged, job.images);
        CHECK(!swapped.passed);
        CHECK(swapped.wrong_pixels > 1);
        CHECK(has(print_of(job.job, job, exchanged, exchanged), Kind::image));
    }
}

TEST_CASE("a fault of projector, hooks or vats makes the inspection fail, and layer and step are named") {
    const auto broken = [](Fault fault) {
        Print p;
        p.run({.faults = {fault}});
        CHECK_FALSE(p.report.passed);
        const bool told = fault.kind == Fault::Kind::empty_vat || !p.report.log.mishaps.empty();
        CHECK(told);
        return p.report;
    };
    const twin::Report dark = broken({Fault::Kind::dark_projector, 4, 0});
    CHECK(holds(dark.first_deviation, "layer 2, material \"soft\""));
    CHECK(holds(dark.first_deviation, "exposure"));
    const twin::Report stuck = broken({Fault::Kind::stuck_hook, 1, 0});
    CHECK(holds(stuck.first_deviation, "another resin"));
    CHECK(stuck.materials[1].foreign_mm3 > 0);
    const twin::Report empty = broken({Fault::Kind::empty_vat, 2, 0});
    CHECK(holds(empty.first_deviation, "layer 1, material \"rigid\""));
    INFO(empty.first_deviation);
    const twin::Report pump = broken({Fault::Kind::dead_pump, 1, 0});
    CHECK(pump.log.short_cleanings == 5);
    CHECK(pump.worst_residue == 1);
    // Moves 1 to 6 test the switches of the three axes, 7 to 10 load the first vat; the next ones lower the platform
    // into it.
    const twin::Report missed = broken({Fault::Kind::missed_steps, 12, 0.02});
    INFO(missed.first_deviation << " " << missed.log.mishaps[0]);
    CHECK(holds(missed.first_deviation, "platform"));
}

TEST_CASE("a stalled controller, a resend loop and lost bytes do not harm the part") {
    for (const Fault fault : {Fault{Fault::Kind::stall, 60, 5}, Fault{Fault::Kind::resend_loop, 40, 4},
                              Fault{Fault::Kind::lose_byte, 900, 0}, Fault{Fault::Kind::flip_byte, 1200, 0}}) {
        for (const auto release : both_releases) {
            Print p;
            p.run({.faults = {fault}, .release = release});
            p.must_pass();
        }
    }
}

TEST_CASE("contamination: resin left by the spray is carried from vat to vat, and the report maps it") {
    Print p;
    p.printer.cleaning.film_um = 100;
    p.run();
    p.must_pass();
    CHECK(p.report.contamination.size() == 10);
    CHECK(p.report.worst_residue == near(0.0525, {.relative = 0.01}));
    CHECK(p.report.worst_foreign > 0);
    CHECK(p.report.worst_foreign < 1e-6);
    const double brushed = p.report.worst_foreign;
    Print bare;
    bare.printer.cleaning.film_um = 100;
    bare.printer.cleaning.brush_share = 0;
    bare.run();
    bare.must_pass();
    CHECK(brushed / bare.report.worst_foreign == near(0.71, {.relative = 0.01}));
    p.printer.cleaning.most_contamination = 1e-9;
    p.run();
    CHECK_FALSE(p.report.passed);
    CHECK(holds(p.report.first_deviation, "foreign resin in the vat of slot"));
}
