// pliant plan: what a job needs on its printer: vats, swaps, times, resin.
#include "printing/plan/plan.hpp"

#include <fmt/core.h>

#include "base/core/text.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "overcure.hpp"
#include "presentation/print_report/plan_picture.hpp"
#include "printing/machine/image_room.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/plan/timeline.hpp"
#include "spray_plan.hpp"

namespace pliant::app {
namespace {

struct PlanOptions {
    std::string job;
    std::string printer;
    std::string picture_file;
    bool any_vat = false;
    SprayOrder spray;
    Output output;
};

Status make_plan(const PlanOptions& options) {
    if (Status named = check_ending("-o", options.picture_file, "a picture", ".png"); !named) return named;
    if (Status named = check_ending("--spray-picture", options.spray.picture_file, "a picture", ".png"); !named)
        return named;
    on_signal(OnSignal::leave);
    Result<operate::OpenJob> job = read_job(options.job);
    if (!job) return tl::unexpected(job.error());
    std::vector<std::string> otherwise;
    if (!options.printer.empty()) {
        Result<machine::Printer> other = read_printer(options.printer);
        if (!other) return tl::unexpected(other.error());
        otherwise = machine::other_images(job->printer.projector, other->projector);
        job->printer = std::move(*other);
    }
    const Result<std::optional<SprayResult>> spray = look_at_spray(options.spray, job->archive, job->printer);
    if (!spray) return tl::unexpected(spray.error());
    job::Manifest manifest = job->archive.manifest();
    manifest.any_vat = manifest.any_vat || options.any_vat;
    Result<plan::Plan> plan = plan::make_plan(manifest, job->printer);
    if (!plan) return tl::unexpected(plan.error());
    if (!otherwise.empty())
        plan->warnings.push_back(fmt::format(
            "the job was sliced for another {} of the projector: before it is printed on {}, slice it again for that",
            join_names(otherwise), job->printer.name));
    if (options.printer.empty()) {  // the images are for the job's own projector
        auto progress = terminal_progress(options.output);
        on_signal(OnSignal::leave);  // as before: nothing is written yet
        const Result<std::vector<std::string>> overcure =
            overcure_warnings(job->archive, *plan, job->printer, *progress);
        progress.reset();
        on_signal(OnSignal::leave);
        if (!overcure) return tl::unexpected(overcure.error());
        plan->warnings.insert(plan->warnings.end(), overcure->begin(), overcure->end());
    }
    if (!options.picture_file.empty()) {
        const Result<std::string> png = report::plan_picture(*plan, plan::longest_swap(*plan, job->printer));
        if (!png) return tl::unexpected(png.error());
        if (Status status = write_file_and_leave(options.picture_file, *png); !status) return status;
    }
    if (options.output.json)
        fmt::print("{}\n", with_spray(plan::plan_json(*plan), *spray));
    else if (!options.output.quiet)
        fmt::print("{}{}", plan::plan_text(*plan), spray_text(*spray));
    return {};
}

}  // namespace

void add_plan(CLI::App& app, int& status) {
    auto options = std::make_shared<PlanOptions>();
    CLI::App* command = app.add_subcommand("plan", "plan a job: vats, swaps, times, resin");
    command->add_option("job", options->job, "job file (.zip)")->required();
    command->add_option("--printer", options->printer, "printer file in place of the job's own, to compare");
    command->add_flag("--any-vat", options->any_vat, "assume that resins that no vat holds are filled into free vats");
    command->add_option("-o,--output", options->picture_file, "file for a picture of the plan (.png)");
    command->add_flag("--spray", options->spray.wanted,
                      "report how clean the machine's spray heads get the finished part");
    command->add_option("--optimise-spray", options->spray.cleanness,
                        "plan with the oscillation and time that remove this "
                        "share of the film (0.95) with the least solution");
    command->add_option("--spray-picture", options->spray.picture_file,
                        "file for a picture of what the spray leaves on the part (.png)");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant plan gripper.zip -o plan.png");
    on_call(*command, status, [options] { return make_plan(*options); });
}

}  // namespace pliant::app
