#include "print_virtual.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "inputs.hpp"
#include "presentation/print_report/print_report.hpp"
#include "print_vats.hpp"
#include "printing/host/replace_journal.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/rehearse/rehearsal.hpp"

namespace pliant::app {
namespace {

Status write_page(const std::string& file, rehearse::Rehearsal& rehearsal, const twin::Judgement& judgement) {
    const operate::ReadyJob& ready = rehearsal.job();
    rehearse::VirtualPrint& print = rehearsal.print();
    Result<report::CuredBlock> block =
        report::cured_block(print.twin(), ready.archive->manifest(), rehearsal.runs(), judgement);
    if (!block) return tl::unexpected(block.error());
    const host::Snapshot last = print.snapshot();
    const report::PrintExtras extras{"virtual printer", last.firmware, last.lines_sent, last.resends,
                                     std::make_shared<const report::CuredBlock>(std::move(*block))};
    const auto records = print.records();
    if (!records) return tl::unexpected(records.error());
    const Result<std::string> page = report::print_report(*ready.archive, ready.printer, *records, extras);
    return page ? write_file(file, *page) : tl::unexpected(page.error());
}

/// Writes journal and report, if requested.
Status write_records(const LiveOptions& options, rehearse::Rehearsal& rehearsal, const twin::Judgement& judgement) {
    if (!options.journal.empty()) {
        const Result<std::string> journal = rehearsal.print().journal();
        if (!journal) return tl::unexpected(journal.error());
        if (Status written = host::replace_journal(options.journal, *journal); !written) return written;
    }
    return options.report.empty() ? Status{} : write_page(options.report, rehearsal, judgement);
}

/// A failed print may have a reason for every layer.
std::string first_of(const std::vector<std::string>& reasons) {
    constexpr std::size_t most = 6;
    const std::size_t shown = std::min(most, reasons.size());
    std::string text =
        fmt::format("{}", fmt::join(reasons.begin(), reasons.begin() + static_cast<std::ptrdiff_t>(shown), "; "));
    if (shown < reasons.size()) text += fmt::format("; and {} more, in the report (-o)", reasons.size() - shown);
    return text;
}

/// With -q the first reasons alone, as an error.
void show_result(const LiveOptions& options, const rehearse::VirtualPrint& print, const twin::Report& report,
                 const std::string& json) {
    if (options.output.json)
        fmt::print("{}\n", json);
    else if (!options.output.quiet)
        fmt::print("{} sent, {}\n{}", counted(static_cast<std::size_t>(print.snapshot().lines_sent), "line"),
                   counted(print.lights().size(), "exposure"), twin::report_text(report));
    else if (!report.passed)
        fmt::print(stderr, "{}: the virtual print failed: {}\n", options.job, first_of(report.reasons));
}

}  // namespace

Result<int> print_virtual(const LiveOptions& options) {
    auto progress = terminal_progress(options.output);
    if (Status is_job = expect(FileKind::job, options.job); !is_job) return tl::unexpected(is_job.error());
    if (!options.journal.empty()) {
        if (Status may = host::may_replace_journal(options.journal); !may) return tl::unexpected(may.error());
    }
    Result<operate::ReadyJob> ready = operate::load_job(options.job);
    if (!ready) return tl::unexpected(ready.error());
    show_vats(ready->plan, ready->warnings, options.output);
    rehearse::Options set_up;
    set_up.printer.faults = options.faults;
    set_up.after_layer = layer_hook(options);
    auto rehearsal = rehearse::Rehearsal::make(std::move(*ready), std::move(set_up));
    if (!rehearsal) return tl::unexpected(rehearsal.error());
    rehearse::VirtualPrint& print = rehearsal->print();
    const Status printed = print.print(*progress);
    if (!printed && printed.error().cause == Cause::cancelled) return tl::unexpected(printed.error());

    const twin::Judgement judgement{.accepted = options.accepted, .faults_must_occur = true};
    if (Status written = write_records(options, *rehearsal, judgement); !written)
        return tl::unexpected(written.error());
    if (!printed) return tl::unexpected(printed.error());
    const Result<twin::Report> report = rehearsal->inspect(judgement);
    if (!report) return tl::unexpected(report.error());
    const std::string json = twin::report_json(*report);
    if (!options.verdict.empty()) {
        if (Status written = write_file(options.verdict, json + "\n"); !written) return tl::unexpected(written.error());
    }
    progress.reset();
    show_result(options, print, *report, json);
    return report->passed ? exit_done : exit_failed;
}

}  // namespace pliant::app
