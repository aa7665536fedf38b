// pliant firmware: what the controller must be built with for a machine; and asking a board what it was built with.
#include "machine/firmware.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "board.hpp"
#include "command.hpp"
#include "core/files.hpp"
#include "host/serial.hpp"
#include "host/steady_clock.hpp"
#include "inputs.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::string printer, release, save;
};

Status run_firmware(const Options& options) {
    Result<machine::Printer> printer = read_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    if (!options.release.empty()) {
        const auto release = machine::marlin_release(options.release);
        if (!release)
            return input_error("--release {}: must be one of {}", options.release,
                               fmt::join(machine::marlin_release_names, ", "));
        printer->controller.firmware = *release;
    }
    const Result<std::string> ini = machine::firmware_ini(*printer);
    if (!ini) return input_error("{}: {}", options.printer, ini.error().message);
    if (!options.save.empty()) return write_file(options.save, *ini);
    fmt::print("{}", *ini);
    return {};
}

/// Reads until a line is `wanted`, or nothing more has come for `silence_s`.
Status listen(host::SerialWire& wire, std::string_view wanted, double silence_s, std::string& heard) {
    constexpr double most_s = 20;
    const host::SteadyClock clock;
    const double begin_s = clock.now();
    std::string recent = "\n";
    while (clock.now() - begin_s < most_s) {
        const Result<std::string> bytes = wire.read(silence_s);
        if (!bytes) return tl::unexpected(bytes.error());
        if (bytes->empty()) return {};
        heard += *bytes;
        recent += *bytes;
        if (recent.find(fmt::format("\n{}", wanted)) != std::string::npos) return {};
    }
    return {};
}

}  // namespace

Result<std::string> ask_board(const std::string& port, int baud_rate) {
    Result<host::SerialWire> wire = host::SerialWire::open(port, baud_rate);
    if (!wire) return tl::unexpected(wire.error());
    std::string heard;
    constexpr double boot_s = 3;  // of silence, in which a board that was reset by opening its port starts
    constexpr double answer_s = 2;
    if (Status status = listen(*wire, "start", boot_s, heard); !status) return tl::unexpected(status.error());
    std::string ignored;
    if (Status status = listen(*wire, "nothing more", 0.3, ignored); !status) return tl::unexpected(status.error());
    heard.clear();
    for (const char* query : {"M115\n", "M503\n", "M211\n", "M119\n", "M113\n"}) {
        if (Status status = wire->write(query); !status) return tl::unexpected(status.error());
        if (Status status = listen(*wire, "ok", answer_s, heard); !status) return tl::unexpected(status.error());
    }
    return heard;
}

void add_firmware(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand("firmware", "list what Marlin must be built with for a machine");
    command->add_option("printer", options->printer, "printer file (TOML)")->required();
    command->add_option("--release", options->release,
                        "release of Marlin: 2.1.1, 2.1.2 or 2.1.3 (default: controller.firmware of the printer file)");
    command->add_option("-o,--output", options->save, "file for the list (config.ini of Marlin)");
    command->footer("Example: pliant firmware examples/printers/tower8.toml -o config.ini");
    on_call(*command, status, [options] { return run_firmware(*options); });
}

}  // namespace pliant::app
