#include "printing/host/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>

namespace pliant::host {
namespace {

using machine::Axis;
using machine::Interlock;
using machine::Printer;

/// 0: the vat in use is under the platform; 1: the carriage is between; 2: at the tower. Without a tower always 0.
int carriage_zone(const Printer& printer, const Interlock& state) {
    if (!printer.has_carriage()) return 0;
    const int at_um = state.position()[Axis::carriage];
    if (at_um == printer.carriage.tower_um) return 2;
    return at_um >= printer.carriage.print_um && at_um <= printer.carriage.print_um + printer.carriage.shear_um ? 0 : 1;
}

/// "X:0.00 Y:1.25 Z:4.00 ..." up to "Count"; nothing if a word is malformed.
std::map<char, double> axis_values(std::string_view answer) {
    std::map<char, double> values;
    answer = answer.substr(0, answer.find("Count"));
    while (!answer.empty()) {
        const std::string_view word = answer.substr(0, answer.find(' '));
        answer.remove_prefix(std::min(answer.size(), word.size() + 1));
        if (word.empty()) continue;
        double value = 0;
        const auto [end, code] =
            std::from_chars(word.data() + std::min<std::size_t>(2, word.size()), word.data() + word.size(), value);
        if (word.size() < 3 || word[1] != ':' || code != std::errc() || end != word.data() + word.size()) return {};
        values[word[0]] = value;
    }
    return values;
}

/// The axes that a G28 names, or all of them.
std::vector<Axis> homed_by(const Printer& printer, std::string_view command) {
    std::vector<Axis> axes;
    const auto parsed = machine::parse_command(command);
    for (const machine::Word& word : parsed ? parsed->words : std::vector<machine::Word>{}) {
        if (const auto axis = machine::axis_of_letter(printer, word.letter)) axes.push_back(*axis);
    }
    return axes.empty() ? machine::homing_order(printer) : axes;
}

/// Along the whole travel, plus Marlin's second, slow approach.
double longest_homing_s(const Printer& printer, const std::vector<Axis>& axes) {
    constexpr double slack = 1.1, again_s = 8;
    double seconds = 0;
    for (const Axis axis : axes) {
        const machine::AxisSpec& spec = printer.axis(axis);
        if (spec.homes_by_hand) continue;
        seconds += slack * (spec.max_um - spec.min_um) / 1000.0 / spec.homing_speed_mm_s + again_s;
    }
    return seconds;
}

/// The name in M119 of the switch that the axis homes to.
std::string home_switch(const Printer& printer, Axis axis) {
    return machine::switch_names(printer, {axis, printer.axis(axis).homes_to_max, false}).front();
}

}  // namespace

bool same_phase(const Printer& printer, const Interlock& a, const Interlock& b) {
    return a.hooked_vat() == b.hooked_vat() && carriage_zone(printer, a) == carriage_zone(printer, b) &&
           a.tray_vat() == b.tray_vat() && a.fork_out() == b.fork_out();
}

Position compare_position(const Printer& printer, const Interlock& state, std::string_view answer) {
    constexpr double rounding_mm = 0.011;  // two decimals on the wire
    const std::map<char, double> values = axis_values(answer);
    for (const Axis axis : machine::all_axes) {
        const machine::AxisSpec& spec = printer.axis(axis);
        if (!spec.present()) continue;
        const auto found = values.find(spec.letter);
        if (found == values.end()) return Position::unread;
        if (state.homed(axis) && std::abs(found->second - state.position()[axis] / 1000.0) > rounding_mm)
            return Position::differs;
    }
    return Position::agrees;
}

Machine::Machine(Wire& wire, Clock& clock, const Printer& printer, const LinkOptions& options)
    : clock_(clock),
      printer_(printer),
      link_(wire, clock, options),
      at_{Interlock(printer)},
      pressed_(printer.limit_switches.size()) {}

void Machine::keep(Journal* journal) {
    journal_ = journal;
    noted_ = false;
    place_.reset();
}

Status Machine::connect(long base) {
    if (Status status = link_.connect(base); !status) return status;
    auto firmware = link_.introduce();
    if (!firmware) return tl::unexpected(firmware.error());
    firmware_ = std::move(*firmware);
    return link_.send_if_known("M113 S2");  // `busy` every two seconds, whatever the build's default
}

Status Machine::note_go(long program, std::size_t step, const Interlock& before, long most) {
    if (Status status = link_.fence(); !status) return status;
    if (printer_.door.present()) {
        if (Status status = look_at_switches(); !status) return status;
    }
    noted_ = true;
    return write_go(program, step, before, most);
}

Status Machine::write_go(long program, std::size_t step, const Interlock& before, long most) {
    noted_line_ = link_.next_number();
    const auto number = journal_->append("go", {{"program", fmt::format("{}", program)},
                                                {"step", fmt::format("{}", step)},
                                                {"line", fmt::format("{}", noted_line_)},
                                                {"most", fmt::format("{}", most)},
                                                {"state", write_state(before.state())}});
    return number ? Status{} : tl::unexpected(number.error());
}

Status Machine::keep_place() {
    constexpr long most_asked = most_questions / 2;
    if (journal_ == nullptr || !place_ || link_.next_number() - noted_line_ < most_asked) return {};
    return write_go(place_->program, place_->step, at_.lock, 0);
}

// Switches.

void Machine::hear(std::string_view line) {
    if (!has_switches()) return;
    const auto reading = machine::parse_switch(line);
    if (!reading) return;
    if (reading->name == printer_.door.input) door_open_ = reading->pressed;
    for (std::size_t i = 0; i < pressed_.size(); ++i) {
        const auto names = machine::switch_names(printer_, printer_.limit_switches[i]);
        if (std::find(names.begin(), names.end(), reading->name) != names.end()) pressed_[i] = reading->pressed;
    }
}

std::vector<machine::SwitchReading> Machine::limit_switches() const {
    std::vector<machine::SwitchReading> heard;
    for (std::size_t i = 0; i < pressed_.size(); ++i) {
        if (pressed_[i])
            heard.push_back({machine::switch_names(printer_, printer_.limit_switches[i]).front(), *pressed_[i]});
    }
    return heard;
}

Status Machine::ask_for_door() {
    constexpr double every_s = 0.25;
    if (!printer_.door.present() || !link_.is_quiet() || clock_.now() - switches_asked_s_ < every_s) return {};
    switches_asked_s_ = clock_.now();
    noted_ = false;
    if (Status status = keep_place(); !status) return status;
    return link_.send("M119");
}

/// Nothing of it remains on the wire afterwards: a new session may begin next.
Status Machine::ask_for_switches() {
    constexpr double every_s = 1;
    if (!has_switches() || clock_.now() - switches_asked_s_ < every_s) return {};
    switches_asked_s_ = clock_.now();
    noted_ = false;
    const auto answers = link_.ask("M119");
    return answers ? Status{} : tl::unexpected(answers.error());
}

/// Answers may lose bytes: what is missing is queried again before it counts as absent.
Status Machine::look_at_switches() {
    if (!has_switches()) return {};
    constexpr int attempts = 3;
    noted_ = false;
    Status status;
    for (int i = 0; i < attempts; ++i) {
        const auto answers = link_.ask("M119");
        if (!answers) return tl::unexpected(answers.error());
        std::vector<machine::SwitchReading> readings;
        for (const std::string& answer : *answers) {
            if (auto reading = machine::parse_switch(answer)) readings.push_back(std::move(*reading));
        }
        if (const auto open = machine::door_open(printer_, readings)) door_open_ = open;
        status = machine::check_switches(printer_, at_.lock, readings);
        if (status) break;
    }
    return status;
}

/// With a dead switch, the axis would push against its end until Marlin gives up, after one and a half times the
/// travel.
Status Machine::wait_for_homing(std::string_view command) {
    const std::vector<Axis> axes = homed_by(printer_, command);
    noted_ = false;
    const Status status = link_.fence(longest_homing_s(printer_, axes));
    if (status || !(link_.ran_late() || link_.homing_failed())) return status;
    if (!link_.has_halted()) link_.halt();
    std::string where;
    for (const Axis axis : axes) {
        where += fmt::format("{}the {} did not reach its switch ({})", where.empty() ? "" : " or ",
                             machine::axis_name(axis), home_switch(printer_, axis));
    }
    return failure(
        "homing failed: {}; the board is halted: check the switch, its plug and its wire, then reset the board", where);
}

/// Checks every axis that `command` has homed.
Status Machine::after_homing(std::string_view command) {
    if (Status status = wait_for_homing(command); !status || printer_.limit_switches.empty()) return status;
    for (const Axis axis : homed_by(printer_, command)) {
        if (Status status = leave_switch(axis); !status) return status;
    }
    return {};
}

/// A stuck switch ends homing wherever the axis is. So the axis moves beyond the reach of the switch, if the machine
/// allows that, the switch is checked, and the axis returns.
Status Machine::leave_switch(Axis axis) {
    const machine::AxisSpec& spec = printer_.axis(axis);
    const machine::Position home = at_.lock.position();
    machine::Position off = home;
    off[axis] += (spec.homes_to_max ? -1 : 1) * (machine::switch_reach_um + 1000);
    machine::Followed trial = at_;
    const std::string there = machine::write_move(printer_, home, off, spec.homing_speed_mm_s);
    const std::string back = machine::write_move(printer_, off, home, spec.homing_speed_mm_s);
    if (!trial.line(printer_, there) || !trial.line(printer_, back)) return {};
    Status status = run("G90\n" + there + "\n");
    if (status) status = look_at_switches();
    return status ? run(back + "\n") : status;
}

// Sending.

Status Machine::send(long program, std::size_t step, std::string_view command) {
    machine::Followed after = at_;
    if (Status status = after.line(printer_, command); !status)
        return failure("{} is not sent: {}", command, status.error().message);
    // After G28, commands follow that wait for it and check the switch. They are not steps of this program, so their
    // lines must not be counted as its next steps.
    const bool alone = command.substr(0, 3) == "G28";
    if (journal_ != nullptr && (!noted_ || alone || !same_phase(printer_, at_.lock, after.lock))) {
        if (Status status = note_go(program, step, at_.lock, alone ? 1 : 0); !status) return status;
    }
    if (alone && journal_ == nullptr) {  // homing starts when the moves before it are done
        if (Status status = link_.fence(); !status) return status;
    }
    place_.reset();
    if (Status status = link_.send(command); !status) return status;
    // As soon as the tower has completed its stroke the journal records it: part-way through, its position cannot be
    // reconstructed.
    if (after.lock.in_hooks_stroke() && after.lock.position() != at_.lock.position()) noted_ = false;
    at_ = std::move(after);
    return alone ? after_homing(command) : Status{};
}

Status Machine::run(std::string_view program, const std::function<Status()>& before_each) {
    long number = 1;
    if (journal_ != nullptr) {
        const auto noted = journal_->append("program", {{"text", std::string(program)}});
        if (!noted) return tl::unexpected(noted.error());
        number = *noted;
        noted_ = false;
    }
    const std::vector<std::string> commands = commands_of(program);
    for (std::size_t i = 0; i < commands.size(); ++i) {
        if (Status status = before_each ? before_each() : Status{}; !status) return status;
        if (Status status = send(number, i, commands[i]); !status) return status;
    }
    if (Status status = rest(); !status) return status;
    place_ = Place{number, commands.size()};
    return {};
}

Status Machine::rest() {
    noted_ = false;
    return link_.fence();
}

Status Machine::stand_where_stopped() {
    noted_ = false;
    place_.reset();
    machine::Position position = at_.lock.position();
    const auto answers = link_.ask("M114");
    for (const std::string& answer : answers ? *answers : std::vector<std::string>{}) {
        const std::map<char, double> values = axis_values(answer);
        for (const Axis axis : machine::all_axes) {
            const auto found = values.find(printer_.axis(axis).letter);
            if (printer_.axis(axis).present() && found != values.end())
                position[axis] = static_cast<int>(std::lround(std::clamp(found->second, -1e6, 1e6) * 1000));
        }
    }
    at_.lock.stopped_at(position);
    return answers ? Status{} : tl::unexpected(answers.error());
}

Status Machine::rest_in_place() {
    constexpr int attempts = 3;
    noted_ = false;
    bool differed = false;
    for (int i = 0; i < attempts; ++i) {
        const auto answers = link_.ask("M114");
        if (!answers) return tl::unexpected(answers.error());
        Position found = Position::unread;
        std::string said;
        for (const std::string& answer : *answers) {
            const Position read = compare_position(printer_, at_.lock, answer);
            if (read == Position::unread) continue;
            found = read;
            said = answer;
        }
        if (found == Position::agrees) break;
        if (found == Position::differs && std::exchange(differed, true))
            return failure("the controller is not at the commanded position: it reports {}", said);
    }
    return look_at_switches();
}

}  // namespace pliant::host
