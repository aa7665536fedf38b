// pliant print: prints a job, on a machine at a serial port or on the virtual printer, which obeys the same G-code and
// sees the same images.
#include "printing/host/print.hpp"

#include <fmt/core.h>

#include <map>
#include <utility>

#include "base/core/files.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "presentation/print_report/print_report.hpp"
#include "print_live.hpp"
#include "print_vats.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/programs.hpp"
#include "printing/operate/proved_job.hpp"
#include "printing/plan/plan.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/wire/serial.hpp"
#include "twin_bench.hpp"

namespace pliant::app {
namespace {

struct Options {
    LiveOptions live;
    std::string report_file;
    std::vector<std::string> accepted;
    bool twin = false;
    bool list_ports = false;
    bool given_speed = false;
};

/// What a journal of this print would hold.
std::vector<host::JournalRecord> journal_of(const host::PrintRecord& record, const job::Manifest& manifest,
                                            const std::string& printer) {
    std::vector<host::JournalRecord> records;
    const auto add = [&](const char* kind, host::JournalValues values) {
        records.push_back({static_cast<long>(records.size()) + 1, kind, std::move(values)});
    };
    const auto number = [](double value) { return fmt::format("{:.6f}", value); };
    add("begin", {{"job", manifest.name}, {"printer", printer}});
    for (const host::Exposure& e : record.exposures) {
        const job::Layer& layer = manifest.layers.at(static_cast<std::size_t>(e.layer));
        double planned_s = 0;
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            if (layer.images[k].material == e.material)
                planned_s = job::exposure_s(manifest, static_cast<std::size_t>(e.layer), k);
        }
        add("light", {{"layer", fmt::format("{}", e.layer)},
                      {"material", fmt::format("{}", e.material)},
                      {"planned", number(planned_s)},
                      {"at", number(e.start_s)}});
        add("dark",
            {{"light", fmt::format("{}", records.size())}, {"on", number(e.on_s)}, {"done", "1"}, {"by", "host"}});
    }
    add("end", {});
    return records;
}

/// The page about a print whose journal is there, whoever printed it.
Result<int> report_on_journal(const LiveOptions& live) {
    const std::string journal = live.journal.empty() ? live.job + ".journal" : live.journal;
    const Result<std::string> page = report::print_report(live.job, journal, {});
    if (!page) return tl::unexpected(page.error());
    if (Status written = write_file(live.report, *page); !written) return tl::unexpected(written.error());
    return exit_done;
}

/// Does what the plan asks of a person, when the light of `layer` comes: refills its vats, and looks after the solution
/// for the layer above, whose first cleaning comes before its first light.
void do_as_asked(twin::Twin& twin, const plan::Plan& plan, int layer, std::size_t& refilled, std::size_t& cared) {
    for (; refilled < plan.refills.size() && plan.refills[refilled].layer <= layer; ++refilled)
        twin.fill_vat(plan.refills[refilled].slot);
    const auto& care = plan.solution.care;
    for (; cared < care.size() && care[cared].layer <= layer + 1; ++cared) twin.care(care[cared].care);
}

Result<int> print_on_twin(const Options& options) {
    auto progress = terminal_progress(options.live.output);
    const Result<operate::ProvedJob> job = prove_job(options.live.job);
    if (!job) return tl::unexpected(job.error());
    const job::Manifest& manifest = job->archive.manifest();
    show_vats(job->plan, job->warnings, options.live.output);
    Result<std::optional<job::Image>> mask = operate::mask_of(job->archive, job->printer.projector);
    if (!mask) return tl::unexpected(mask.error());
    twin::Options twin_options;
    twin_options.mask = std::move(*mask);
    TwinBench bench(plan::filled_printer(job->plan, manifest, job->printer), std::move(twin_options));
    // What has been shown is remembered: decoding is most of the work.
    std::map<std::pair<int, int>, twin::Runs> shown;
    std::size_t refilled = 0, cared = 0;
    const auto images = [&](int layer, int material) {
        do_as_asked(bench.twin(), job->plan, layer, refilled, cared);
        Result<job::Image> image = operate::image_of(job->archive, layer, material);
        if (image) shown[{layer, material}] = twin::runs_of(*image);
        return image;
    };
    const twin::RunSource runs = [&](int layer, int material) -> Result<twin::Runs> {
        if (const auto known = shown.find({layer, material}); known != shown.end()) return known->second;
        return operate::image_of(job->archive, layer, material).map(twin::runs_of);
    };
    host::PrintRecord record;
    const host::LinkOptions link = operate::link_options(job->printer.controller);
    if (Status printed = host::print_job(job->gcode, images, bench.devices(), *progress, record, link); !printed)
        return tl::unexpected(printed.error());
    const twin::Judgement judgement{options.live.accepted};
    const Result<twin::Report> report = twin::inspect(bench.twin(), manifest, runs, judgement);
    if (!report) return tl::unexpected(report.error());

    const std::string json = twin::report_json(*report);
    if (!options.report_file.empty()) {
        if (Status written = write_file(options.report_file, json + "\n"); !written)
            return tl::unexpected(written.error());
    }
    if (!options.live.report.empty()) {
        Result<report::CuredBlock> block = report::cured_block(bench.twin(), manifest, runs, judgement);
        if (!block) return tl::unexpected(block.error());
        const report::PrintExtras extras{"virtual printer", "", record.lines_sent, record.resends,
                                         std::make_shared<const report::CuredBlock>(std::move(*block))};
        const Result<std::string> page =
            report::print_report(job->archive, job->printer, journal_of(record, manifest, job->printer.name), extras);
        if (!page) return tl::unexpected(page.error());
        if (Status written = write_file(options.live.report, *page); !written) return tl::unexpected(written.error());
    }
    progress.reset();
    if (options.live.output.json)
        fmt::print("{}\n", json);
    else if (!options.live.output.quiet)
        fmt::print("{} lines sent, {} exposures\n{}", record.lines_sent, record.exposures.size(),
                   twin::report_text(*report));
    return report->passed ? exit_done : exit_failed;
}

int list_ports() {
    for (const host::SerialPort& port : host::serial_ports()) fmt::print("{}  {}\n", port.device, port.name);
    return exit_done;
}

Result<int> print(Options& options) {
    if (options.list_ports) return list_ports();
    if (options.live.job.empty()) return input_error("name the job to print, such as gripper.zip");
    if (!options.twin && options.live.port.empty() && !options.live.report.empty())
        return report_on_journal(options.live);
    if (options.twin == !options.live.port.empty())
        return input_error("say where to print: --port DEVICE (see --list-ports) or --twin");
    if (options.twin && !options.live.clock_file.empty()) return input_error("--clock goes with --port");
    if (options.twin && !options.live.emergency_line.empty()) return input_error("--emergency-line goes with --port");
    if (!options.twin && !options.accepted.empty()) return input_error("--accept goes with --twin");
    auto accepted = twin::accepted_findings(options.accepted);
    if (!accepted) return input_error("--accept: {}", accepted.error().message);
    options.live.accepted = std::move(*accepted);
    if (options.twin && options.live.resume)
        return input_error("--resume needs a printer that is still there: --port DEVICE");
    if (!options.twin && options.live.projector.empty())
        return input_error("say where the light comes from: --projector FOLDER");
    if (options.twin && !options.given_speed) return print_on_twin(options);
    return print_live(options.live);
}

}  // namespace

void add_print(CLI::App& app, int& status) {
    auto options = std::make_shared<Options>();
    LiveOptions& live = options->live;
    CLI::App* command = app.add_subcommand("print", "print a job on a machine, or on the virtual printer");
    command->add_option("job", live.job, "job file (.zip)");
    command->add_option("--port", live.port, "serial port of the machine");
    command->add_flag("--twin", options->twin, "print on the virtual printer and compare what cured with the model");
    command
        ->add_option("--accept", options->accepted,
                     "a finding of --twin that does not fail the print: overcure, volume, contamination, cleaning")
        ->type_name("FINDING")
        ->allow_extra_args(false);
    command->add_flag("--list-ports", options->list_ports, "list the serial ports");
    command->add_option("--projector", live.projector, "folder whose shown.png is the light");
    command->add_flag("--resume", live.resume, "go on with an interrupted print");
    command->add_option("--journal", live.journal, "file instead of JOB.zip.journal");
    command->add_option("--assume-lit", live.assume_lit_s, "seconds that a light was on whose end nobody saw");
    command->add_flag("--assume-vats-untouched", live.assume_vats_untouched,
                      "another program has used the controller since, but moved no vat");
    command->add_option("--emergency-line", live.emergency_line,
                        "what an emergency stop pulls, instead of the printer file's: dtr:PORT, rts:PORT, file:FILE (1 "
                        "stops), file-low:FILE (0 stops), none");
    command->add_flag("--yes", live.yes, "the vats are in place and filled: do not ask");
    command->add_option("--after-layer", live.after_layer, "command after every layer, its number in PLIANT_LAYER");
    command->add_option(
        "--report", live.report,
        "file for a page about the print (.html); without --port and --twin: of what the journal tells");
    CLI::Option* speed = command->add_option(
        "--speed", live.speed, "seconds of the machine in one of the wall, for virtual printers; 1 is real time");
    command->add_option("--clock", live.clock_file, "clock of the virtual printer (twin --clock FILE)");
    command->add_option("-o,--output", options->report_file, "file for the report of --twin (.json)");
    add_output_options(*command, live.output, true);
    command->footer(
        "Keys: space pauses and resumes, c cancels, e is the emergency stop; Ctrl-C parks, --resume goes on.\n"
        "Example: pliant print gripper.zip --port /dev/ttyACM0 --projector pictures\n"
        "         pliant print gripper.zip --twin");
    on_call(*command, status, [options, speed] {
        options->given_speed = speed->count() > 0;
        return print(*options);
    });
}

}  // namespace pliant::app
