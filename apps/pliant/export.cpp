// pliant export: writes a job's images in formats of other programs.
#include "printing/job/export.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "printed.hpp"

namespace pliant::app {
namespace {

struct ExportOptions {
    std::string job, format, folder;
    Output output;
};

/// What the images were corrected by, which no format can say; "": by nothing.
std::string correction_note(const machine::Projector& projector) {
    if (projector.grey.empty() && projector.mask.empty()) return "";
    return fmt::format(
        "the images hold what this projector must show: the printer file's {} applied, and pliant slice "
        "would apply {} again",
        projector.mask.empty()   ? "grey is"
        : projector.grey.empty() ? "mask is"
                                 : "grey and mask are",
        projector.mask.empty() || projector.grey.empty() ? "it" : "them");
}

void tell_files(const ExportOptions& options, const std::vector<std::filesystem::path>& written,
                const std::vector<std::string>& notes) {
    if (options.output.json) {
        nlohmann::json root{{"files", nlohmann::json::array()}};
        for (const auto& path : written) root["files"].push_back(path.string());
        if (!notes.empty()) root["notes"] = notes;
        print_json(root);
    } else if (!options.output.quiet) {
        for (const auto& path : written) fmt::print("{}\n", path.string());
        for (const std::string& note : notes) fmt::print("  note: {}\n", note);
    }
}

/// A folder with the name of a file would be looked for as one.
Status check_folder(const std::string& folder) {
    const std::string extension = lower_extension(folder);
    for (const char* of_file : {".sl1", ".zip", ".nanodlp"}) {
        if (extension == of_file)
            return input_error("-o {}: is for a folder, which gets a file or folder for each material; leave out {}",
                               folder, of_file);
    }
    return {};
}

Status export_images(const ExportOptions& options) {
    const Result<job::Format> format = job::format_from(options.format);
    if (!format) return input_error("--as: {}", format.error().message);
    if (Status folder = check_folder(options.folder); !folder) return folder;
    auto progress = terminal_progress(options.output);
    on_signal(OnSignal::ask_twice);  // a partial file must be removed
    const Result<operate::OpenJob> job = read_job(options.job);
    if (!job) return tl::unexpected(job.error());
    const auto written = job::export_job(job->archive, *format, options.folder, *progress);
    progress.reset();
    if (!written) return tl::unexpected(written.error());
    std::vector<std::string> notes = job::exposure_notes(job->archive.manifest(), *format);
    if (std::string note = job::height_note(job->archive.manifest(), *format); !note.empty())
        notes.push_back(std::move(note));
    if (std::string note = correction_note(job->printer.projector); !note.empty()) notes.push_back(std::move(note));
    tell_files(options, *written, notes);
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
    on_call(*command, status, [options] { return export_images(*options); });
}

}  // namespace pliant::app
