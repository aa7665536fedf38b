#include "printing/rehearse/virtual_print.hpp"

#include <utility>

#include "base/core/files.hpp"
#include "printing/operate/programs.hpp"

namespace pliant::rehearse {

Result<std::unique_ptr<VirtualPrint>> VirtualPrint::make(const machine::Printer& printer, host::PrintJob job,
                                                         Options options) {
    Result<MemoryFile> journal = MemoryFile::make();
    if (!journal) return tl::unexpected(journal.error());
    return std::unique_ptr<VirtualPrint>(
        new VirtualPrint(printer, std::move(job), std::move(options), std::move(*journal)));
}

VirtualPrint::VirtualPrint(const machine::Printer& printer, host::PrintJob job, Options options, MemoryFile journal)
    : twin_(printer, options.printer),
      journal_(std::move(journal)),
      job_(std::move(job)),
      operator_(twin_, job_.refills),
      options_(std::move(options)),
      control_(setup(printer)) {
    job_.journal = journal_.path();
    job_.sync_journal = false;
}

host::ControlSetup VirtualPrint::setup(const machine::Printer& printer) {
    constexpr double whenever_it_listens_s = 1e9;  // no requests arrive except while listening
    host::ControlSetup setup{
        .printer = printer,
        .open_wire = [this]() -> Result<std::unique_ptr<host::Wire>> { return open_wire(); },
        .projector = projector_,
        .clock = clock_,
        .programs = operate::programs_of(printer),
        .link = options_.link.value_or(operate::link_options(printer.controller)),
        .after_layer = options_.after_layer,
        .guard = &guard_,
        .after_light = [this](const host::Given& given) { note(given); },
        .clock_name = "virtual",
    };
    setup.link.watch_every_s = whenever_it_listens_s;
    return setup;
}

std::unique_ptr<host::Wire> VirtualPrint::open_wire() {
    auto wire = std::make_unique<TwinWire>(twin_, [this] { look(); });
    return options_.wire ? options_.wire(std::move(wire)) : std::move(wire);
}

void VirtualPrint::look() {
    if (!cancelling_ && progress_->cancelled()) cancelling_ = control_.cancel().has_value();
    operator_.look(control_);
    if (options_.meanwhile) options_.meanwhile(control_);
}

void VirtualPrint::note(const host::Given& given) {
    lights_.push_back(given);
    progress_->advance("print", control_.snapshot().completion);
}

Status VirtualPrint::print(Progress& progress) {
    progress_ = &progress;
    if (Status loaded = control_.load(job_); !loaded) return loaded;
    if (Status started = control_.start({}); !started) return started;
    control_.serve_until_idle();
    const host::Snapshot last = control_.snapshot();
    if (last.finished) {
        progress.advance("print", 1);
        return {};
    }
    return last.failed ? failure("{}", last.message) : Status(cancelled());
}

Result<std::string> VirtualPrint::journal() const {
    return read_file(journal_.path());
}

Result<std::vector<host::JournalRecord>> VirtualPrint::records() const {
    const Result<std::string> text = journal();
    if (!text) return tl::unexpected(text.error());
    auto journal = host::parse_journal(*text, "the virtual print's journal");
    if (!journal) return tl::unexpected(journal.error());
    return std::move(journal->records);
}

}  // namespace pliant::rehearse
