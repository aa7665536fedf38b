// Every known tampering, applied to real jobs, is refused by everything that prints; untouched jobs pass.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <map>
#include <random>
#include <set>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/operate/proved_job.hpp"
#include "printing/prepare/slice_job.hpp"
#include "printing/prepare/test_order.hpp"
#include "tamper.hpp"

using namespace pliant;
using namespace pliant::app;
using tamper::Kind;
using tamper::Parts;
using tamper::Tampering;
namespace fs = std::filesystem;

namespace {

constexpr int width_px = 96, height_px = 64;

/// Replaces the value of the line of `text` that begins with `key = `.
void set_key(std::string& text, const std::string& key, const std::string& value) {
    const std::size_t at = text.find("\n" + key + " = ");
    REQUIRE(at != std::string::npos);
    text.replace(at, text.find('\n', at + 1) - at, "\n" + key + " = " + value);
}

/// A machine of the examples with a projector of a few pixels, and what `change` makes of its file.
prepare::PrinterFile small_printer(const std::string& name, const std::function<void(std::string&)>& change = {}) {
    prepare::PrinterFile file;
    file.text = read_file("examples/printers/" + name + ".toml").value();
    set_key(file.text, "width", std::to_string(width_px));
    set_key(file.text, "height", std::to_string(height_px));
    if (change) change(file.text);
    const auto printer = machine::parse_printer(file.text, name + ".toml");
    REQUIRE_MESSAGE(printer, (printer ? "" : printer.error().message));
    file.printer = *printer;
    if (!file.printer.projector.mask.empty())
        file.mask = job::Image{width_px, height_px, std::vector<std::uint8_t>(width_px * height_px, 200)};
    return file;
}

/// A wedge, so that layers differ, and a block beside it, in the resins of the printer's first two vats.
prepare::Drawing small_part(const machine::Printer& printer) {
    prepare::Drawing drawing;
    drawing.name = "small part";
    mesh::TriMesh wedge = prepare::test::box_um({0, 0, 0}, {1500, 1500, 400});
    for (Vec3& p : wedge.points) {
        if (p.z > 0 && p.x == 0) p.x += 300;
    }
    drawing.bodies = {{"soft", wedge, "wedge"},
                      {"firm", prepare::test::box_um({1500, 0, 0}, {3000, 1500, 400}), "block"}};
    const auto& vats = printer.vats;
    drawing.resin_of_material = {{"soft", vats[0].resin}, {"firm", vats[vats.size() > 1 ? 1 : 0].resin}};
    return drawing;
}

void make_job(const fs::path& file, const prepare::PrinterFile& printer, prepare::Order order = {}) {
    order.version = "test";
    Progress silent;
    const auto made = prepare::slice_job(order, printer, small_part(printer.printer), file, silent);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
}

template <class T>
std::string error_of(const Result<T>& result) {
    return result ? "" : result.error().message;
}

std::string checked(const fs::path& file) {
    return error_of(operate::prove_job(file, operate::Pixels::areas));
}
/// On the virtual printer.
std::string printed(const fs::path& file) {
    return error_of(operate::prove_job(file));
}
/// At a port, and in the studio.
std::string hosted(const fs::path& file) {
    return error_of(operate::load_job(file));
}

/// One line, which names the file.
void check_message(const std::string& message, const fs::path& file) {
    CHECK(!message.empty());
    CHECK(message.find('\n') == std::string::npos);
    CHECK(message.find(file.filename().string()) != std::string::npos);
}

/// Refused by all as it is, and by all that can detect it once its checksums have been recomputed.
void check_refused(const Tampering& tampering, const Parts& parts, const fs::path& file) {
    CAPTURE(tampering.name);
    tamper::put_together(parts, false, file);
    for (const std::string& message : {checked(file), printed(file), hosted(file)}) check_message(message, file);
    tamper::put_together(parts, true, file);
    if (tampering.kind != Kind::pixels) check_message(checked(file), file);
    if (tampering.kind == Kind::meaning) {
        check_message(printed(file), file);
        check_message(hosted(file), file);
    } else {
        // Only the checksums can detect this: that is their purpose.
        CHECK(printed(file) == "");
        CHECK(hosted(file) == "");
    }
}

/// Names of the tamperings that apply to a job of this machine.
std::set<std::string> tamper_all(const std::string& machine) {
    const test::Folder folder("tampered");
    const fs::path good = folder / "good.zip", bad = folder / "bad.zip";
    make_job(good, small_printer(machine));
    CHECK(checked(good) == "");
    const Parts whole = tamper::take_apart(good);
    tamper::put_together(whole, false, bad);
    CHECK(hosted(bad) == "");  // taking it apart changes nothing
    std::set<std::string> names;
    for (const Tampering& tampering : tamper::tamperings()) {
        Parts parts = whole;
        if (!tampering.change(parts)) continue;
        check_refused(tampering, parts, bad);
        names.insert(tampering.name);
    }
    return names;
}

}  // namespace

TEST_CASE("every tampered job is refused by check, by the virtual printer, and by the host: tower") {
    const std::set<std::string> names = tamper_all("tower");
    MESSAGE(names.size() << " kinds");
    CHECK(names.size() >= 75);
    CHECK(tamper::tamperings().size() - names.size() <= 2);  // those that do not apply to a tower
}

TEST_CASE("every tampered job is refused by check, by the virtual printer, and by the host: table, single vat") {
    CHECK(tamper_all("rotary").size() >= 60);
    CHECK(tamper_all("single").size() >= 40);
}

TEST_CASE("50 untouched jobs pass") {
    using Change = std::function<void(prepare::Order&)>;
    const std::vector<std::pair<std::string, Change>> orders = {
        {"plain", [](prepare::Order&) {}},
        {"thin layers", [](prepare::Order& o) { o.layer = "25 um"; }},
        {"thick layers", [](prepare::Order& o) { o.layer = "100 um"; }},
        {"adaptive layers",
         [](prepare::Order& o) {
             o.layer = "100 um";
             o.least_layer = "20 um";
             o.turn = {0, 20, 0};
         }},
        {"exposures of their own",
         [](prepare::Order& o) {
             o.exposures = {"soft=1.2345 s,7 s", "firm:2-4=3.3 s", "soft:0-0=500 ms"};
         }},
        {"bonds", [](prepare::Order& o) { o.overlaps = {"soft+firm=3,1"}; }},
        {"teeth, copies, full pixels",
         [](prepare::Order& o) {
             o.interlocks = {"soft+firm=3,2"};
             o.copies = 2;
             o.spacing = "300 um";
             o.no_anti_alias = true;
         }},
        {"supports", [](prepare::Order& o) {
             o.support = "soft";
             o.lift = "1 mm";
             o.raft = "100 um";
         }}};
    const test::Folder folder("untouched");
    const fs::path file = folder / "job.zip";
    int passed = 0;
    const auto check = [&](const std::string& what, const prepare::PrinterFile& printer, const prepare::Order& order) {
        CAPTURE(what);
        fs::remove(file);
        make_job(file, printer, order);
        for (const std::string& message : {checked(file), printed(file), hosted(file)}) CHECK(message == "");
        ++passed;
    };
    for (const char* machine : {"tower", "two_towers", "carousel", "rotary", "linear", "single"}) {
        for (const auto& [name, change] : orders) {
            prepare::Order order;
            change(order);
            check(fmt::format("{}, {}", machine, name), small_printer(machine), order);
        }
    }
    // Machines with other requirements.
    const auto tower_with = [&](const std::string& what, const std::function<void(std::string&)>& change,
                                const Change& wish = {}) {
        prepare::Order order;
        if (wish) wish(order);
        check(what, small_printer("tower", change), order);
    };
    const auto in_projector = [](const std::string& line) {
        return [line](std::string& text) { text.insert(text.find("[projector]\n") + 12, line + "\n"); };
    };
    tower_with("grey", in_projector("grey = [0, 0.55, 0.8, 1]"));
    tower_with("mask", in_projector("mask = \"vignette.png\""));
    tower_with("refills", [](std::string& text) {
        for (std::size_t at = text.find("\"700 ml\""); at != std::string::npos; at = text.find("\"700 ml\"", at))
            text.replace(at, 8, "\"60.0003 ml\"");
    });
    tower_with("two vats of a resin", [](std::string& text) {
        text.replace(text.find("resin = \"tough\""), 15, "resin = \"semi-flex\"");
        for (std::size_t at = text.find("\"700 ml\""); at != std::string::npos; at = text.find("\"700 ml\"", at))
            text.replace(at, 8, "\"60.0006 ml\"");
    });
    tower_with("no rests, tiny strokes, no fans", [](std::string& text) {
        set_key(text, "settle", "\"0 ms\"");
        set_key(text, "delay", "\"0 ms\"");
        set_key(text, "shear", "\"0 mm\"");
        set_key(text, "stroke_x", "\"1 um\"");
        set_key(text, "stroke_z", "\"1 um\"");
        text.erase(text.find("[[fan]]"), text.find("[limits]") - text.find("[[fan]]"));
    });
    tower_with("a long cleaning", [](std::string& text) { set_key(text, "spray", "\"100 s\""); });
    tower_with("a short cleaning", [](std::string& text) { set_key(text, "spray", "\"1 s\""); });
    tower_with("a classic board", [](std::string& text) {
        text.replace(text.find("dialect = \"marlin\""), 18, "dialect = \"marlin-classic\"");
        text.replace(text.find("letter = \"Y\""), 12, "letter = \"E\"");
        text.replace(text.find("home = \"min\"", text.find("[axis.tower]")), 12, "home = \"hand\"");
    });
    tower_with("a resin that is filled in", {}, [](prepare::Order& o) {
        o.resins = {"soft=honey"};
        o.any_vat = true;
    });
    MESSAGE(passed << " jobs");
    CHECK(passed >= 50);
}

TEST_CASE("a job with a flipped bit is refused, or nothing that matters has changed") {
    const test::Folder folder("flipped");
    const fs::path good = folder / "good.zip", bad = folder / "bad.zip";
    make_job(good, small_printer("tower"));
    const std::string bytes = read_file(good).value();
    const Parts whole = tamper::take_apart(good);
    std::mt19937 random(7);
    int refused = 0;
    constexpr int tries = 300;
    for (int i = 0; i < tries; ++i) {
        std::string other = bytes;
        char& byte = other[random() % other.size()];
        byte = static_cast<char>(byte ^ (1 << random() % 8));
        REQUIRE(write_file(bad, other));
        const auto proved = operate::prove_job(bad);
        if (!proved) {
            ++refused;
            continue;
        }
        CHECK(proved->archive.manifest().sha256 == whole.manifest.sha256);
    }
    CHECK(refused > tries / 2);
    for (const double share : {0.0, 0.1, 0.5, 0.9, 0.999}) {
        REQUIRE(write_file(bad, bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size())))));
        check_message(hosted(bad), bad);
    }
}

TEST_CASE("a job of format 1 is read and checked as far as possible, with a warning") {
    const test::Folder folder("old");
    const fs::path file = folder / "old.zip";
    make_job(file, small_printer("tower"));
    Parts parts = tamper::take_apart(file);
    parts.manifest.sha256.clear();
    tamper::put_together(parts, false, file);
    const auto ready = operate::load_job(file);
    REQUIRE_MESSAGE(ready, error_of(ready));
    REQUIRE(ready->warnings.size() == 1);
    CHECK(test::holds(ready->warnings[0], "cannot be proved"));
    for (const Tampering& tampering : tamper::tamperings()) {
        if (tampering.kind != Kind::areas) continue;  // pixels are checked, because there are no checksums
        Parts changed = parts;
        REQUIRE(tampering.change(changed));
        tamper::put_together(changed, false, file);
        check_message(hosted(file), file);
    }
}

TEST_CASE("check, print --twin and print --port refuse a tampered job with the same line") {
    const test::Folder folder("cli");
    const fs::path good = folder / "good.zip", bad = folder / "bad.zip", said = folder / "said";
    make_job(good, small_printer("tower"));
    const auto run = [&](const std::string& arguments) {
        const int status =
            std::system(fmt::format("{} {} >{} 2>&1 </dev/null", PLIANT_PROGRAM, arguments, said.string()).c_str());
        return std::pair(WEXITSTATUS(status), read_file(said).value());
    };
    CHECK(run("check " + good.string()).first == 0);
    const auto [status, text] = run("print " + good.string() + " --twin");
    CHECK(test::holds(text, "slot 1: semi-flex, "));
    CHECK(status == 0);
    const Parts whole = tamper::take_apart(good);
    const std::vector<Tampering> all = tamper::tamperings();
    for (std::size_t i = 0; i < all.size(); i += 6) {
        Parts parts = whole;
        if (all[i].kind != Kind::meaning || !all[i].change(parts)) continue;
        CAPTURE(all[i].name);
        tamper::put_together(parts, true, bad);
        const std::string line = checked(bad);
        for (const char* how : {"check {0}", "print {0} --twin", "print {0} --twin --speed 1000",
                                "print {0} --port /dev/null --projector {1}"}) {
            const auto [code, output] = run(fmt::format(fmt::runtime(how), bad.string(), folder.path().string()));
            CHECK(code == 2);
            CHECK(test::holds(output, line));
        }
    }
}

TEST_CASE("on a terminal, print --port asks for the vats first; with --yes and -q it does not ask") {
    const test::Folder folder("asked");
    const fs::path good = folder / "good.zip", said = folder / "said";
    make_job(good, small_printer("tower"));
    const auto at_terminal = [&](const std::string& typed, const std::string& options) {
        const std::string print = fmt::format("{} print {} --port /dev/null --projector {} {}", PLIANT_PROGRAM,
                                              good.string(), folder.path().string(), options);
        fs::remove(good.string() + ".journal");
        (void)std::system(
            fmt::format("printf '{}' | timeout 60 script -qec '{}' /dev/null >{} 2>&1", typed, print, said.string())
                .c_str());
        return read_file(said).value();
    };
    const std::string question = "Are these vats in their slots and filled?", begun = "not a serial port";
    for (const char* no : {"n\\n", "\\n", ""}) {
        const std::string text = at_terminal(no, "");
        CHECK(test::holds(text, "slot 1: semi-flex, "));
        CHECK(test::holds(text, "slot 2: rigid-flex, "));
        CHECK(test::holds(text, question));
        CHECK(test::holds(text, "not printed"));
        CHECK(!test::holds(text, begun));
        CHECK(!fs::exists(good.string() + ".journal"));
    }
    CHECK(test::holds(at_terminal("y\\n", ""), begun));
    for (const char* option : {"--yes", "-q"}) {
        const std::string text = at_terminal("", option);
        CHECK(!test::holds(text, question));
        CHECK(test::holds(text, begun));
    }
}
