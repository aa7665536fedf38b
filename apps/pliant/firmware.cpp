// pliant firmware: the controller configuration that a machine needs; and queries a board for its own.
#include "printing/machine/firmware.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "printed.hpp"
#include "printing/machine/marlin_files.hpp"

namespace pliant::app {
namespace {

struct FirmwareOptions {
    std::string printer, release, save, marlin, write;
    Output output;
};

/// A configuration file of Marlin in its source folder, or in the subfolder Marlin.
Result<machine::MarlinFile> read_marlin_file(const std::string& folder, const char* name) {
    const std::filesystem::path root = folder;
    for (const std::filesystem::path& path : {root / name, root / "Marlin" / name}) {
        if (!std::filesystem::exists(path)) continue;
        constexpr std::uintmax_t limit_bytes = 4 << 20;
        Result<std::string> text = read_file(path, limit_bytes);
        if (!text) return tl::unexpected(text.error());
        return machine::MarlinFile{path.string(), std::move(*text)};
    }
    return input_error("--marlin {}: has neither {} nor Marlin/{}; give the folder of Marlin's source", folder, name,
                       name);
}

constexpr const char* record_name = "pliant_settings.txt";

/// Only the output of an earlier run may be replaced, never a Marlin source folder that its files may have been copied
/// into.
Status check_target(const std::filesystem::path& folder) {
    std::error_code code;
    for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
        const std::string name = entry.path().filename().string();
        if (name != "Configuration.h" && name != "Configuration_adv.h" && name != record_name)
            return input_error("--write {}: holds {} and is not overwritten; choose another folder", folder.string(),
                               name);
    }
    return {};
}

Status write_marlin(const FirmwareOptions& options, const machine::Printer& printer) {
    const auto settings = machine::firmware_settings(printer);
    if (!settings) return input_error("{}: {}", options.printer, settings.error().message);
    const auto configuration = read_marlin_file(options.marlin, "Configuration.h");
    if (!configuration) return tl::unexpected(configuration.error());
    const auto configuration_adv = read_marlin_file(options.marlin, "Configuration_adv.h");
    if (!configuration_adv) return tl::unexpected(configuration_adv.error());
    const auto files =
        machine::configure_marlin(*settings, printer.controller.firmware, *configuration, *configuration_adv);
    if (!files) return tl::unexpected(files.error());
    if (Status status = check_target(options.write); !status) return status;
    const Status status = write_folder(options.write, record_name, [&](const std::filesystem::path& folder) -> Status {
        if (Status s = write_file(folder / "Configuration.h", files->configuration); !s) return s;
        if (Status s = write_file(folder / "Configuration_adv.h", files->configuration_adv); !s) return s;
        return write_file(folder / record_name, files->record);
    });
    if (!status) return status;
    if (options.output.json) {
        print_json(nlohmann::json{{"folder", options.write},
                                  {"release", machine::name_of(printer.controller.firmware)},
                                  {"settings", settings->size()},
                                  {"changed", files->changed},
                                  {"pins_added", files->added}});
        return {};
    }
    if (options.output.quiet) return {};
    fmt::print(
        "{}: Configuration.h and Configuration_adv.h of Marlin {} for {}: {} of {} settings changed, {} pins added\n",
        options.write, machine::name_of(printer.controller.firmware), printer.name, files->changed, settings->size(),
        files->added);
    if (!files->author.empty())
        fmt::print("note: {} is by {}; settings that are not in the list are kept\n", configuration->path,
                   files->author);
    return {};
}

Status print_settings(const machine::Printer& printer, const std::vector<machine::FirmwareSetting>& settings) {
    nlohmann::json list = nlohmann::json::array();
    for (const machine::FirmwareSetting& s : settings)
        list.push_back({{"name", s.name}, {"value", s.value}, {"reason", s.reason}});
    print_json(nlohmann::json{
        {"printer", printer.name}, {"release", machine::name_of(printer.controller.firmware)}, {"settings", list}});
    return {};
}

Status run_firmware(const FirmwareOptions& options) {
    Result<machine::Printer> printer = read_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    if (!options.release.empty()) {
        const auto release = machine::marlin_release(options.release);
        if (!release)
            return input_error("--release {}: must be one of {}", options.release,
                               fmt::join(machine::marlin_release_names, ", "));
        printer->controller.firmware = *release;
    }
    if (options.write.empty() != options.marlin.empty())
        return input_error("--write and --marlin go together: the source of Marlin in, configured files out");
    if (!options.write.empty()) return write_marlin(options, *printer);
    const Result<std::string> ini = machine::firmware_ini(*printer);
    if (!ini) return input_error("{}: {}", options.printer, ini.error().message);
    if (!options.save.empty()) {
        if (Status written = write_file(options.save, *ini); !written || !options.output.json) return written;
    }
    if (options.output.json) {
        const auto settings = machine::firmware_settings(*printer);
        if (!settings) return input_error("{}: {}", options.printer, settings.error().message);
        return print_settings(*printer, *settings);
    }
    fmt::print("{}", *ini);
    return {};
}

}  // namespace

void add_firmware(CLI::App& app, int& status) {
    auto options = std::make_shared<FirmwareOptions>();
    CLI::App* command = app.add_subcommand("firmware", "list the build settings of Marlin that a machine needs");
    command->add_option("printer", options->printer, "printer file (TOML)")->required();
    command->add_option("--release", options->release,
                        "release of Marlin: 2.1.1, 2.1.2 or 2.1.3 (default: controller.firmware of the printer file)");
    command->add_option("-o,--output", options->save, "file for the list (config.ini of Marlin)");
    command->add_option("--marlin", options->marlin, "folder with the source of that release, as downloaded");
    command->add_option("--write", options->write, "folder for complete configuration files, ready to be compiled");
    add_output_options(*command, options->output, true);
    command->footer(
        "Examples: pliant firmware examples/printers/tower8.toml -o config.ini\n"
        "          pliant firmware examples/printers/tower8.toml --marlin Marlin-2.1.2.4 --write configured");
    on_call(*command, status, [options] { return run_firmware(*options); });
}

}  // namespace pliant::app
