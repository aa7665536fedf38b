#include "printing/prepare/slice_job.hpp"

#include <algorithm>
#include <utility>

#include "base/core/counted.hpp"
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

Status check_printed(const job::Manifest& manifest) {
    const auto has_image = [](const job::Layer& layer) { return !layer.images.empty(); };
    if (std::any_of(manifest.layers.begin(), manifest.layers.end(), has_image)) return {};
    return input_error("nothing is printed: not one pixel of {} is lit; is the part thinner than a layer or a pixel?",
                       counted(manifest.layers.size(), "layer"));
}

/// Exposures of layers that the job does not have would change nothing.
Status check_spans(const job::JobSettings& settings, job::Manifest& manifest) {
    const int count = static_cast<int>(manifest.layers.size());
    for (const auto& [material, rule] : settings.exposures) {
        for (const job::ExposureSpan& span : rule.spans) {
            const std::string option =
                fmt::format("--exposure {}:{}-{}={:g} s", material, span.first, span.last, span.seconds);
            if (span.first >= count)
                return input_error("{}: the job has no such layers, its layers are 0 to {}, counted from 0", option,
                                   count - 1);
            if (span.last >= count)
                manifest.warnings.push_back(fmt::format("{}: the last layer is {}, counted from 0", option, count - 1));
        }
    }
    return {};
}

}  // namespace

Status check_job_name(const std::filesystem::path& job, const std::vector<std::string>& inputs,
                      const std::filesystem::path& printer) {
    if (job.extension() != ".zip")
        return input_error("{}: a job ends in .zip, as in {}", job.string(),
                           std::filesystem::path(job).replace_extension(".zip").string());
    std::error_code none;  // of files that do not exist
    for (const std::string& input : inputs) {
        for (const std::string& file : {input, input.substr(input.find('=') + 1)}) {
            if (std::filesystem::equivalent(job, file, none))
                return input_error("{}: is an input, which the job would replace; give it another name", job.string());
        }
    }
    if (std::filesystem::equivalent(job, printer, none))
        return input_error("{}: is the printer file, which the job would replace; give it another name", job.string());
    return {};
}

Result<SlicedJob> slice_job(const Order& order, const PrinterFile& printer, Drawing drawing,
                            const std::filesystem::path& file, Progress& progress, job::LayerWatch watch) {
    Result<job::JobSettings> settings = job_settings(order, printer.printer, printer.mask, drawing);
    if (!settings) return tl::unexpected(settings.error());
    settings->watch = std::move(watch);
    std::vector<std::string> notes = drawing.notes;
    if (Status s = arrange(order, *settings, drawing, notes, progress); !s) return tl::unexpected(s.error());
    Result<job::Writer> writer = job::Writer::create(file);
    if (!writer) return tl::unexpected(writer.error());
    Result<job::MadeJob> made = drawing.stacks.empty()
                                    ? job::slice_to_job(drawing.bodies, *settings, *writer, progress)
                                    : job::stacks_to_job(drawing.stacks, *settings, *writer, progress);
    if (!made) return tl::unexpected(made.error());
    job::Manifest& manifest = made->manifest;
    if (Status printed = check_printed(manifest); !printed) return tl::unexpected(printed.error());
    if (Status spans = check_spans(*settings, manifest); !spans) return tl::unexpected(spans.error());
    manifest.warnings.insert(manifest.warnings.begin(), drawing.warnings.begin(), drawing.warnings.end());
    Result<plan::Plan> plan = plan::make_plan(manifest, printer.printer);
    if (!plan) return tl::unexpected(plan.error());
    Status status = add_files(order, printer, *settings, manifest, *plan, *writer);
    if (status) status = writer->finish(manifest);
    if (!status) return tl::unexpected(status.error());
    return SlicedJob{std::move(manifest), std::move(*plan), std::move(notes)};
}

}  // namespace pliant::prepare
