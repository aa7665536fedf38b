// pliant print: prints a job. The virtual printer obeys the same G-code and sees the same images as the real one.
#include "host/print.hpp"

#include <fmt/core.h>

#include <map>
#include <utility>

#include "command.hpp"
#include "core/files.hpp"
#include "job_tools.hpp"
#include "plan/plan.hpp"
#include "twin/inspect.hpp"
#include "twin_bench.hpp"

namespace pliant::app {
namespace {

struct Options {
    std::string job;
    std::string report_file;
    bool twin = false;
    Output output;
};

Result<int> print_on_twin(const Options& options) {
    const auto progress = terminal_progress(options.output);
    const Result<OpenJob> job = open_job(options.job);
    if (!job) return tl::unexpected(job.error());
    const job::Manifest& manifest = job->archive.manifest();
    const Result<std::string> gcode = job->archive.file("job.gcode");
    if (!gcode) return tl::unexpected(gcode.error());
    const Result<plan::Plan> plan = plan::make_plan(manifest, job->printer);
    if (!plan) return tl::unexpected(plan.error());

    Result<std::optional<job::Image>> mask = mask_of(*job);
    if (!mask) return tl::unexpected(mask.error());
    twin::Options twin_options;
    twin_options.mask = std::move(*mask);
    TwinBench bench(plan::filled_printer(*plan, manifest, job->printer), std::move(twin_options));
    // What has been shown is remembered: decoding is most of the work.
    std::map<std::pair<int, int>, twin::Runs> shown;
    const auto images = [&](int layer, int material) {
        Result<job::Image> image = image_of(job->archive, layer, material);
        if (image) shown[{layer, material}] = twin::runs_of(*image);
        return image;
    };
    const twin::RunSource runs = [&](int layer, int material) -> Result<twin::Runs> {
        if (const auto known = shown.find({layer, material}); known != shown.end()) return known->second;
        return image_of(job->archive, layer, material).map(twin::runs_of);
    };
    host::PrintRecord record;
    const host::LinkOptions link = link_options(job->printer.controller);
    if (Status printed = host::print_job(*gcode, images, bench.devices(), *progress, record, link); !printed)
        return tl::unexpected(printed.error());
    const Result<twin::Report> report = twin::inspect(bench.twin(), manifest, runs);
    if (!report) return tl::unexpected(report.error());

    const std::string json = twin::report_json(*report);
    if (!options.report_file.empty()) {
        if (Status written = write_file(options.report_file, json + "\n"); !written)
            return tl::unexpected(written.error());
    }
    if (options.output.json)
        fmt::print("{}\n", json);
    else if (!options.output.quiet)
        fmt::print("{} lines sent, {} exposures\n{}", record.lines_sent, record.exposures.size(),
                   twin::report_text(*report));
    return report->passed ? exit_done : exit_failed;
}

}  // namespace

void add_print(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("print", "print a job on the virtual printer and compare what cured with the model");
    command->add_option("job", options->job, "job file (.zip)")->required();
    command->add_flag("--twin", options->twin, "print on the virtual printer")->required();
    command->add_option("-o,--output", options->report_file, "file for the report (.json)");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant print gripper.zip --twin");
    command->callback([options, &status] {
        const Result<int> result = print_on_twin(*options);
        status = result ? *result : report(result.error());
    });
}

}  // namespace pliant::app
