#include "print_virtual.hpp"

#include <fmt/core.h>

#include <map>
#include <utility>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "inputs.hpp"
#include "presentation/print_report/print_report.hpp"
#include "print_vats.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/rehearse/virtual_print.hpp"
#include "printing/twin/inspect.hpp"

namespace pliant::app {
namespace {

using rehearse::VirtualPrint;

/// The images of a job. What has been shown is remembered: decoding is most of the work.
class Images {
public:
    explicit Images(std::shared_ptr<job::Archive> archive) : archive_(std::move(archive)) {}
    [[nodiscard]] Result<job::Image> show(int layer, int material) {
        Result<job::Image> image = operate::image_of(*archive_, layer, material);
        if (image) shown_[{layer, material}] = twin::runs_of(*image);
        return image;
    }
    [[nodiscard]] Result<twin::Runs> runs(int layer, int material) const {
        if (const auto known = shown_.find({layer, material}); known != shown_.end()) return known->second;
        return operate::image_of(*archive_, layer, material).map(twin::runs_of);
    }

private:
    std::shared_ptr<job::Archive> archive_;
    std::map<std::pair<int, int>, twin::Runs> shown_;
};

/// The virtual printer with everything in place: its projector's mask, and what the plan asks for before the print.
Result<std::unique_ptr<VirtualPrint>> set_up(const LiveOptions& wanted, const operate::ReadyJob& ready,
                                             Images& images) {
    Result<std::optional<job::Image>> mask = operate::mask_of(*ready.archive, ready.printer.projector);
    if (!mask) return tl::unexpected(mask.error());
    rehearse::Options options;
    options.printer.mask = std::move(*mask);
    options.printer.faults = wanted.faults;
    options.after_layer = layer_hook(wanted);
    host::PrintJob job = ready.job;
    job.images = [&images](int layer, int material) { return images.show(layer, material); };
    auto print = VirtualPrint::make(ready.printer, std::move(job), std::move(options));
    if (!print) return print;
    for (const plan::CareBefore& care : ready.plan.solution.care) {
        if (care.layer == 0) (*print)->twin().care(care.care);
    }
    return print;
}

Status write_page(const std::string& file, const operate::ReadyJob& ready, VirtualPrint& print,
                  const twin::RunSource& runs, const twin::Judgement& judgement) {
    Result<report::CuredBlock> block = report::cured_block(print.twin(), ready.archive->manifest(), runs, judgement);
    if (!block) return tl::unexpected(block.error());
    const host::Snapshot last = print.snapshot();
    const report::PrintExtras extras{"virtual printer", last.firmware, last.lines_sent, last.resends,
                                     std::make_shared<const report::CuredBlock>(std::move(*block))};
    const auto records = print.records();
    if (!records) return tl::unexpected(records.error());
    const Result<std::string> page = report::print_report(*ready.archive, ready.printer, *records, extras);
    return page ? write_file(file, *page) : tl::unexpected(page.error());
}

/// Journal and page, where they are asked for.
Status write_records(const LiveOptions& options, const operate::ReadyJob& ready, VirtualPrint& print,
                     const twin::RunSource& runs, const twin::Judgement& judgement) {
    if (!options.journal.empty()) {
        const Result<std::string> journal = print.journal();
        if (!journal) return tl::unexpected(journal.error());
        if (Status written = write_file(options.journal, *journal); !written) return written;
    }
    return options.report.empty() ? Status{} : write_page(options.report, ready, print, runs, judgement);
}

}  // namespace

Result<int> print_virtual(const LiveOptions& options, const std::string& report_file) {
    auto progress = terminal_progress(options.output);
    if (Status is_job = expect(FileKind::job, options.job); !is_job) return tl::unexpected(is_job.error());
    const Result<operate::ReadyJob> ready = operate::load_job(options.job);
    if (!ready) return tl::unexpected(ready.error());
    show_vats(ready->plan, ready->warnings, options.output);
    Images images(ready->archive);
    const auto print = set_up(options, *ready, images);
    if (!print) return tl::unexpected(print.error());
    const Status printed = (*print)->print(*progress);
    if (!printed && printed.error().cause == Cause::cancelled) return tl::unexpected(printed.error());

    const twin::RunSource runs = [&](int layer, int material) { return images.runs(layer, material); };
    const twin::Judgement judgement{options.accepted};
    if (Status written = write_records(options, *ready, **print, runs, judgement); !written)
        return tl::unexpected(written.error());
    if (!printed) return tl::unexpected(printed.error());
    const Result<twin::Report> report = twin::inspect((*print)->twin(), ready->archive->manifest(), runs, judgement);
    if (!report) return tl::unexpected(report.error());
    const std::string json = twin::report_json(*report);
    if (!report_file.empty()) {
        if (Status written = write_file(report_file, json + "\n"); !written) return tl::unexpected(written.error());
    }
    progress.reset();
    if (options.output.json)
        fmt::print("{}\n", json);
    else if (!options.output.quiet)
        fmt::print("{} sent, {}\n{}", counted(static_cast<std::size_t>((*print)->snapshot().lines_sent), "line"),
                   counted((*print)->lights().size(), "exposure"), twin::report_text(*report));
    return report->passed ? exit_done : exit_failed;
}

}  // namespace pliant::app
