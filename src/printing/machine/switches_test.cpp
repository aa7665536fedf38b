#include "printing/machine/switches.hpp"

#include <doctest/doctest.h>

#include <string>

#include "base/core/files.hpp"
#include "base/core/test_text.hpp"
#include "printing/machine/firmware.hpp"
#include "printing/machine/follow.hpp"

using namespace pliant;
using namespace pliant::machine;
using pliant::test::holds;
using pliant::test::replaced;

namespace {

/// The tower of the thesis with text appended to its file.
Result<Printer> tower_with(const std::string& text) {
    return parse_printer(read_file("examples/printers/tower.toml").value() + text, "p.toml");
}

std::string wrong(const std::string& text) {
    const auto printer = tower_with(text);
    return printer ? "" : printer.error().message;
}

/// Homed, as after G28, then the platform at the given height.
Interlock homed(const Printer& printer, int platform_um) {
    Interlock lock(printer);
    for (const Axis axis : homing_order(printer)) REQUIRE(lock.home(axis));
    Position to = lock.position();
    to[Axis::platform] = platform_um;
    REQUIRE(lock.move(to));
    return lock;
}

std::string problem(const Printer& printer, const Interlock& state, const std::vector<SwitchReading>& readings) {
    const Status status = check_switches(printer, state, readings);
    return status ? "" : status.error().message;
}

}  // namespace

TEST_CASE("the prototype has two fans, three limit switches and a relay as emergency line") {
    const Printer p = load_printer("examples/printers/tower.toml").value();
    REQUIRE(p.fans.size() == 2);
    CHECK(p.fans[1].on == "M106 P2 S255");
    REQUIRE(p.limit_switches.size() == 3);
    CHECK(p.limit_switches[1].axis == Axis::platform);
    CHECK(p.limit_switches[1].at_max);
    CHECK_FALSE(p.limit_switches[2].inverted);
    CHECK(p.emergency_line.signal == EmergencyLine::Signal::controller);
    CHECK(p.emergency_line.pin == 12);
    CHECK_FALSE(p.door.present());
    CHECK(load_printer("examples/printers/single.toml").value().door.input == "y_max");
}

TEST_CASE("mistakes in switches, door, fans and emergency line are named, with a remedy") {
    CHECK(wrong("\n[door]\ninput = \"y_max\"\ninverted = true\n").empty());
    CHECK(holds(wrong("\n[door]\ninput = \"y_min\"\n"), "is the limit switch of the tower"));
    CHECK(holds(wrong("\n[door]\ninput = \"front\"\n"), "door.input"));
    CHECK(holds(wrong("\n[[limit_switch]]\naxis = \"table\"\nend = \"min\"\n"), "the machine has no table"));
    CHECK(holds(wrong("\n[[limit_switch]]\naxis = \"tower\"\nend = \"min\"\n"), "stands twice"));
    CHECK(holds(wrong("\n[[limit_switch]]\naxis = \"tower\"\nend = \"max\"\ninvert = true\n"), "invert"));
    CHECK(wrong("\n[[limit_switch]]\naxis = \"tower\"\nend = \"max\"\ninverted = true\n").empty());
    CHECK(holds(wrong("\n[[fan]]\non = \"M106 P1 S255\"\noff = \"M107 P1\"\n"), "another fan or of the pump"));
    CHECK(holds(wrong("\n[fans]\non = \"M106 P3\"\noff = \"M107 P3\"\n"), "older form"));
    const std::string text = read_file("examples/printers/tower.toml").value();
    const std::string last = "[[limit_switch]]\naxis = \"tower\"\nend = \"min\"\n";
    const auto changed = [&](const std::string& from, const std::string& to) {
        const auto printer = parse_printer(replaced(text, from, to), "p.toml");
        return printer ? "" : printer.error().message;
    };
    CHECK(holds(changed("off = \"M107 P1\"", "off = \"M106 P1 S255\""),
                "\"M106 P1 S255\" does not switch off what \"M106 P1 S255\" switches on"));
    CHECK(holds(changed("off = \"M107 P1\"", "off = \"M107 P2\""), "does not switch off"));
    CHECK(holds(changed(last, ""), "the tower homes to a switch at its min that is not listed"));
    const std::string relay = "signal = \"controller\"\npin = 12 ";
    CHECK(holds(changed(relay, "signal = \"dtr\"\n"), "device"));
    CHECK(holds(changed(relay, "signal = \"dtr\"\ndevice = \"/dev/ttyUSB1\"\nstop = \"low\"\n"), "stop"));
    CHECK(holds(changed(relay, "signal = \"controller\"\npin = 99 "), "from 0 to 69"));
    CHECK(changed(relay, "signal = \"file\"\ndevice = \"/sys/class/gpio/gpio17/value\"\nstop = \"low\"\n").empty());
}

TEST_CASE("the older form of one fan is still read") {
    const std::string text = read_file("examples/printers/rotary.toml").value();
    const Printer p = parse_printer(replaced(text, "[[fan]]", "[fans]"), "p.toml").value();
    REQUIRE(p.fans.size() == 1);
    CHECK(p.fans[0].off == "M107 P0");
}

TEST_CASE("a switch is read only from a complete line") {
    CHECK(parse_switch("x_min: TRIGGERED") == SwitchReading{"x_min", true});
    CHECK(parse_switch("filament: open") == SwitchReading{"filament", false});
    for (const char* line : {"x_min:open", "x_min: opn", "x_min: TRIGGERE", ": open", "Reporting endstop status",
                             "X_min: open", "x_min: open ", "ok", ""})
        CHECK_FALSE(parse_switch(line));
}

TEST_CASE("switches are named by their axis letter, on extra axes also by Marlin's own name") {
    const Printer p = load_printer("examples/printers/two_towers.toml").value();  // tower A, table B
    CHECK(switch_names(p, {Axis::platform, true, false}) == std::vector<std::string>{"z_max"});
    CHECK(switch_names(p, {Axis::tower, false, false}) == std::vector<std::string>{"a_min", "i_min"});
    CHECK(switch_names(p, {Axis::table, false, false}) == std::vector<std::string>{"b_min", "j_min"});
}

TEST_CASE("errors: a switch pressed in the wrong place, both ends pressed, a switch that is missing") {
    const Printer p = tower_with(
                          "\n[[limit_switch]]\naxis = \"platform\"\nend = \"min\"\n"
                          "\n[door]\ninput = \"y_max\"\n")
                          .value();
    const std::vector<SwitchReading> good = {
        {"x_min", true}, {"z_max", false}, {"z_min", false}, {"y_min", true}, {"y_max", false}};
    const auto with = [&](std::size_t which, bool pressed) {
        auto readings = good;
        readings[which].pressed = pressed;
        return readings;
    };
    const Interlock high = homed(p, 400000), low = homed(p, 200000), lost(p);
    CHECK(problem(p, low, good).empty());
    CHECK(problem(p, high, with(1, true)).empty());
    CHECK(holds(problem(p, low, with(1, true)), "the max limit switch of the platform is pressed"));
    CHECK(holds(problem(p, low, with(1, true)), "stands at 200.000 mm"));
    CHECK(problem(p, lost, with(1, true)).empty());  // it may be there
    auto both = with(1, true);
    both[2].pressed = true;
    CHECK(holds(problem(p, lost, both), "both limit switches of the platform"));
    CHECK(holds(problem(p, lost, {good.begin() + 1, good.end()}), "does not name x_min"));
    CHECK(holds(problem(p, lost, {good.begin(), good.end() - 1}), "does not name y_max"));
    CHECK(problem(p, low, with(4, true)).empty());
    CHECK(door_open(p, good) == false);
    CHECK(door_open(p, with(4, true)) == true);
}

TEST_CASE("firmware settings cover inverted switches, a far switch, door, fan and relay") {
    Printer p = tower_with(
                    "\n[door]\ninput = \"y_max\"\ninverted = true\n"
                    "\n[[limit_switch]]\naxis = \"platform\"\nend = \"min\"\ninverted = true\n")
                    .value();
    const std::string ini = firmware_ini(p).value();
    for (const char* line : {"use_ymax_plug = on", "y_max_endstop_inverting = true", "use_zmin_plug = on",
                             "z_min_endstop_inverting = true", "z_max_endstop_inverting = false", "fan2_pin = 10",
                             "psu_control = on", "ps_on_pin = 12", "psu_active_state = HIGH"})
        CHECK_MESSAGE(holds(ini, std::string("\n") + line + "\n"), line);
    p = load_printer("examples/printers/tower8.toml").value();
    p.door.input = "x_max";  // then the tower's switch takes the next free input
    CHECK(holds(firmware_ini(p).value(), "\ni_min_pin = 15\n"));
    p.door.input = "y_max";
    CHECK(holds(firmware_ini(p).value(), "\ni_min_pin = 2\n"));
    p.limit_switches.push_back({Axis::carriage, true, false});
    CHECK(holds(firmware_ini(p).error().message, "no free input"));
}

TEST_CASE("a job's G-code may not write to the pin of the emergency line") {
    const Printer p = load_printer("examples/printers/tower.toml").value();
    Followed at{Interlock(p)};
    CHECK(holds(at.line(p, "M42 P12 S0").error().message, "emergency line"));
    CHECK(at.line(p, "M42 P11 S0"));
}
