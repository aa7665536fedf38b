#include "printing/machine/printer.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_text.hpp"

using namespace pliant;
using namespace pliant::machine;
using pliant::test::holds;
using pliant::test::replaced;

namespace {

const std::filesystem::path tower_file = "examples/printers/tower.toml";

std::string tower_text() {
    return read_file(tower_file).value();
}

/// The error with `from` replaced by `to` in the tower's file; "" if it is accepted.
std::string message_with(const std::string& from, const std::string& to) {
    std::string text = tower_text();
    const auto at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    const auto printer = parse_printer(text, "p.toml");
    return printer ? "" : printer.error().message;
}

}  // namespace

TEST_CASE("the printer file of the thesis' tower is read in micrometres and seconds") {
    const auto printer = load_printer(tower_file);
    REQUIRE_MESSAGE(printer, (printer ? "" : printer.error().message));
    CHECK(printer->layer_um == 50);
    CHECK(printer->axis(Axis::tower).letter == 'Y');
    CHECK(printer->axis(Axis::platform).home_um() == 400000);
    CHECK(printer->axis(Axis::carriage).home_um() == 0);
    CHECK(printer->axis(Axis::carriage).speed_mm_s == near(15.2, {.relative = 1e-12}));
    CHECK(printer->platform.width_um == 304800);
    CHECK(printer->platform.depth_um == 152400);
    CHECK(printer->tower.pitch_um == 203200);
    CHECK(printer->level_um(1) == 30000);
    CHECK(printer->level_um(4) == 30000 + 3 * 203200);
    CHECK(printer->clear_um(10000) == 10000 + 82550 + 2000);
    CHECK(printer->vat_shape.volume_ml == near(3834.573, {.relative = 1e-6}));
    REQUIRE(printer->vats.size() == 4);
    CHECK(printer->vats[1].resin == "rigid-flex");
    CHECK(printer->vat_of_slot(5) == nullptr);
    CHECK(printer->find_resin("semi-flex")->bottom_exposure_s == 12);
    CHECK(printer->find_resin("water") == nullptr);
    CHECK(printer->projector.pixel_um * printer->projector.width_px == near(304800, {.relative = 1e-12}));
    CHECK(printer->pump.on == "M106 P1 S255");
}

TEST_CASE("XY compensation and elephant foot belong to a resin") {
    std::string text = tower_text();
    const std::string table = "[resin.semi-flex]\n";
    REQUIRE(text.find(table) != std::string::npos);
    text.insert(text.find(table) + table.size(), "xy_compensation = \"-40 um\"\nelephant_foot = \"0.1 mm\"\n");
    const auto printer = parse_printer(text, "p.toml");
    REQUIRE_MESSAGE(printer, (printer ? "" : printer.error().message));
    const Resin& resin = *printer->find_resin("semi-flex");
    CHECK(resin.xy_compensation_um == -40);
    CHECK(resin.elephant_foot_um == 100);
    CHECK(resin.elephant_foot_layers == resin.bottom_layers);
    CHECK(printer->find_resin("tough")->xy_compensation_um == 0);
    CHECK(holds(message_with("exposure = \"2.5 s\"", "exposure = \"0.9 ms\""),
                "resin.semi-flex.exposure: must be at least a millisecond"));
    CHECK(holds(message_with(table, table + "xy_compensation = \"2 cm\"\n"),
                "resin.semi-flex.xy_compensation: must be -10 mm to 10 mm"));
}

TEST_CASE("a half working curve is one message, and an unknown key of a resin lists all that are known") {
    const std::string depth = "penetration_depth = \"60 um\"";
    const std::string half = message_with(depth, "");
    CHECK(holds(half, "and critical_dose go together"));
    CHECK_FALSE(holds(half, "unknown key"));
    const std::string unknown = message_with(depth, depth + "\nviscosity_of_it = 3");
    for (const char* key : {"xy_compensation", "bleed_compensation", "transition_layers", "elephant_foot"})
        CHECK(holds(unknown, key));
}

TEST_CASE("an invalid printer file gives a line with file, key and remedy") {
    CHECK(holds(message_with("letter = \"Y\"", "letter = \"Z\""), "has the letter of the platform axis"));
    CHECK(holds(message_with("letter = \"Y\"", "letter = \"yy\""), "p.toml:36: axis.tower.letter"));
    CHECK(holds(message_with("slots = 8", "slots = 3"), "must be from 1 to 3"));
    CHECK(holds(message_with("slot = 2", "slot = 1"), "1 holds a vat already"));
    CHECK(holds(message_with("resin = \"tough\"", "resin = \"touhg\""), "no [resin.touhg] table"));
    CHECK(holds(message_with("fill = \"700 ml\"", "fill = \"1 l\""), "overflows"));
    CHECK(holds(message_with("fill = \"700 ml\"", "fill = \"0 ml\""), "gives no resin: more than 60 ml"));
    CHECK(holds(message_with("fill = \"700 ml\"", ""), "gives no resin: more than 60 ml"));
    CHECK(holds(message_with("\"400 mm\"", "\"390 mm\""), "axis.platform.travel"));
    CHECK(holds(message_with("home = \"max\"", "home = \"min\""), "clear of the vat"));
    CHECK(holds(message_with("\"1460 mm\"", "\"1400 mm\""), "the last slot"));
    CHECK(holds(message_with("travel = \"29.5 mm\"", "travel = \"120 mm\""), "less than the tower's clearance"));
    for (const char* pixel : {"1e-9 um", "0 um", "-1 um", "10.1 mm"})
        CHECK(holds(message_with("pixel = \"158.75 um\"", fmt::format("pixel = \"{}\"", pixel)),
                    "projector.pixel: must be 0.1 um to 10 mm"));
    // 400 mm of travel less 304.8 mm of the tallest part.
    CHECK(holds(message_with("\nlift = \"5 mm\"", "\nlift = \"95.201 mm\""),
                "platform.lift: must be at most 95.200 mm, so that a part as tall as build_height (304.800 mm) is "
                "lifted within the platform's travel, to 400.000 mm"));
    CHECK(message_with("\nlift = \"5 mm\"", "\nlift = \"95.2 mm\"").empty());
    CHECK(holds(message_with("speed = \"40 mm/s\"", "speed = \"0 mm/s\""), "must be above 0"));
    CHECK(holds(message_with("speed = \"40 mm/s\"", "speed = 40"), "has no unit"));
    CHECK(holds(message_with("shear = \"2 mm\"", "sheer = \"2 mm\""), "sheer"));
    CHECK(holds(message_with("on = \"M106 P1 S255\"", "on = \"G1 X300\""), "must be an M106"));
    CHECK(holds(message_with("tower_position = \"355.6 mm\"", "tower_position = \"1e300 mm\""), "over 100 m"));
}

TEST_CASE("image rotation, offset, grey curve and mask are read, and invalid values are refused") {
    const auto with = [](const std::string& lines) {
        const std::string text = read_file("examples/printers/tower.toml").value();
        const std::string key = "mirror_x = false";
        return parse_printer(replaced(text, key, key + "\n" + lines), "p.toml");
    };
    const auto printer =
        with("rotation = -0.5\noffset = [\"0.2 mm\", \"-35 um\"]\ngrey = [0, 0.6, 1]\nmask = \"lens.png\"");
    REQUIRE_MESSAGE(printer.has_value(), (printer ? "" : printer.error().message));
    CHECK(printer->projector.rotation_deg == -0.5);
    CHECK(printer->projector.offset_x_um == 200);
    CHECK(printer->projector.offset_y_um == -35);
    CHECK(printer->projector.grey == std::vector<double>{0, 0.6, 1});
    CHECK(printer->projector.mask == "lens.png");
    CHECK(with("rotation = 400").error().message.find("rotation: must be -360 to 360") != std::string::npos);
    for (const char* grey : {"[0]", "[0.1, 1]", "[0, 0.5, 0.4]", "[0, 1.1]", "[0, 0]"})
        CHECK(with(fmt::format("grey = {}", grey)).error().message.find("must be 2 to 256 numbers") !=
              std::string::npos);
    CHECK(!with("offset = [\"1 mm\"]").has_value());
}

TEST_CASE("waits of over an hour, and a name with a line break, are refused") {
    const auto with = [](const std::string& old, const std::string& line) {
        const std::string text = read_file("examples/printers/tower.toml").value();
        const std::size_t at = text.find("\n" + old) + 1;
        const auto printer = parse_printer(text.substr(0, at) + line + text.substr(text.find('\n', at)), "p.toml");
        return printer ? std::string() : printer.error().message;
    };
    CHECK(with("settle = ", "settle = \"1 h\"").empty());
    CHECK(with("settle = ", "settle = \"1e9 s\"").find("platform.settle: is 1e+09 s, must be at most 3600 s") !=
          std::string::npos);
    CHECK(with("delay = ", "delay = \"2 h\"").find("projector.delay: is 7200 s") != std::string::npos);
    CHECK(with("spray = ", "spray = \"2 h\"").find("cleaning.spray: is 7200 s") != std::string::npos);
    CHECK(with("spray = ", "spray = \"15 s\"\ndry = \"2 h\"").find("cleaning.dry: is 7200 s") != std::string::npos);
    CHECK(with("name = ", "name = \"tower\\nM42 P4 S255\"").find("name: must have no line breaks") !=
          std::string::npos);
}

TEST_CASE("an empty file and a missing file are errors, not crashes") {
    CHECK_FALSE(parse_printer("", "p.toml"));
    CHECK_FALSE(parse_printer("vat = 3\naxis = \"x\"\nresin = [1]\n", "p.toml"));
    CHECK_FALSE(load_printer("examples/printers/none.toml"));
}

TEST_CASE("the firmware is one of the known releases, whatever its last number") {
    CHECK(load_printer(tower_file)->controller.firmware == MarlinRelease::v2_1_2);
    const auto with = [](const std::string& version) {
        return parse_printer(replaced(tower_text(), "[controller]\n", "[controller]\nfirmware = \"" + version + "\"\n"),
                             "p.toml");
    };
    CHECK(with("2.1.1")->controller.firmware == MarlinRelease::v2_1_1);
    CHECK(with("2.1.2.5")->controller.firmware == MarlinRelease::v2_1_2);
    CHECK(with("2.1.3")->controller.firmware == MarlinRelease::v2_1_3);
    for (const char* unknown : {"2.1.20", "2.1", "", "klipper"}) {
        CHECK(holds(with(unknown).error().message, "must be 2.1.1, 2.1.2 or 2.1.3"));
    }
}

TEST_CASE("a brush: its height and share, their defaults, and invalid values") {
    const Printer tower = load_printer(tower_file).value();
    CHECK(tower.has_brush());
    CHECK(tower.carriage.along_y);
    CHECK(tower.push_um(10000) == 10000 + 82550 + 1000);
    CHECK(tower.brushed_share() == 0.29);
    const std::string keys = "brush_share = 0.29 ";
    const Printer plain = parse_printer(replaced(tower_text(), keys, "#"), "p.toml").value();
    CHECK(plain.brushed_share() == near((0.12 + 0.07 + 0.69 + 0.27) / 4, {.relative = 1e-12}));  // a cloth, table 4.2
    const Printer bare = parse_printer(replaced(tower_text(), "brush = true", "brush = false"), "p.toml").value();
    CHECK_FALSE(bare.has_brush());
    CHECK(bare.push_um(10000) == bare.clear_um(10000));
    CHECK(bare.brushed_share() == 0);
    CHECK(holds(message_with(keys, "brush_share = 1.2 "), "cleaning.brush_share: must be a share from 0 to 1"));
    CHECK(holds(message_with("brush_height = \"1 mm\"", "brush_height = \"2.5 mm\""), "is above platform.clearance"));
    const std::string rotary = read_file("examples/printers/rotary.toml").value();
    const auto on_table = parse_printer(replaced(rotary, "[cleaning]", "[cleaning]\nbrush = true"), "p.toml");
    REQUIRE_FALSE(on_table);
    CHECK(holds(on_table.error().message, "cleaning.brush: needs a [tower]"));
}

TEST_CASE("sprinklers have a position, a direction of length 1 and a cone") {
    const Printer tower = load_printer(tower_file).value();
    REQUIRE(tower.sprinklers.size() == 3);
    const Sprinkler& head = tower.sprinklers[1];
    CHECK(head.place_mm == std::array<double, 3>{120, -60, 20});
    CHECK(std::hypot(head.aim[0], head.aim[1], head.aim[2]) == near(1, {.relative = 1e-12}));
    CHECK(head.aim[0] / head.aim[1] == near(-1.5 / 0.94, {.relative = 1e-12}));
    CHECK(head.cone_rad == near(100 * 3.14159265358979 / 180, {.relative = 1e-12}));
    CHECK(holds(message_with("aim = [1.5, 0.94, 1]", "aim = [0, 0, 0]"), "sprinkler[0].aim: must be a direction"));
    CHECK(holds(message_with("cone = \"100 deg\"", "cone = \"180 deg\""), "sprinkler[0].cone: must be above 0"));
    CHECK(holds(message_with("cone = \"100 deg\"", "cone = \"100 deg\"\nflow = 0"), "flow: must be above 0"));
    CHECK(holds(message_with("method = \"spray\"", "method = \"bath\""), "sprinkler: belongs to a machine"));
    CHECK(holds(message_with("cone = \"100 deg\"", "#"), "cone"));
}
