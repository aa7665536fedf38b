#include "printing/host/script.hpp"

#include <algorithm>

#include "printing/machine/follow.hpp"

namespace pliant::host {
namespace {

Status read_directive(std::string_view line, Script& script) {
    auto directive = machine::parse_directive(line);
    if (!directive) return tl::unexpected(directive.error());
    if (directive->expose) script.steps.emplace_back(*directive->expose);
    if (directive->stop_command) script.stop_commands.push_back(*directive->stop_command);
    return {};
}

Status read_command(std::string_view line, Script& script) {
    if (line.empty()) return {};
    if (const auto command = machine::parse_command(line); !command) return tl::unexpected(command.error());
    script.steps.emplace_back(std::string(line));
    return {};
}

/// One step on a machine that is at rest for every exposure: the host sends a fence before each.
Status follow_step(const Script& script, const machine::Printer& printer, std::size_t step, machine::Followed& at) {
    if (const auto* command = std::get_if<std::string>(&script.steps[step])) return at.line(printer, *command);
    const machine::Expose& light = *script.light(step);
    if (light.seconds > printer.limits.exposure_s)
        return input_error("exposure of {:g} s, the limit of {} is {:g} s", light.seconds, printer.name,
                           printer.limits.exposure_s);
    if (Status status = at.lock.light_on(false); !status) return status;
    at.lock.light_off();
    at.seconds += light.seconds;
    return {};
}

}  // namespace

Result<Script> read_script(std::string_view gcode) {
    Script script;
    for (int number = 1; !gcode.empty(); ++number) {
        const std::string_view line = gcode.substr(0, gcode.find('\n'));
        gcode.remove_prefix(std::min(gcode.size(), line.size() + 1));
        const Status status = machine::is_directive(line) ? read_directive(line, script)
                                                          : read_command(machine::strip_comment(line), script);
        if (!status) return input_error("G-code line {}: {}", number, status.error().message);
    }
    return script;
}

Result<std::vector<double>> script_times(const Script& script, const machine::Printer& printer) {
    machine::Followed at{machine::Interlock(printer)};
    std::vector<double> times;
    times.reserve(script.steps.size() + 1);
    for (std::size_t i = 0; i < script.steps.size(); ++i) {
        times.push_back(at.seconds);
        if (Status status = follow_step(script, printer, i, at); !status)
            return input_error("G-code step {}: {}", i + 1, status.error().message);
    }
    times.push_back(at.seconds);
    return times;
}

machine::Interlock state_before(const Script& script, const machine::Printer& printer, std::size_t step) {
    machine::Followed at{machine::Interlock(printer)};
    for (std::size_t i = 0; i < step; ++i) (void)follow_step(script, printer, i, at);
    return at.lock;
}

}  // namespace pliant::host
