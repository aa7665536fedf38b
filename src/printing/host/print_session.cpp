// The working thread of a Control: the connection to the machine, and a print from its start or its resumption to its
// end.
#include <fmt/format.h>

#include <algorithm>

#include "base/core/boot_name.hpp"
#include "printing/host/control_private.hpp"

namespace pliant::host {
namespace {

using machine::Axis;

constexpr int connects_to_halted = 3;  // a halted controller stays silent

/// The first line number of a session: far from the numbers of other hosts and of recent sessions.
long new_base(const Clock& clock, long last) {
    const auto spread = static_cast<long>(clock.now() * 1000) % 900;
    const long base = 1'000'000 + spread * 10'000;
    return last > base - 10'000 && last < base + 1'000'000 ? base + 10'000'000 : base;
}

}  // namespace

/// What is to end while it connects ends at once: nothing has moved, so there is nothing to park. An interrupted print
/// that is being discarded is not kept by a second request to cancel it.
Status Control::Private::watch() {
    if (Status status = desk.watch(); !status || !connects) return status;
    const Wishes wishes = desk.wishes();
    const State state = desk.state();
    const bool cancels = wishes.cancel && state != State::cancelling;
    const bool unwanted = is_printing(state) && (cancels || wishes.suspend);
    const std::scoped_lock lock(mutex);
    return unwanted || quitting ? Status(cancelled()) : Status{};
}

/// Opening may take seconds; an emergency stop must not wait for it.
Status Control::Private::open_wire() {
    auto opened = setup.open_wire();
    if (!opened) return tl::unexpected(opened.error());
    const std::scoped_lock lock(mutex);
    wire = std::move(*opened);
    return {};
}

Status Control::Private::open() {
    touched = true;
    if (setup.emergency_line != nullptr) {
        if (Status status = setup.emergency_line->release(); !status) return status;
    }
    LinkOptions options = setup.link;
    options.may_be_halted = may_be_halted;
    if (may_be_halted) options.most_connects = std::min(options.most_connects, connects_to_halted);
    if (machine) {
        machine->link().set_watch(nullptr);
        renew_machine(options);
    } else {
        if (Status status = open_wire(); !status) return status;
        machine = std::make_unique<Machine>(*wire, setup.clock, setup.printer, options);
        forget_line();
    }
    hear_machine();
    return find_last_line();
}

/// A new link on the same wire; the machine stands where it stood.
void Control::Private::renew_machine(const LinkOptions& options) {
    sent_line = machine->link().next_number() - 1;
    auto fresh = std::make_unique<Machine>(*wire, setup.clock, setup.printer, options);
    fresh->stand(machine->state());
    fresh->link().expect_no_start();
    machine = std::move(fresh);
}

void Control::Private::hear_machine() {
    machine->link().set_watch([this] { return watch(); });
    machine->link().set_listener([this](std::string_view line) {
        machine->hear(line);
        for (const std::string_view told : {"//action:prompt_begin", "//action:notification", "echo:busy: paused"}) {
            if (line.substr(0, told.size()) == told) desk.event("log", std::string(line));
        }
    });
}

/// The line numbers that this host has used itself since are no trace of another program: then the controller's last
/// line is the last one that this host has sent.
Status Control::Private::find_last_line() {
    const auto last = machine->link().last_line();
    if (!last) return tl::unexpected(last.error());
    may_be_halted = false;
    const bool started = machine->link().has_started();
    const bool ours = untouched_line && !started && *last == sent_line;
    wire_line = started ? 0 : *last;
    last_line = ours ? *untouched_line : wire_line;
    all_done = all_done && ours;
    untouched_line = last_line;
    return {};
}

void Control::Private::forget_line() {
    untouched_line.reset();
    all_done = false;
}

/// An idle machine is asked for its switches. While a print waits to be resumed, these questions must not lead the line
/// numbers beyond what its journal proves, also to another host: after some of them the numbers begin again.
Status Control::Private::keep_line_numbers() {
    constexpr long most_asked = 60;  // lines
    if (!all_done || !untouched_line || *untouched_line <= 0) return {};
    if (machine->link().next_number() - 1 - *untouched_line <= most_asked) return {};
    machine->link().set_watch(nullptr);
    renew_machine(setup.link);
    hear_machine();
    if (Status status = find_last_line(); !status) return status;
    if (last_line == 0) return failure("the printer restarted: its position is lost");
    return machine->connect(last_line);
}

void Control::Private::close() {
    machine.reset();
    forget_line();
    {
        const std::scoped_lock lock(mutex);
        wire.reset();
    }
    desk.update([](Snapshot& s) {
        s.firmware.clear();
        s.homed.fill(false);
        s.door_open.reset();
        s.switches.clear();
        s.slot = 0;
        s.pump = false;
    });
}

void Control::Private::fail(const Error& error) {
    (void)setup.projector.black();
    const std::string message = desk.stopped() ? after_emergency_stop : error.message;
    desk.event("error", message);
    may_be_halted = may_be_halted || desk.stopped() || (machine && machine->link().has_halted());
    close();
    {
        const std::scoped_lock lock(mutex);
        std::erase_if(tasks, [](const Task& task) { return task.for_machine; });
    }
    desk.update([](Snapshot& s) {
        s.failed = true;
        s.lit = false;
    });
    desk.state(State::halted, message);
    desk.clear_stop();
}

/// It was ended while it waited for the controller.
void Control::Private::leave() {
    constexpr const char* what = "ended before anything moved";
    close();
    desk.event("log", what);
    desk.state(State::offline, what);
}

void Control::Private::do_connect() {
    desk.clear_stop();
    connects = true;
    Status status = open();
    if (status) status = machine->connect(last_base = new_base(setup.clock, std::max(last_line, last_base)));
    connects = false;
    if (!status && status.error().cause == Cause::cancelled) return leave();
    if (!status) return fail(status.error());
    note_firmware();
    show_machine();
    desk.state(State::idle);
}

void Control::Private::note_firmware() {
    const Firmware& firmware = machine->firmware();
    desk.update([&](Snapshot& s) { s.firmware = firmware.name; });
    const auto parser = firmware.capabilities.find("EMERGENCY_PARSER");
    const bool deaf = parser != firmware.capabilities.end() && !parser->second;
    {
        const std::scoped_lock lock(mutex);
        hears_m112 = !deaf;
    }
    if (deaf) desk.event("log", "this firmware has no EMERGENCY_PARSER: an emergency stop waits or resets it");
}

void Control::Private::show_machine() {
    const machine::Interlock& at = machine->state();
    desk.update([&](Snapshot& s) {
        s.position = at.position();
        for (const Axis axis : machine::all_axes) s.homed[static_cast<std::size_t>(axis)] = at.homed(axis);
        const auto vat = at.hooked_vat();
        s.slot = vat ? setup.printer.slot_of(*vat) : 0;
        s.pump = at.pump_runs();
    });
    show_switches();
}

void Control::Private::show_switches() {
    desk.update([&](Snapshot& s) {
        s.door_open = machine->door_open();
        s.switches = machine->limit_switches();
    });
}

/// Whether the loaded job was interrupted on this printer.
void Control::Private::look_at_journal() {
    bool interrupted = false;
    std::error_code none;
    if (job && !job->journal.empty() && std::filesystem::exists(job->journal, none)) {
        const auto journal = Journal::open(job->journal, false);
        const auto facts = journal ? facts_of(journal->records()) : tl::unexpected(journal.error());
        interrupted = facts && is_interrupted(*facts) && check_journal(*facts);
    }
    desk.update([&](Snapshot& s) { s.can_resume = interrupted; });
}

/// The first line number of a new session of the machine, which then stands there.
long Control::Private::begin_numbers(const JournalFacts& facts, const Standing& standing) {
    last_base = new_base(setup.clock, std::max({last_line, last_base, facts.base}));
    machine->stand(standing.state);
    return last_base;
}

Status Control::Private::note_session(Journal& journal, long base, const Standing& standing) const {
    const auto noted =
        journal.append("session", {{"base", fmt::format("{}", base)},
                                   {"before", fmt::format("{}", wire_line > 0 ? wire_line : -1)},
                                   {"boot", setup.clock_name ? *setup.clock_name : boot_name().value_or("")},
                                   {"state", write_state(standing.state.state())}});
    return noted ? Status{} : tl::unexpected(noted.error());
}

Status Control::Private::connect_machine(long base, Journal* journal) {
    if (Status status = machine->connect(base); !status) return status;
    note_firmware();
    machine->keep(journal);
    forget_line();
    return {};
}

/// Before any motion: checks the switches and that the door is shut.
Status Control::Private::preflight() const {
    if (Status status = machine->look_at_switches(); !status) return status;
    return machine->door_open().value_or(false) ? Status(failure("the door is open: close it")) : Status{};
}

Status Control::Private::check_journal(const JournalFacts& facts) const {
    const std::string where = job->journal.string();
    if (!facts.begun || facts.ended || facts.cancelled) {
        const char* why = !facts.begun ? "it has not begun" : facts.ended ? "it is complete" : "it was cancelled";
        return input_error("{}: nothing to resume: {}; start it without --resume", where, why);
    }
    if (facts.digest != job->digest)
        return input_error("{}: this journal is of another job, or the job has changed since", where);
    if (facts.printer != setup.printer.name)
        return input_error("{}: this print was begun on \"{}\", this printer is \"{}\"", where, facts.printer,
                           setup.printer.name);
    if (Status fits = check_fits(facts, script, *job); !fits) return input_error("{}: {}", where, fits.error().message);
    if (!facts.go) return {};
    if (const auto known = last_known(facts, setup.printer); !known)
        return input_error("{}: {}", where, known.error().message);
    return {};
}

/// The journal of the previous print gives way to that of this one. Call when the machine is ready: a start that fails
/// before leaves the old one.
Status Control::Private::begin_journal(Journal& journal, long base, const Standing& standing) {
    if (Status status = journal.clear(); !status) return status;
    if (setup.guard != nullptr) setup.guard->forget();
    JournalValues values{{"job", job->name}, {"digest", job->digest}, {"printer", setup.printer.name}, {"format", "1"}};
    if (!job->vats.empty()) values.emplace_back("vats", job->vats);
    if (const auto begun = journal.append("begin", values); !begun) return tl::unexpected(begun.error());
    return note_session(journal, base, standing);
}

Result<Ending> Control::Private::print_anew(Journal* journal) {
    if (journal != nullptr) {
        const auto facts = facts_of(journal->records());
        if (!facts) return tl::unexpected(facts.error());
        if (is_interrupted(*facts)) {
            if (Status way = check_way_on(*facts, script, setup.printer, setup.programs.resume); !way)
                return input_error("{}: this job was interrupted and cannot be resumed: {}", job->journal.string(),
                                   way.error().message);
            return input_error(
                "{}: this job was interrupted; continue with --resume, or delete the journal to start over",
                job->journal.string());
        }
        may_be_halted = may_be_halted || facts->halted;
    }
    if (Status status = open(); !status) return tl::unexpected(status.error());
    const Standing standing{machine::Interlock(setup.printer), false};
    const long base = begin_numbers({}, standing);
    if (Status status = connect_machine(base, nullptr); !status) return tl::unexpected(status.error());
    if (Status status = preflight(); !status) return tl::unexpected(status.error());
    if (journal != nullptr) {
        if (Status status = begin_journal(*journal, base, standing); !status) return tl::unexpected(status.error());
        machine->keep(journal);
    }
    connects = false;
    PrintRun run({setup, *job, script, times, *machine, journal, desk}, {});
    Result<Ending> ending = run.print();
    if (!ending) run.make_safe(ending.error());
    return ending;
}

Result<Ending> Control::Private::go_on(const StartOptions& options, bool abandon, Journal& journal) {
    auto facts = facts_of(journal.records());
    if (!facts) return input_error("{}: {}", job->journal.string(), facts.error().message);
    if (Status status = check_journal(*facts); !status) return tl::unexpected(status.error());
    const auto open_light = close_open_light(*facts, setup.guard, options.assume, job->materials);
    if (!open_light) return tl::unexpected(open_light.error());
    if (*open_light) {
        const auto noted = journal.append("dark", {{"light", fmt::format("{}", (*open_light)->light)},
                                                   {"on", fmt::format("{}", (*open_light)->on_s)},
                                                   {"done", (*open_light)->complete ? "1" : "0"},
                                                   {"by", (*open_light)->assumed ? "assumed" : "guard"}});
        if (!noted) return tl::unexpected(noted.error());
    }
    may_be_halted = may_be_halted || facts->halted;
    if (Status status = open(); !status) return tl::unexpected(status.error());
    const auto standing = standing_of(*facts, script, setup.printer, last_line, options.assume);
    if (!standing) return tl::unexpected(standing.error());
    const auto recovery = recovery_of(*facts, script, setup.printer, *standing);
    if (!recovery) return tl::unexpected(recovery.error());
    if (const auto possible = setup.programs.resume(*recovery); !possible) return tl::unexpected(possible.error());
    const Standing from{recovery->state, false};
    const long base = begin_numbers(*facts, from);
    // Before the controller gets its new line numbers, the journal knows them.
    if (Status status = note_session(journal, base, from); !status) return tl::unexpected(status.error());
    if (Status status = connect_machine(base, &journal); !status) return tl::unexpected(status.error());
    if (Status status = preflight(); !status) return tl::unexpected(status.error());
    connects = false;
    if (!options.has_refilled) facts->asked.clear();
    PrintRun run({setup, *job, script, times, *machine, &journal, desk}, std::move(*facts));
    Result<Ending> ending = abandon ? run.abandon(*recovery) : run.resume(*recovery);
    if (!ending) run.make_safe(ending.error());
    return ending;
}

Result<Ending> Control::Private::print(const StartOptions& options, bool abandon, Journal* journal) {
    if (!options.resume) return print_anew(journal);
    if (journal == nullptr) return input_error("without a journal nothing can be resumed");
    return go_on(options, abandon, *journal);
}

void Control::Private::do_start(const StartOptions& options, bool abandon) {
    if (!job) {
        desk.event("error", "no job is loaded");
        return desk.state(machine ? State::idle : State::offline, "no job is loaded");
    }
    touched = false;
    desk.clear_stop();
    desk.update([&](Snapshot& s) {
        s.failed = s.finished = false;
        s.begun_s.reset();
        s.seconds_done = 0;
        if (options.resume || s.can_resume) return;  // without `resume` it is refused, and still waits
        s.layer = s.material = -1;
        s.image.clear();
        s.completion = s.lit_s = s.exposure_s = 0;
        s.seconds_left = times.back();
        s.exposures_s.assign(s.exposures_s.size(), 0);
    });
    {
        const std::scoped_lock lock(mutex);
        if (quitting) return desk.state(machine ? State::idle : State::offline);
    }
    connects = true;
    Result<Ending> ending = Ending::finished;
    if (job->journal.empty()) {
        ending = print(options, abandon, nullptr);
    } else {
        auto journal = Journal::open(job->journal, job->sync_journal);
        ending = journal ? print(options, abandon, &*journal) : tl::unexpected(journal.error());
    }
    finish(ending);
}

void Control::Private::finish(const Result<Ending>& ending) {
    connects = false;
    (void)setup.projector.black();
    look_at_journal();
    if (!ending && !touched) {  // refused before anything was sent to the machine
        desk.event("error", ending.error().message);
        desk.update([](Snapshot& s) { s.failed = true; });
        return desk.state(machine ? State::idle : State::offline, ending.error().message);
    }
    if (!ending && ending.error().cause == Cause::cancelled) return leave();
    if (!ending) return fail(ending.error());
    show_machine();
    machine->keep(nullptr);
    if (*ending == Ending::suspended || *ending == Ending::left) {
        untouched_line = machine->link().next_number() - 1;
        all_done = true;
    }
    desk.update([&](Snapshot& s) {
        s.finished = *ending == Ending::finished;
        s.lit = false;
        if (s.finished) s.completion = 1;
        if (s.finished) s.seconds_left = 0;
        s.lines_sent = machine->link().lines_sent();
        s.resends = machine->link().resends();
    });
    const char* what = *ending == Ending::finished    ? "the print is complete"
                       : *ending == Ending::cancelled ? "the print was cancelled, the machine is parked"
                       : *ending == Ending::left
                           ? "the print is suspended, and the machine is not parked, because the door is open"
                           : "the print is suspended, the machine is parked";
    desk.event("log", what);
    desk.state(State::idle, what);
}

}  // namespace pliant::host
