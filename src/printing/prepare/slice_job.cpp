#include "printing/prepare/slice_job.hpp"

#include <utility>

#include "printing/plan/proof.hpp"
#include "printing/prepare/paint_file.hpp"

namespace pliant::prepare {
namespace {

/// Adds all files of the job other than its images.
Status add_files(const Order& order, const PrinterFile& printer, const job::JobSettings& settings,
                 const job::Manifest& manifest, const plan::Plan& plan, job::Writer& writer) {
    const std::string gcode = plan::write_gcode(plan, manifest, printer.printer);
    Status status = plan::prove_program(gcode, plan, manifest, printer.printer);
    if (status) status = writer.add_file("printer.toml", printer.text);
    if (status && settings.light.mask) status = writer.add_image(job::mask_entry, *settings.light.mask);
    if (status) status = writer.add_file("settings.json", job::settings_json(settings, request_of(order, settings)));
    if (status && !order.support_paint.empty()) status = writer.add_file(paint_entry, order.support_paint);
    if (status) status = writer.add_file("plan.json", plan::plan_json(plan));
    if (status) status = writer.add_file("job.gcode", gcode);
    return status;
}

}  // namespace

Result<SlicedJob> slice_job(const Order& order, const PrinterFile& printer, Drawing drawing,
                            const std::filesystem::path& file, Progress& progress, job::LayerWatch watch) {
    Result<job::JobSettings> settings = job_settings(order, printer.printer, printer.mask, drawing);
    if (!settings) return tl::unexpected(settings.error());
    settings->watch = std::move(watch);
    std::vector<std::string> notes;
    if (Status s = arrange(order, *settings, drawing, notes, progress); !s) return tl::unexpected(s.error());
    Result<job::Writer> writer = job::Writer::create(file);
    if (!writer) return tl::unexpected(writer.error());
    Result<job::MadeJob> made = drawing.stacks.empty()
                                    ? job::slice_to_job(drawing.bodies, *settings, *writer, progress)
                                    : job::stacks_to_job(drawing.stacks, *settings, *writer, progress);
    if (!made) return tl::unexpected(made.error());
    job::Manifest& manifest = made->manifest;
    manifest.warnings.insert(manifest.warnings.begin(), drawing.warnings.begin(), drawing.warnings.end());
    Result<plan::Plan> plan = plan::make_plan(manifest, printer.printer);
    if (!plan) return tl::unexpected(plan.error());
    Status status = add_files(order, printer, *settings, manifest, *plan, *writer);
    if (status) status = writer->finish(manifest);
    if (!status) return tl::unexpected(status.error());
    return SlicedJob{std::move(manifest), std::move(*plan), std::move(notes)};
}

}  // namespace pliant::prepare
