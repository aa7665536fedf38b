// pliant twin: the virtual printer as a device for any host program.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "printed.hpp"
#include "printing/job/png.hpp"
#include "printing/machine/printer.hpp"
#include "printing/operate/clock_file.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/twin/serve.hpp"
#include "printing/wire/scaled_time.hpp"

namespace pliant::app {
namespace {

struct TwinOptions {
    std::string printer;
    std::string link;
    std::string projector;
    std::string clock;
    double speed = 1;
    std::optional<double> seconds;
    std::vector<std::string> faults;
    std::string release;
    bool homes_first = false;
    bool advanced_ok = false, z_sync = false, report_fans = false, waits = false, no_emergency_parser = false;
    bool trace = false;
    Output output;
};

Result<twin::Options> twin_options(const TwinOptions& options) {
    twin::Options result;
    result.advanced_ok = options.advanced_ok;
    result.z_sync = options.z_sync;
    result.report_fans = options.report_fans;
    result.wait_every_s = options.waits ? 1 : 0;
    result.emergency_parser = !options.no_emergency_parser;
    result.boot_s = 1;
    result.homes_first = options.homes_first;
    if (!options.release.empty()) {
        result.release = machine::marlin_release(options.release);
        if (!result.release)
            return input_error("--release {}: the twin speaks like Marlin {}", options.release,
                               fmt::join(machine::marlin_release_names, ", "));
    }
    for (const std::string& text : options.faults) {
        const Result<twin::Fault> fault = twin::parse_fault(text);
        if (!fault) return tl::unexpected(fault.error());
        result.faults.push_back(*fault);
    }
    return result;
}

/// The projector: the current image is `shown.png` in a folder; without that file it is dark. A host writes a temporary
/// file and renames it.
class FolderProjector {
public:
    explicit FolderProjector(std::filesystem::path file) : file_(std::move(file)) {}

    Status look(twin::Twin& twin) {
        std::error_code error;
        const auto time = std::filesystem::last_write_time(file_, error);
        if (error) {
            if (lit_) twin.light_off();
            lit_ = false;
            return {};
        }
        if (lit_ && time == seen_) return {};
        const Result<std::string> bytes = read_file(file_);
        if (!bytes) return {};  // removed in the meantime
        const machine::Projector& p = twin.printer().projector;
        Result<job::Image> image = job::decode_png(*bytes, {p.width_px, p.height_px}, file_.string());
        if (!image) return tl::unexpected(image.error());
        twin.light_on(*image);
        lit_ = true;
        seen_ = time;
        return {};
    }

private:
    std::filesystem::path file_;
    std::filesystem::file_time_type seen_;
    bool lit_ = false;
};

void print_end(twin::Twin& twin) {
    const auto number = [](int count, std::string_view word) { return counted(static_cast<std::size_t>(count), word); };
    const twin::Log& log = twin.log();
    fmt::print("{:.1f} s on the machine's clock, {}, {}, {}, {}, {} cured\n", twin.now(), number(log.swaps, "swap"),
               number(log.exposures, "exposure"), number(log.bad_lines, "bad line"), number(log.resets, "reset"),
               counted(twin.cured().layers().size(), "layer"));
    for (const std::string& violation : log.violations) fmt::print("  interlock: {}\n", violation);
    for (const std::string& mishap : log.mishaps) fmt::print("  fault: {}\n", mishap);
    for (const std::string& fault : twin.missed_faults()) fmt::print("  the fault {} did not occur\n", fault);
    for (const std::string& fault : twin.cured().faults()) fmt::print("  light: {}\n", fault);
}

void print_end_json(twin::Twin& twin) {
    const twin::Log& log = twin.log();
    const nlohmann::json json = {{"seconds", twin.now()},          {"swaps", log.swaps},
                                 {"exposures", log.exposures},     {"bad_lines", log.bad_lines},
                                 {"resets", log.resets},           {"layers", twin.cured().layers().size()},
                                 {"interlocks", log.violations},   {"faults", log.mishaps},
                                 {"light", twin.cured().faults()}, {"missed_faults", twin.missed_faults()}};
    print_json(json);
}

Status run_twin(const TwinOptions& options) {
    if (Status status = host::check_speed(options.speed); !status) return status;
    if (options.seconds && !(*options.seconds > 0))
        return input_error("--seconds {}: must be above 0; without it the twin runs until Ctrl-C", *options.seconds);
    const Result<machine::Printer> printer = read_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    Result<twin::Options> wanted = twin_options(options);
    if (!wanted) return tl::unexpected(wanted.error());
    if (Status status = twin::check_faults(wanted->faults, *printer); !status) return status;
    Result<std::optional<job::Image>> mask = operate::load_mask(printer->projector, options.printer);
    if (!mask) return tl::unexpected(mask.error());
    wanted->mask = std::move(*mask);
    if (!options.projector.empty()) {
        std::error_code error;
        std::filesystem::create_directories(options.projector, error);
        if (!std::filesystem::is_directory(options.projector))
            return input_error("--projector {}: is not a folder and cannot be made one", options.projector);
    }
    Result<twin::Pty> pty = twin::Pty::open(options.link);
    if (!pty) return tl::unexpected(pty.error());
    std::optional<operate::ClockFile> clock;  // there before the twin says that it is
    if (!options.clock.empty()) {
        auto made = operate::ClockFile::create(options.clock);
        if (!made) return tl::unexpected(made.error());
        clock.emplace(std::move(*made));
    }
    twin::Twin twin(*printer, *wanted);
    if (!options.output.quiet && !options.output.json) {
        fmt::print("{} on {}, {} baud; Ctrl-C ends it\n", printer->name,
                   options.link.empty() ? pty->device() : options.link, printer->controller.baud_rate);
        std::fflush(stdout);
    }
    on_signal(OnSignal::ask);
    twin::ServeOptions serve;
    serve.speed = options.speed;
    serve.stop = [&] { return interrupted() || (options.seconds && twin.now() > *options.seconds); };
    FolderProjector projector(std::filesystem::path(options.projector) / "shown.png");
    if (!options.projector.empty()) serve.lights = [&](twin::Twin& t) { return projector.look(t); };
    if (clock) {
        serve.longest_step_s = 0.1 / options.speed;  // on the machine's clock
        serve.tick = [&](double now_s) { clock->set(now_s); };
    }
    if (options.trace) {
        serve.log = [](std::string_view bytes, bool from_host) {
            fmt::print(stderr, "{} {}\n", from_host ? ">" : "<", bytes);
        };
    }
    if (Status status = twin::serve(twin, *pty, serve); !status) return status;
    if (options.output.json)
        print_end_json(twin);
    else if (!options.output.quiet)
        print_end(twin);
    return {};
}

}  // namespace

void add_twin(CLI::App& app, int& status) {
    auto options = std::make_shared<TwinOptions>();
    CLI::App* command = app.add_subcommand(
        "twin", "run the virtual printer as a serial device that speaks Marlin, in real time or faster");
    command->add_option("--printer", options->printer, "printer file (TOML)")->required();
    command->add_option("--pty", options->link, "symbolic link to create to the device, such as /tmp/printer");
    command->add_option("--projector", options->projector, "folder whose shown.png is what the projector shows");
    command->add_option("--clock", options->clock,
                        "file for its clock, for print --clock: both then measure exposures by the same clock");
    command->add_option("--speed", options->speed, "speed-up factor; 1 is real time");
    command->add_option("--seconds", options->seconds, "end after this time on the machine's clock");
    command->add_option("--fault", options->faults, "KIND[:N[:AMOUNT]], repeatable: " + twin::fault_names())
        ->allow_extra_args(false);
    command->add_option("--release", options->release,
                        "release of Marlin, 2.1.1, 2.1.2 (any 2.1.2.x) or 2.1.3, in place of the printer file's");
    command->add_flag("--home-first", options->homes_first, "ignore moves of axes that are not homed");
    command->add_flag("--advanced-ok", options->advanced_ok, "answer ok N12 P15 B3");
    command->add_flag("--z-sync", options->z_sync, "block on moves of the platform and say Z_move_comp");
    command->add_flag("--report-fans", options->report_fans, "say M106 P0 S255 when a fan changes");
    command->add_flag("--wait", options->waits, "say wait every second while idle");
    command->add_flag("--no-emergency-parser", options->no_emergency_parser,
                      "M112, M108 and M410 are queued like any other command");
    command->add_flag("--trace", options->trace, "log all serial traffic to standard error");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant twin --printer examples/printers/tower.toml --pty /tmp/printer --speed 100");
    on_call(*command, status, [options] { return run_twin(*options); });
}

}  // namespace pliant::app
