#include "printing/machine/board_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "base/core/letters.hpp"
#include "printing/machine/decimal.hpp"
#include "printing/machine/marlin_axes.hpp"
#include "printing/machine/switches.hpp"

namespace pliant::machine {
namespace {

/// "X80.00 Y:80.00 ...": letters with numbers; malformed ones are left out.
std::map<char, double> read_words(std::string_view words) {
    std::map<char, double> values;
    while (!(words = trimmed(words)).empty()) {
        const std::string_view word = words.substr(0, words.find(' '));
        words.remove_prefix(word.size());
        if (word.size() < 2 || word[0] < 'A' || word[0] > 'Z') continue;
        const std::string text(word.substr(word[1] == ':' ? 2 : 1));
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        if (!text.empty() && end == text.c_str() + text.size() && std::isfinite(value)) values[word[0]] = value;
    }
    return values;
}

void read_name(std::string_view line, BoardReport& board) {
    const std::string_view rest = line.substr(line.find(':') + 1);
    const std::size_t end = std::min(rest.find(" SOURCE_CODE_URL:"), rest.find(" PROTOCOL_VERSION:"));
    board.name = trimmed(rest.substr(0, end));
    const std::string_view key = "EXTRUDER_COUNT:";
    const std::size_t at = line.find(key);
    if (at != std::string_view::npos && at + key.size() < line.size()) {
        const char digit = line[at + key.size()];
        if (digit >= '0' && digit <= '9') board.extruders = digit - '0';
    }
}

/// The soft endstops: "M211 S1 ; ON" and "Min:  X0.00 Y0.00   Max:  X358.00 Y1.00", or both on one line in older
/// releases, "Soft endstops: On  Min: X0.00 ...". False: neither.
bool read_soft_endstops(std::string_view line, BoardReport& board) {
    constexpr std::string_view old_heading = "Soft endstops: ";
    bool found = false;
    if (line.starts_with("M211 ")) {
        const auto words = read_words(line.substr(5));
        if (const auto s = words.find('S'); s != words.end()) board.soft_endstops = s->second != 0;
        found = true;
    } else if (line.starts_with(old_heading)) {
        const std::string_view state = line.substr(old_heading.size());
        if (state.starts_with("On")) board.soft_endstops = true;
        if (state.starts_with("Off")) board.soft_endstops = false;
    }
    const std::size_t low = line.find("Min:"), high = line.find("Max:");
    if (low == std::string_view::npos || high == std::string_view::npos || high < low) return found;
    board.soft_min = read_words(line.substr(low + 4, high - low - 4));
    board.soft_max = read_words(line.substr(high + 4));
    return true;
}

void read_line(std::string_view line, BoardReport& board) {
    if (line.starts_with("echo:")) line = trimmed(line.substr(5));
    if (line.starts_with("FIRMWARE_NAME:")) return read_name(line, board);
    if (line.starts_with("Cap:")) {
        const std::size_t at = line.rfind(':');
        if (at > 4 && at + 2 == line.size())
            board.capabilities[std::string(line.substr(4, at - 4))] = line[at + 1] == '1';
        return;
    }
    for (const std::string_view code : {"M92", "M201", "M203", "M204", "M205", "M206"}) {
        if (!line.starts_with(code) || line.substr(code.size(), 1) != " ") continue;
        for (const auto& [letter, value] : read_words(line.substr(code.size())))
            board.values[std::string(code)][letter] = value;
        return;
    }
    if (line.starts_with("M113 ")) {
        const auto words = read_words(line.substr(5));
        if (const auto s = words.find('S'); s != words.end()) board.busy_every_s = s->second;
        return;
    }
    if (read_soft_endstops(line, board)) return;
    if (const auto reading = parse_switch(line)) board.switches.push_back(reading->name);
}

class Board {
public:
    Board(const BoardReport& board, const Printer& printer) : board_(board), printer_(printer) {}

    std::vector<std::string> problems() {
        if (board_.name.empty()) {
            problems_.push_back("M115: no answer that names a firmware; is it a Marlin, and at this baud rate?");
            return std::move(problems_);
        }
        if (board_.name.find("Marlin") == std::string::npos)
            problems_.push_back(fmt::format("M115: the firmware is \"{}\": not a Marlin", board_.name));
        capabilities();
        if (printer_.controller.dialect == Dialect::marlin && board_.extruders.value_or(0) > 0)
            problems_.push_back(fmt::format("M115: {} extruders: build with EXTRUDERS 0", *board_.extruders));
        for (const Axis axis : all_axes) {
            if (printer_.axis(axis).present()) check_axis(axis, printer_.axis(axis));
        }
        check_common_acceleration();
        check_soft_endstops();
        for (const LimitSwitch& s : switches_of(printer_)) check_switch(s);
        if (printer_.door.present() && !names_one({printer_.door.input}))
            problems_.push_back(fmt::format("M119: no {}: the door's switch is there", printer_.door.input));
        return std::move(problems_);
    }

private:
    [[nodiscard]] bool has(const std::string& capability) const {
        const auto found = board_.capabilities.find(capability);
        return found != board_.capabilities.end() && found->second;
    }

    void capabilities() {
        if (!has("EMERGENCY_PARSER"))
            problems_.push_back(
                "M115: no EMERGENCY_PARSER: an emergency stop waits for the queue; build with EMERGENCY_PARSER");
        if (printer_.emergency_line.signal == EmergencyLine::Signal::controller && !has("SOFTWARE_POWER"))
            problems_.push_back(
                "M115: no SOFTWARE_POWER: nothing holds the relay of the emergency line; build with PSU_CONTROL");
        if (board_.busy_every_s && !(*board_.busy_every_s > 0 && *board_.busy_every_s <= 10)) {
            problems_.push_back(fmt::format("M113: busy every {:g} s: must be 1 to 10 (DEFAULT_KEEPALIVE_INTERVAL 2)",
                                            *board_.busy_every_s));
        } else if (!board_.busy_every_s) {
            problems_.push_back("M113: no answer: build with HOST_KEEPALIVE_FEATURE");
        }
    }

    void check_axis(Axis which, const AxisSpec& axis) {
        if (axis.drive.known()) compare("M92", "steps a mm", which, axis.drive.steps_per_mm(), 1e-3);
        compare("M203", "mm/s", which, axis.speed_mm_s, 1e-2);
        compare("M201", "mm/s^2", which, axis.acceleration_mm_s2, 1e-2);
        check_home_offset(which, axis);
    }

    /// Marlin limits every move by M204, too, in addition to the M201 of each axis.
    void check_common_acceleration() {
        const auto values = board_.values.find("M204");
        if (values == board_.values.end()) return problems_.push_back("M503: does not say M204");
        double most = 0;
        for (const AxisSpec& axis : printer_.axes) {
            if (axis.present()) most = std::max(most, axis.acceleration_mm_s2);
        }
        for (const char letter : {'P', 'T'}) {
            const auto value = values->second.find(letter);
            if (value == values->second.end()) {
                problems_.push_back(fmt::format("M503: M204 does not name {}", letter));
            } else if (value->second < 0.99 * most) {
                problems_.push_back(
                    fmt::format("M503: M204 {} is {}, which slows axes of up to {} mm/s^2: send M204 {}{}", letter,
                                decimal(value->second), decimal(most), letter, decimal(most)));
            }
        }
    }

    /// Firmware without M206 has no offsets.
    void check_home_offset(Axis which, const AxisSpec& axis) {
        const auto values = board_.values.find("M206");
        if (values == board_.values.end()) return;
        const auto offset = values->second.find(axis.letter);
        if (offset != values->second.end() && std::abs(offset->second) >= 0.0005)
            problems_.push_back(
                fmt::format("M503: M206 {} is {}: the {} stands that far from where it is told: send M206 {}0",
                            axis.letter, decimal(offset->second), axis_name(which), axis.letter));
    }

    void check_soft_endstops() {
        if (!board_.soft_endstops)
            return problems_.push_back("M211: no answer: build with MIN_SOFTWARE_ENDSTOPS and MAX_SOFTWARE_ENDSTOPS");
        if (!*board_.soft_endstops)
            problems_.push_back("M211: soft endstops are off: nothing keeps the axes in their travel: send M211 S1");
        for (const Axis axis : all_axes) {
            if (printer_.axis(axis).present()) check_soft_travel(axis, printer_.axis(axis));
        }
    }

    /// Soft endstops within the travel silently truncate moves. E, an extruder, has none.
    void check_soft_travel(Axis which, const AxisSpec& axis) {
        if (axis.letter == 'E') return;
        constexpr double tolerance_mm = 0.01;  // reported with two decimals
        const auto low = board_.soft_min.find(axis.letter), high = board_.soft_max.find(axis.letter);
        if (low == board_.soft_min.end() || high == board_.soft_max.end()) {
            problems_.push_back(
                fmt::format("M211: does not say how far {} (the {}) may go", axis.letter, axis_name(which)));
            return;
        }
        const char place = marlin_place(printer_, axis).value_or(axis.letter);
        if (low->second > axis.min_um / 1000.0 + tolerance_mm || high->second < axis.max_um / 1000.0 - tolerance_mm) {
            problems_.push_back(
                fmt::format("M211: {} may go from {} to {}, the printer file has {} "
                            "to {}: build with {}_MIN_POS and {}_MAX_POS of the travel",
                            axis.letter, decimal(low->second), decimal(high->second), decimal(axis.min_um / 1000.0),
                            decimal(axis.max_um / 1000.0), place, place));
        }
    }

    void compare(const std::string& code, std::string_view unit, Axis which, double wanted, double tolerance) {
        const char letter = printer_.axis(which).letter;
        const auto values = board_.values.find(code);
        if (values == board_.values.end()) {
            if (missing_.empty() || missing_.back() != code)
                problems_.push_back(fmt::format("M503: does not say {}", missing_.emplace_back(code)));
            return;
        }
        const auto value = values->second.find(letter);
        if (value == values->second.end()) {
            problems_.push_back(fmt::format("M503: {} does not name {} (the {}): the firmware has no such axis", code,
                                            letter, axis_name(which)));
        } else if (!(std::abs(value->second - wanted) <= tolerance * wanted)) {
            problems_.push_back(fmt::format("M503: {} {} is {}, the printer file has {} {}: send {} {}{}", code, letter,
                                            decimal(value->second), decimal(wanted), unit, code, letter,
                                            decimal(wanted)));
        }
    }

    [[nodiscard]] bool names_one(const std::vector<std::string>& names) const {
        return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
            return std::find(board_.switches.begin(), board_.switches.end(), name) != board_.switches.end();
        });
    }

    void check_switch(const LimitSwitch& s) {
        const std::vector<std::string> names = switch_names(printer_, s);
        if (names_one(names)) return;
        const bool home = printer_.axis(s.axis).homes_to_max == s.at_max;
        problems_.push_back(fmt::format("M119: no {}: the {} {}", names.front(), axis_name(s.axis),
                                        home ? "homes there" : "has a limit switch there"));
    }

    const BoardReport& board_;
    const Printer& printer_;
    std::vector<std::string> problems_;
    std::vector<std::string> missing_;
};

}  // namespace

BoardReport parse_board_report(std::string_view text) {
    constexpr std::size_t most = 1000000;
    text = text.substr(0, most);
    BoardReport board;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        read_line(trimmed(line), board);
    }
    return board;
}

std::vector<std::string> check_board(const BoardReport& board, const Printer& printer) {
    return Board(board, printer).problems();
}

}  // namespace pliant::machine
