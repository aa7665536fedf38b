#include "printing/machine/gcode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/core/parse_all.hpp"
#include "printing/job/exposure.hpp"

namespace pliant::machine {
namespace {

constexpr double largest_value = 1e9;

bool is_capital(char c) {
    return c >= 'A' && c <= 'Z';
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
    return text;
}

/// Removes the text up to the next blank from `rest` and returns it.
std::string_view take_token(std::string_view& rest) {
    rest = trim(rest);
    const std::string_view token = rest.substr(0, rest.find(' '));
    rest.remove_prefix(token.size());
    return token;
}

Result<Word> parse_word(std::string_view token) {
    Word word;
    word.letter = token.front();
    if (!is_capital(word.letter)) return input_error("\"{}\" does not begin with a capital letter", token);
    if (token.size() == 1) return word;
    double value = 0;
    const bool readable = parse_all(token.substr(1), value) && std::abs(value) <= largest_value;
    if (readable && token.find_first_of("eE", 1) != std::string_view::npos)
        return input_error("\"{}\" has an exponent, which Marlin does not read: write {}{}", token, word.letter, value);
    if (!readable) return input_error("\"{}\" is not a letter and a number", token);
    word.value = value;
    return word;
}

/// M118's parameters (A1, E1, Pn) come before its message.
bool is_message_parameter(std::string_view token) {
    return token.size() == 2 && std::string_view("AEP").find(token[0]) != std::string_view::npos && token[1] >= '0' &&
           token[1] <= '9';
}

}  // namespace

bool Command::has(char l) const {
    return std::any_of(words.begin(), words.end(), [l](const Word& w) { return w.letter == l; });
}

std::optional<double> Command::value(char l) const {
    for (const Word& w : words) {
        if (w.letter == l) return w.value;
    }
    return std::nullopt;
}

std::string_view strip_comment(std::string_view line) {
    return trim(line.substr(0, line.find(';')));
}

Result<Command> parse_command(std::string_view line) {
    const auto odd = std::find_if(line.begin(), line.end(), [](char c) { return c < ' ' || c > '~'; });
    if (odd != line.end()) return input_error("a command must be printable ASCII");
    std::string_view rest = trim(line);
    const std::string_view head = take_token(rest);
    Command command;
    if (head.size() < 2 || (head[0] != 'G' && head[0] != 'M') || !parse_all(head.substr(1), command.number) ||
        command.number < 0 || command.number > 9999) {
        return input_error("\"{}\" is not a command such as G1 or M400", head);
    }
    command.letter = head[0];
    const bool message = command.is('M', 118) || command.is('M', 117);
    while (!trim(rest).empty()) {
        std::string_view ahead = rest;
        const std::string_view token = take_token(ahead);
        if (message && (command.number == 117 || !is_message_parameter(token))) {
            command.text = trim(rest);
            break;
        }
        const auto word = parse_word(token);
        if (!word) return tl::unexpected(word.error());
        if (command.has(word->letter)) return input_error("{} stands twice", word->letter);
        command.words.push_back(*word);
        rest = ahead;
    }
    return command;
}

std::optional<Axis> axis_of_letter(const Printer& printer, char letter) {
    for (const Axis axis : all_axes) {
        if (printer.axis(axis).letter == letter) return axis;
    }
    return std::nullopt;
}

std::string write_move(const Printer& printer, const Position& from, const Position& to, double feed_mm_s) {
    std::string line;
    for (const Axis axis : all_axes) {
        if (from[axis] != to[axis]) line += fmt::format(" {}{:.3f}", printer.axis(axis).letter, to[axis] / 1000.0);
    }
    return line.empty() ? line : fmt::format("G1{} F{:.1f}", line, feed_mm_s * 60);
}

std::string write_home(const Printer& printer, Axis axis) {
    const AxisSpec& spec = printer.axis(axis);
    if (spec.homes_by_hand) return fmt::format("G92 {}{:.3f}", spec.letter, spec.home_um() / 1000.0);
    return fmt::format("G28 {}", spec.letter);
}

std::vector<std::string> preamble(const Printer& printer) {
    std::vector<std::string> lines = {"G90"};
    const bool extruder =
        std::any_of(printer.axes.begin(), printer.axes.end(), [](auto& a) { return a.letter == 'E'; });
    // The extruder has a positioning mode of its own and refuses cold moves.
    if (extruder) lines.insert(lines.end(), {"M82", "M302 P1"});
    lines.emplace_back("M84 S0");
    return lines;
}

std::vector<Axis> homing_order(const Printer& printer) {
    std::vector<Axis> order;
    for (const Axis axis : {Axis::platform, Axis::carriage, Axis::tower, Axis::table}) {
        if (printer.axis(axis).present()) order.push_back(axis);
    }
    return order;
}

namespace {

/// A fan output (M106 and M107), or any pin (M42).
struct Pin {
    bool fan = false;
    int number = 0;
    bool on = false;
    static std::optional<Pin> of(const Command& command) {
        const int number = static_cast<int>(command.value('P').value_or(0));
        const double value = command.value('S').value_or(255);
        if (command.is('M', 106)) return Pin{true, number, value > 0};
        if (command.is('M', 107)) return Pin{true, number, false};
        if (command.is('M', 42)) return Pin{false, number, value > 0};
        return std::nullopt;
    }
};

/// The output that its command `on` switches.
std::optional<Pin> pin_of(const Switch& device) {
    if (device.on.empty()) return std::nullopt;
    const auto parsed = parse_command(device.on);
    return parsed ? Pin::of(*parsed) : std::nullopt;
}

}  // namespace

std::optional<bool> switched(const Switch& device, const Command& command) {
    const auto pin = Pin::of(command);
    const auto own = pin ? pin_of(device) : std::nullopt;
    if (!own || own->fan != pin->fan || own->number != pin->number) return std::nullopt;
    return pin->on == own->on;
}

bool same_output(const Switch& a, const Switch& b) {
    const auto one = pin_of(a), other = pin_of(b);
    return one && other && one->fan == other->fan && one->number == other->number;
}

bool on_without_power(const Switch& device) {
    const auto pin = pin_of(device);
    return pin && !pin->on;
}

bool moves_emergency_line(const Printer& printer, const Command& command) {
    const EmergencyLine& line = printer.emergency_line;
    return line.signal == EmergencyLine::Signal::controller && command.is('M', 42) &&
           command.value('P') == static_cast<double>(line.pin);
}

std::string write_dwell(double seconds) {
    return fmt::format("G4 P{:.0f}", seconds * 1000);
}

Result<Position> move_target(const Printer& printer, const Command& command, const Position& from) {
    Position to = from;
    for (const Word& word : command.words) {
        if (word.letter == 'F') continue;
        const auto axis = axis_of_letter(printer, word.letter);
        if (!axis) return input_error("{} is not an axis of {}", word.letter, printer.name);
        if (!word.value || std::abs(*word.value) > 1e5) return input_error("{} needs a position in mm", word.letter);
        to[*axis] = static_cast<int>(std::lround(*word.value * 1000));
    }
    return to;
}

std::string write_expose(const Expose& e) {
    return fmt::format(";@expose layer={} material={} seconds={:.3f} image={}", e.layer, e.material, e.seconds,
                       e.image);
}

std::string write_stop(std::string_view command) {
    return fmt::format(";@stop {}", command);
}

bool is_directive(std::string_view line) {
    return line.substr(0, 2) == ";@";
}

namespace {

Result<Expose> parse_expose(std::string_view rest) {
    Expose e;
    unsigned seen = 0;
    for (rest = trim(rest); !rest.empty(); rest = trim(rest)) {
        // The image comes last and extends to the end of the line: material names may contain blanks.
        const bool image = rest.substr(0, 6) == "image=";
        const std::string_view token = image ? rest : take_token(rest);
        if (image) rest = {};
        const std::size_t equals = token.find('=');
        if (equals == std::string_view::npos) return input_error("\"{}\" is not KEY=VALUE", token);
        const std::string_view key = token.substr(0, equals);
        const std::string_view value = token.substr(equals + 1);
        bool good = false;
        if (key == "layer") good = parse_all(value, e.layer) && e.layer >= 0, seen |= 1;
        if (key == "material") good = parse_all(value, e.material) && e.material >= 0, seen |= 2;
        if (key == "seconds")
            good = parse_all(value, e.seconds) && e.seconds > 0 && e.seconds <= job::longest_exposure_s, seen |= 4;
        if (key == "image") e.image = value, good = !value.empty(), seen |= 8;
        if (!good) return input_error("\"{}\" is not understood in an expose directive", token);
    }
    if (seen != 15) return input_error("an expose directive needs layer, material, seconds and image");
    return e;
}

}  // namespace

Result<Directive> parse_directive(std::string_view line) {
    std::string_view rest = line.substr(std::min<std::size_t>(2, line.size()));
    const std::string_view word = take_token(rest);
    Directive directive;
    if (word == "stop") {
        const auto command = parse_command(trim(rest));
        if (!command) return tl::unexpected(command.error());
        directive.stop_command = trim(rest);
        return directive;
    }
    if (word != "expose") return input_error("\"{}\" is not a directive; known are expose and stop", word);
    const auto expose = parse_expose(rest);
    if (!expose) return tl::unexpected(expose.error());
    directive.expose = *expose;
    return directive;
}

}  // namespace pliant::machine
