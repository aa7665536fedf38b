// pliant export: writes a job's images in formats of other programs.
#include "printing/job/export.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "command.hpp"
#include "inputs.hpp"

namespace pliant::app {
namespace {

struct ExportOptions {
    std::string job, format, folder;
    Output output;
};

Status export_robot(const ExportOptions& options) {
    const Result<job::Format> format = job::format_from(options.format);
    if (!format) return input_error("--as: {}", format.error().message);
    const Result<job::Archive> archive = read_archive(options.job);
    if (!archive) return tl::unexpected(archive.error());
    const auto written = job::export_job(*archive, *format, options.folder);
    if (!written) return tl::unexpected(written.error());
    if (options.output.json) {
        nlohmann::json files = nlohmann::json::array();
        for (const auto& path : *written) files.push_back(path.string());
        fmt::print("{}\n", nlohmann::json{{"files", files}}.dump(1));
    } else if (!options.output.quiet) {
        for (const auto& path : *written) fmt::print("{}\n", path.string());
    }
    return {};
}

}  // namespace

void add_export(CLI::App& app, int& status) {
    auto options = std::make_shared<ExportOptions>();
    CLI::App* command = app.add_subcommand("export", "export a job's images in formats of other programs");
    command->add_option("job", options->job, "job file (.zip)")->required();
    command->add_option("--as", options->format, "sl1, nanodlp, zip or vats")->required();
    command->add_option("-o,--output", options->folder, "folder for a file per material, or for the vats' folders")
        ->required();
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant export gripper.zip --as sl1 -o stacks");
    on_call(*command, status, [options] { return export_robot(*options); });
}

}  // namespace pliant::app
