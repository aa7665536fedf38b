// Mistakes in a printer file about magnets and walls: one clear line each.
#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"

using namespace pliant;
using namespace pliant::machine;
using pliant::test::holds;

namespace {

/// The error with `from` replaced by `to` in the file; "" if it is accepted.
std::string message_of(const char* name, const std::string& from, const std::string& to) {
    std::string text = read_file(std::string("examples/printers/") + name + ".toml").value();
    const auto at = text.find(from);
    REQUIRE_MESSAGE(at != std::string::npos, from);
    text.replace(at, from.size(), to);
    const auto printer = parse_printer(text, "p.toml");
    return printer ? "" : printer.error().message;
}

struct Mistake {
    const char *from, *to, *message;
};

void check_mistakes(const char* name, std::initializer_list<Mistake> mistakes) {
    for (const Mistake& mistake : mistakes) {
        const std::string message = message_of(name, mistake.from, mistake.to);
        INFO(std::string(mistake.to));
        // Consequential errors may follow on further lines.
        CHECK_MESSAGE(holds(message.substr(0, message.find('\n')), mistake.message), message);
    }
}

}  // namespace

TEST_CASE("a magnet instead of hooks is read, and its force is checked") {
    const Printer p = load_printer("examples/printers/tower_magnet.toml").value();
    CHECK(p.hooks.travel_um == 0);
    CHECK(p.hooks.magnet.engage_s == near(0.2, {.relative = 1e-12}));
    CHECK(p.hooks.magnet.release_s == near(0.5, {.relative = 1e-12}));
    CHECK_FALSE(on_without_power(p.hooks.magnet.coil));
    CHECK(on_without_power({"M42 P11 S0", "M42 P11 S255"}));
    CHECK_FALSE(load_printer("examples/printers/tower.toml")->hooks.magnet.present());
    // 3.5 kg and 700 ml of 1.1 g/ml, pulled at 50 mm/s^2 with a friction of 0.3: 4.27 (0.3 9.81 + 0.05) = 12.8 N.
    CHECK(holds(message_of("tower_magnet", "\"60 N\"", "\"25 N\""),
                "hooks.force: 25 N hold too little: to pull the fullest vat, 4.27 kg, takes 12.8 N"));
    CHECK(message_of("tower_magnet", "\"60 N\"", "\"26 N\"").empty());
    CHECK(message_of("tower_magnet", "force = \"60 N\"                  # that it holds\nvat_mass = \"3.5 kg\"", "")
              .empty());
}

TEST_CASE("mistakes in a magnet's table are named") {
    check_mistakes(
        "tower_magnet",
        {{"\"electromagnet\"", "\"magnet\"", "hooks.kind"},
         {"on = \"M42 P11 S255\"", "on = \"G1 X5\"", "must be an M106, M107 or M42 command"},
         {"off = \"M42 P11 S0\"\n", "", "hooks: \"off\" is missing"},
         {"engage = \"200 ms\"", "engage = \"-1 s\"", "hooks.engage: must be above 0"},
         {"release = \"500 ms\"", "release = \"5 mm\"", "hooks.release"},
         {"force = \"60 N\"", "# force", "force: and vat_mass go together"},
         {"release = \"500 ms\"", "release = \"500 ms\"\ntravel = \"3 mm\"", "hooks.travel: belongs to hooks"},
         {"M42 P11 S255", "M42 P12 S255", "\"M42 P11 S0\" does not switch off what \"M42 P12 S255\" switches on"},
         {"on = \"M42 P11 S255\"             # servo output of the RAMPS, to a transistor: off without "
          "power\noff = \"M42 P11 S0\"",
          "on = \"M42 P12 S255\"\noff = \"M42 P12 S0\"", "is the pin of the emergency line"},
         {"on = \"M42 P11 S255\"             # servo output of the RAMPS, to a transistor: off without "
          "power\noff = \"M42 P11 S0\"",
          "on = \"M106 P1 S255\"\noff = \"M107 P1\"", "is the output of pump"}});
    check_mistakes("tower", {{"[hooks]\n", "[hooks]\nengage = \"1 s\"\n", "needs kind = \"electromagnet\""}});
}

TEST_CASE("a wall of vats has slots in rows and columns") {
    const Printer p = load_printer("examples/printers/wall.toml").value();
    CHECK(p.store() == Store::wall);
    CHECK(p.has_carriage());
    CHECK(p.slot_count() == 16);
    CHECK(p.row_um(16) == 50000 + 3 * 152400);
    CHECK(p.column_um(16) == 20000 + 3 * 355600);
    CHECK(p.column_um(5) == p.column_um(1));
    CHECK(p.level_um(9) == 300000);
    CHECK(p.station_um(9) == 480000);
    CHECK(axis_name(Axis::tower, p.store()) == "lift");
}

TEST_CASE("mistakes in a wall's table are named") {
    check_mistakes(
        "wall", {{"rows = 4", "rows = 0", "wall.rows: is 0, must be from 1 to 100"},
                 {"bay = [\"480 mm\", \"300 mm\"]", "bay = [\"480 mm\"]", "wall.bay"},
                 {"bay = [\"480 mm\", \"300 mm\"]", "bay = [\"1480 mm\", \"300 mm\"]",
                  "axis.rail.travel: the bay at 1480.000 mm is outside"},
                 {"row_pitch = \"6 in\"", "row_pitch = \"5 in\"", "wall.row_pitch: must be at least the vat's wall"},
                 {"row_pitch = \"6 in\"", "row_pitch = \"12 in\"", "axis.lift.travel: the last row"},
                 {"column_pitch = \"14 in\"", "column_pitch = \"11 in\"", "wall.column_pitch: is less than"},
                 {"lift_off = \"20 mm\"", "lift_off = \"60 mm\"", "the first row, lowered, at -10.000 mm is outside"},
                 {"clearance = \"2 in\"", "clearance = \"20 mm\"", "wall.lift_off: must be less than"},
                 {"time = \"1.5 s\"", "", "wall.fork: \"time\" is missing"},
                 {"[axis.rail]", "[axis.table]", "axis: \"rail\" is missing"},
                 {"[wall]\n", "[tower]\nslots = 2\n[wall]\n", "wall: is a store of its own"},
                 {"slot = 16", "slot = 17", "must be from 1 to 16"},
                 {"axis = \"rail\"", "axis = \"table\"", "limit_switch"}});
}
