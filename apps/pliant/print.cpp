// pliant print: prints a job on a machine at a serial port or on the virtual printer, which receives the same G-code
// and images.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "../standard_streams.hpp"
#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "presentation/print_report/print_report.hpp"
#include "print_live.hpp"
#include "print_virtual.hpp"
#include "printed.hpp"
#include "printing/twin/finding.hpp"
#include "printing/wire/serial.hpp"

namespace pliant::app {
namespace {

struct PrintOptions {
    LiveOptions live;
    std::vector<std::string> accepted, faults;
    bool twin = false;
    bool list_ports = false;
    bool given_speed = false;
    std::vector<std::string> given;  ///< the names of all options on the command line
};

/// Every result has a name of its kind, and none that of the job, which is only read.
Status check_outputs(const LiveOptions& live) {
    Status named = check_ending("--report", live.report, "a page about a print", ".html");
    if (named) named = check_ending("-o", live.verdict, "the report of a virtual print", ".json");
    if (!named) return named;
    const std::pair<const char*, const std::string&> outputs[] = {
        {"--report", live.report}, {"-o", live.verdict}, {"--journal", live.journal}};
    for (const auto& [option, file] : outputs) {
        std::error_code none;
        if (!file.empty() && std::filesystem::equivalent(file, live.job, none))
            return input_error("{} {}: is the job itself; give another name", option, file);
    }
    return check_file_places({live.report, live.verdict, live.journal});
}

/// The report of a print from its journal, whoever printed it. Options of printing would do nothing.
Result<int> report_on_journal(const PrintOptions& options) {
    constexpr std::array<std::string_view, 4> allowed{"--journal", "--report", "--quiet", "--json"};
    for (const std::string& given : options.given) {
        if (std::ranges::find(allowed, given) == allowed.end())
            return input_error(
                "{} goes with --port or --twin; without them --report tells of the print that the journal holds",
                given);
    }
    const LiveOptions& live = options.live;
    const std::string journal = live.journal.empty() ? live.job + ".journal" : live.journal;
    const Result<std::string> page = report::print_report(live.job, journal, {});
    if (!page) return tl::unexpected(page.error());
    if (Status written = write_file(live.report, *page); !written) return tl::unexpected(written.error());
    return exit_done;
}

int list_ports(const Output& output) {
    if (output.json) {
        nlohmann::json ports = nlohmann::json::array();
        for (const host::SerialPort& port : host::serial_ports())
            ports.push_back({{"device", port.device}, {"name", port.name}});
        print_json(nlohmann::json{{"ports", ports}});
        return exit_done;
    }
    for (const host::SerialPort& port : host::serial_ports()) fmt::print("{}  {}\n", port.device, port.name);
    return exit_done;
}

/// An option that would do nothing is a mistake.
Status check_given_options(const PrintOptions& options) {
    const LiveOptions& live = options.live;
    const auto refuse = [](const char* option, const char* needed) {
        return input_error("{} goes with {}", option, needed);
    };
    if (options.twin) {
        if (!live.clock_file.empty()) return refuse("--clock", "--port");
        if (!live.emergency_line.empty()) return refuse("--emergency-line", "--port");
        if (!live.projector.empty()) return refuse("--projector", "--port");
        if (live.resume)
            return input_error("--resume needs --port DEVICE; the virtual printer of --twin ends with its command");
    } else {
        if (!options.accepted.empty()) return refuse("--accept", "--twin");
        if (!options.faults.empty()) return refuse("--fault", "--twin, or with pliant twin");
        if (!live.verdict.empty()) return refuse("-o", "--twin");
        if (live.projector.empty()) return input_error("say where the light comes from: --projector DISPLAY or FOLDER");
    }
    if (!live.resume && live.assume_lit_s) return refuse("--assume-lit", "--resume");
    if (!live.resume && live.assume_vats_untouched) return refuse("--assume-vats-untouched", "--resume");
    return {};
}

Result<int> print(PrintOptions& options) {
    if (options.list_ports) return list_ports(options.live.output);
    if (options.live.job.empty()) return input_error("name the job to print, such as gripper.zip");
    if (Status outputs = check_outputs(options.live); !outputs) return tl::unexpected(outputs.error());
    if (!options.twin && options.live.port.empty() && !options.live.report.empty()) return report_on_journal(options);
    if (options.twin == !options.live.port.empty())
        return input_error("say where to print: --port DEVICE (see --list-ports) or --twin");
    if (Status given = check_given_options(options); !given) return tl::unexpected(given.error());
    auto accepted = twin::accepted_findings(options.accepted);
    if (!accepted) return input_error("--accept: {}", accepted.error().message);
    options.live.accepted = std::move(*accepted);
    for (const std::string& text : options.faults) {
        const Result<twin::Fault> fault = twin::parse_fault(text);
        if (!fault) return tl::unexpected(fault.error());
        options.live.faults.push_back(*fault);
    }
    outlive_readers();
    if (options.twin && !options.given_speed) return print_virtual(options.live);
    return print_live(options.live);
}

}  // namespace

void add_print(CLI::App& app, int& status) {
    auto options = std::make_shared<PrintOptions>();
    LiveOptions& live = options->live;
    CLI::App* command = app.add_subcommand("print", "print a job on a machine, or on the virtual printer");
    command->add_option("job", live.job, "job file (.zip)");
    command->add_option("--port", live.port, "serial port of the machine");
    command->add_flag("--twin", options->twin, "print on the virtual printer and compare what cured with the model");
    command
        ->add_option("--accept", options->accepted,
                     "a finding of --twin that does not fail the print: overcure, volume, contamination, cleaning")
        ->type_name("FINDING")
        ->allow_extra_args(false);
    command
        ->add_option("--fault", options->faults,
                     "with --twin: a fault to inject, KIND[:N[:AMOUNT]], repeatable: " + twin::fault_names())
        ->type_name("FAULT")
        ->allow_extra_args(false);
    command->add_flag("--list-ports", options->list_ports, "list the serial ports");
    command->add_option("--projector", live.projector,
                        "number of a display, or a folder whose shown.png is what the projector shows");
    command->add_flag("--resume", live.resume, "resume an interrupted print");
    command->add_option("--journal", live.journal, "journal file, in place of JOB.zip.journal");
    command->add_option("--assume-lit", live.assume_lit_s,
                        "duration of the interrupted exposure in seconds, where the journal does not know it");
    command->add_flag("--assume-vats-untouched", live.assume_vats_untouched,
                      "another program has used the controller since, but moved no vat");
    command->add_option(
        "--emergency-line", live.emergency_line,
        "line that an emergency stop switches, overriding the printer file: dtr:PORT, rts:PORT, file:FILE (1 "
        "stops), file-low:FILE (0 stops), none");
    command->add_flag("--yes", live.yes, "the vats are in place and filled: do not ask");
    command->add_option("--after-layer", live.after_layer,
                        "command to run after every layer, with its number in PLIANT_LAYER");
    command->add_option("--report", live.report,
                        "HTML report of the print (.html); without --port and --twin: from the journal");
    CLI::Option* speed =
        command->add_option("--speed", live.speed, "speed-up factor, for virtual printers; 1 is real time");
    command->add_option("--clock", live.clock_file, "clock of the virtual printer (twin --clock FILE)");
    command->add_option("-o,--output", live.verdict, "file for the report of --twin (.json)");
    add_output_options(*command, live.output, true);
    command->footer(
        "Keys: space pauses and resumes, c cancels, e is the emergency stop; Ctrl-C parks, --resume continues.\n"
        "Example: pliant print gripper.zip --port /dev/ttyACM0 --projector pictures\n"
        "         pliant print gripper.zip --twin");
    on_call(*command, status, [options, speed, command] {
        options->given_speed = speed->count() > 0;
        for (const CLI::Option* option : command->get_options()) {
            if (option->count() > 0 && !option->get_positional()) options->given.push_back(option->get_name());
        }
        return print(*options);
    });
}

}  // namespace pliant::app
