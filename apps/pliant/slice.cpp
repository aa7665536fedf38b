// pliant slice: layer images, plan and G-code of a robot for one printer, in one job file.
#include <fmt/core.h>

#include <string>
#include <vector>

#include "core/files.hpp"
#include "job/png.hpp"
#include "job_tools.hpp"
#include "plan/check.hpp"
#include "plan/plan.hpp"
#include "report/job_picture.hpp"
#include "slice_settings.hpp"

namespace pliant::app {
namespace {

/// "50 um", or "25 to 100 um" where layers are not alike.
std::string heights_text(const job::Manifest& manifest) {
    int least = 0, most = 0;
    for (const job::Layer& layer : manifest.layers) {
        least = least == 0 ? layer.thickness_um : std::min(least, layer.thickness_um);
        most = std::max(most, layer.thickness_um);
    }
    return least == most ? fmt::format("{} um", least) : fmt::format("{} to {} um", least, most);
}

void print_summary(const SliceOptions& options, const job::Manifest& manifest, const plan::Plan& plan,
                   const std::vector<std::string>& notes) {
    if (options.output.quiet) return;
    fmt::print("{}: {} layers of {}, {} x {} px of {:.6g} um\n", options.job, manifest.layers.size(),
               heights_text(manifest), manifest.width_px, manifest.height_px, manifest.pixel_um);
    for (const job::Material& material : manifest.materials) {
        fmt::print("material {}: resin {}, {:.1f} mm^3\n", material.name, material.resin, material.model_volume_mm3);
    }
    for (const std::string& note : notes) fmt::print("{}\n", note);
    for (const std::string& warning : plan.warnings) fmt::print("warning: {}\n", warning);
    for (const std::string& warning : manifest.warnings) fmt::print("warning: {}\n", warning);
    fmt::print("{} swaps, {} in all\n", plan.swaps, plan::clock_text(plan.seconds.total));
}

Status draw_picture(const SliceOptions& options) {
    const Result<job::Archive> archive = job::Archive::open(options.job);
    if (!archive) return tl::unexpected(archive.error());
    const Result<std::string> png = report::job_picture(*archive);
    if (!png) return tl::unexpected(png.error());
    return write_file(options.picture, *png);
}

/// All files of the job beside its images.
Status add_files(const SliceOptions& options, const machine::Printer& printer, const std::string& printer_text,
                 const job::JobSettings& settings, const job::Manifest& manifest, const plan::Plan& plan,
                 job::Writer& writer) {
    const std::string gcode = plan::write_gcode(plan, manifest, printer);
    Status status = plan::check_gcode(gcode, printer);
    if (status) status = writer.add_file("printer.toml", printer_text);
    if (status && settings.light.mask) status = writer.add_image(mask_entry, *settings.light.mask);
    if (status) status = writer.add_file("settings.json", job::settings_json(settings, request_of(options, settings)));
    if (status) status = writer.add_file("plan.json", plan::plan_json(plan));
    if (status) status = writer.add_file("job.gcode", gcode);
    return status;
}

Status slice(const SliceOptions& options) {
    const auto progress = terminal_progress(options.output);
    const Result<machine::Printer> printer = machine::load_printer(options.printer);
    if (!printer) return tl::unexpected(printer.error());
    const Result<std::string> printer_text = read_file(options.printer);
    if (!printer_text) return tl::unexpected(printer_text.error());
    Result<Drawing> drawing = read_drawing(options.inputs, options.assignments, *progress);
    if (!drawing) return tl::unexpected(drawing.error());
    Result<job::JobSettings> settings = job_settings(options, *printer, *drawing);
    if (!settings) return tl::unexpected(settings.error());
    std::vector<std::string> notes;
    if (Status status = arrange(options, *settings, *drawing, notes, *progress); !status) return status;

    Result<job::Writer> writer = job::Writer::create(options.job);
    if (!writer) return tl::unexpected(writer.error());
    Result<job::MadeJob> made = drawing->stacks.empty()
                                    ? job::slice_to_job(drawing->bodies, *settings, *writer, *progress)
                                    : job::stacks_to_job(drawing->stacks, *settings, *writer, *progress);
    if (!made) return tl::unexpected(made.error());
    job::Manifest& manifest = made->manifest;
    manifest.warnings.insert(manifest.warnings.begin(), drawing->warnings.begin(), drawing->warnings.end());
    const Result<plan::Plan> plan = plan::make_plan(manifest, *printer);
    if (!plan) return tl::unexpected(plan.error());
    Status status = add_files(options, *printer, *printer_text, *settings, manifest, *plan, *writer);
    if (status) status = writer->finish(manifest);
    if (status && !options.picture.empty()) status = draw_picture(options);
    if (status) print_summary(options, manifest, *plan, notes);
    return status;
}

}  // namespace

void add_slice(CLI::App& app, int& status) {
    auto options = std::make_shared<SliceOptions>();
    CLI::App* command = app.add_subcommand("slice", "make the job of a robot for a printer: images, plan, G-code");
    add_slice_options(*command, *options);
    command->footer(
        "Example: pliant slice examples/cable_gripper/gripper.toml --printer examples/printers/tower.toml -o "
        "gripper.zip");
    command->callback([options, &status] {
        const Status result = slice(*options);
        status = result ? exit_done : report(result.error());
    });
}

}  // namespace pliant::app
