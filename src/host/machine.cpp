#include "host/machine.hpp"

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

/// 0: the vat in use lies under the platform; 1: the carriage is on its way; 2: at the tower. Without a tower always 0.
int carriage_zone(const Printer& printer, const Interlock& state) {
    if (printer.store() != machine::Store::tower) return 0;
    const int at_um = state.position()[Axis::carriage];
    if (at_um == printer.carriage.tower_um) return 2;
    return at_um >= printer.carriage.print_um && at_um <= printer.carriage.print_um + printer.carriage.shear_um ? 0 : 1;
}

/// "X:0.00 Y:1.25 Z:4.00 ..." up to "Count"; nothing if a word of it is not whole.
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

}  // namespace

bool same_phase(const Printer& printer, const Interlock& a, const Interlock& b) {
    return a.hooked_vat() == b.hooked_vat() && carriage_zone(printer, a) == carriage_zone(printer, b);
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
    : clock_(clock), printer_(printer), link_(wire, clock, options), at_{Interlock(printer)} {}

void Machine::keep(Journal* journal) {
    journal_ = journal;
    noted_ = false;
}

Status Machine::connect(long base) {
    if (Status status = link_.connect(base); !status) return status;
    auto firmware = link_.introduce();
    if (!firmware) return tl::unexpected(firmware.error());
    firmware_ = std::move(*firmware);
    return link_.send_if_known("M113 S2");  // `busy` every two seconds, whatever the build says
}

Status Machine::note_go(long program, std::size_t step, const Interlock& before) {
    if (Status status = link_.fence(); !status) return status;
    noted_ = true;
    const auto number = journal_->append("go", {{"program", fmt::format("{}", program)},
                                                {"step", fmt::format("{}", step)},
                                                {"line", fmt::format("{}", link_.next_number())},
                                                {"state", write_state(before.state())}});
    return number ? Status{} : tl::unexpected(number.error());
}

Status Machine::send(long program, std::size_t step, std::string_view command) {
    machine::Followed after = at_;
    if (Status status = after.line(printer_, command); !status)
        return failure("{} is not sent: {}", command, status.error().message);
    if (journal_ != nullptr && (!noted_ || !same_phase(printer_, at_.lock, after.lock))) {
        if (Status status = note_go(program, step, at_.lock); !status) return status;
    }
    if (Status status = link_.send(command); !status) return status;
    // When the tower has done its stroke, the journal says so as soon as it can: in the middle of it nobody knows where
    // it stands.
    if (after.lock.in_hooks_stroke() && after.lock.position() != at_.lock.position()) noted_ = false;
    at_ = std::move(after);
    return {};
}

Status Machine::run(std::string_view program) {
    long number = 1;
    if (journal_ != nullptr) {
        const auto noted = journal_->append("program", {{"text", std::string(program)}});
        if (!noted) return tl::unexpected(noted.error());
        number = *noted;
        noted_ = false;
    }
    const std::vector<std::string> commands = commands_of(program);
    for (std::size_t i = 0; i < commands.size(); ++i) {
        if (Status status = send(number, i, commands[i]); !status) return status;
    }
    return rest();
}

Status Machine::rest() {
    noted_ = false;
    return link_.fence();
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
        if (found == Position::agrees) return {};
        if (found == Position::differs && std::exchange(differed, true))
            return failure("the controller is not where it was sent: it says {}", said);
    }
    return {};
}

}  // namespace pliant::host
