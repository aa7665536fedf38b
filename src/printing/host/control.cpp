#include "printing/host/control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <fstream>
#include <mutex>
#include <thread>

#include "base/core/digest.hpp"
#include "printing/host/desk.hpp"
#include "printing/host/journal.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/machine.hpp"
#include "printing/host/print_run.hpp"
#include "printing/host/resume_point.hpp"
#include "printing/host/script.hpp"
#include "printing/machine/gcode.hpp"

namespace pliant::host {
namespace {

using machine::Axis;

constexpr double idle_listen_s = 0.05;
constexpr int connects_to_halted = 3;       // a halted controller stays silent
constexpr double slowest_feed_mm_s = 0.01;  // of moves by hand; G-code has a tenth of a mm/min
constexpr const char* after_emergency_stop =
    "emergency stop: the board is halted; reset it (its button, or its power off and on) before anything else";

bool is_printing(State state) {
    return state == State::printing || state == State::pausing || state == State::paused || state == State::cancelling;
}

/// Identifies the boot of the computer; "" if unknown.
std::string boot_name() {
    std::ifstream file("/proc/sys/kernel/random/boot_id");
    std::string name;
    std::getline(file, name);
    return name;
}

/// The first line number of a session: far from the numbers of other hosts and of recent sessions.
long new_base(const Clock& clock, long last) {
    const auto spread = static_cast<long>(clock.now() * 1000) % 900;
    const long base = 1'000'000 + spread * 10'000;
    return last > base - 10'000 && last < base + 1'000'000 ? base + 10'000'000 : base;
}

}  // namespace

std::string_view state_text(State state) {
    switch (state) {
        case State::offline:
            return "Offline";
        case State::connecting:
            return "Connecting";
        case State::idle:
            return "Operational";
        case State::working:
            return "Working";
        case State::printing:
            return "Printing";
        case State::pausing:
            return "Pausing";
        case State::paused:
            return "Paused";
        case State::cancelling:
            return "Cancelling";
        case State::halted:
            break;
    }
    return "Error";
}

std::string job_digest(std::string_view bytes) {
    Digest digest;
    digest.add(bytes.data(), bytes.size());
    return digest.text();
}

/// A request that waits for the working thread.
struct Control::Task {
    std::function<void()> run;
    bool for_machine = true;  ///< dropped after a failure or an emergency stop, unlike the loading of a job
    long stops = 0;           ///< number of emergency stops when it was requested
};

/// The private state. The last members are used by the working thread only.
struct Control::State_ {
    explicit State_(ControlSetup s) : setup(std::move(s)), desk(setup.clock) {}

    ControlSetup setup;
    Desk desk;
    std::mutex mutex;  ///< protects tasks, quitting, and `wire` while it is replaced
    std::condition_variable woken;
    std::deque<Task> tasks;
    bool quitting = false;
    bool hears_m112 = true;  ///< acts on M112 at once, even when busy: EMERGENCY_PARSER
    std::shared_ptr<Wire> wire;
    bool moves_by_hand = false;    ///< a single move, which the next one stops
    bool stopped_by_hand = false;  ///< this has happened

    // Working thread only:
    std::unique_ptr<Machine> machine;
    bool touched = false;  ///< something was sent to the controller since the last start
    long last_line = 0;    ///< of the controller when the wire was opened
    /// The same, if only line numbers and queries have been sent since: connecting first and resuming later then proves
    /// as much as resuming at once.
    std::optional<long> untouched_line;
    long last_base = 0;          ///< of our previous session
    bool may_be_halted = false;  ///< the controller was halted when last heard
    std::optional<PrintJob> job;
    Script script;
    std::vector<double> times;

    [[nodiscard]] Status ask_for(std::optional<State> next, const std::function<Status(const Snapshot&)>& allowed,
                                 std::function<void()> task, bool for_machine = true);
    [[nodiscard]] bool stop_move();
    [[nodiscard]] Status run_one_move(const std::string& program);
    [[nodiscard]] Status by_hand(std::function<Result<std::string>(const machine::Interlock&)> program,
                                 bool one_move = false);
    bool run_next_task();

    [[nodiscard]] Status open_wire();
    [[nodiscard]] Status open();
    [[nodiscard]] Status new_session(Journal* journal, const JournalFacts& facts, const Standing& standing);
    void close();
    void do_connect();
    void do_start(const StartOptions& options, bool abandon);
    [[nodiscard]] Result<Ending> print(const StartOptions& options, bool abandon, Journal* journal);
    [[nodiscard]] Result<Ending> print_anew(Journal* journal);
    [[nodiscard]] Result<Ending> go_on(const StartOptions& options, bool abandon, Journal& journal);
    [[nodiscard]] Status preflight() const;
    [[nodiscard]] Status check_journal(const JournalFacts& facts) const;
    void finish(const Result<Ending>& ending);
    void show_machine();
    void show_switches();
    void note_firmware();
    void fail(const Error& error);
    void look_at_journal();
};

// Requests.

/// Checks the state and changes it to the next one atomically, so that only one of two concurrent requests succeeds.
/// Without `next` the state is unchanged. Until an emergency stop has been dealt with, nothing is allowed.
Status Control::State_::ask_for(std::optional<State> next, const std::function<Status(const Snapshot&)>& allowed,
                                std::function<void()> task, bool for_machine) {
    const long stops = desk.stops();
    const bool stopping = for_machine && desk.stopped();
    Status status;
    desk.update([&](Snapshot& s) {
        status = stopping && s.state != State::offline && s.state != State::halted ? failure(after_emergency_stop)
                                                                                   : allowed(s);
        if (status && next) s.state = *next;
    });
    if (!status) return status;
    if (next) desk.event("state", std::string(state_text(*next)));
    {
        const std::scoped_lock lock(mutex);
        tasks.push_back({std::move(task), for_machine, stops});
    }
    woken.notify_all();
    return {};
}

namespace {

Status only_when_idle(const Snapshot& s) {
    if (s.state == State::idle) return {};
    return failure("not possible now: the printer is {}", state_text(s.state));
}

Status only_when_printing(const Snapshot& s) {
    if (is_printing(s.state)) return {};
    return failure("not possible now: no print is under way");
}

}  // namespace

Control::Control(ControlSetup setup) : state_(std::make_unique<State_>(std::move(setup))) {}

Control::~Control() = default;

Status Control::connect() {
    return state_->ask_for(
        State::connecting,
        [](const Snapshot& s) -> Status {
            if (s.state == State::offline || s.state == State::halted) return {};
            return failure("not possible now: the printer is {}", state_text(s.state));
        },
        [this] { state_->do_connect(); });
}

Status Control::disconnect() {
    return state_->ask_for(
        State::offline,
        [](const Snapshot& s) -> Status {
            if (!is_printing(s.state) && s.state != State::working) return {};
            return failure("not possible now: the printer is {}", state_text(s.state));
        },
        [this] { state_->close(); });
}

Status Control::load(PrintJob job) {
    auto script = read_script(job.gcode);
    if (!script) return tl::unexpected(script.error());
    auto times = script_times(*script, state_->setup.printer);
    if (!times) return tl::unexpected(times.error());
    return state_->ask_for(
        std::nullopt,
        [](const Snapshot& s) -> Status {
            if (!is_printing(s.state) && s.state != State::working && s.state != State::connecting) return {};
            return failure("not possible now: the printer is {}", state_text(s.state));
        },
        [this, job = std::move(job), script = std::move(*script), times = std::move(*times)]() mutable {
            state_->job = std::move(job);
            state_->script = std::move(script);
            state_->times = std::move(times);
            state_->desk.update([&](Snapshot& s) {
                s.job = state_->job->name;
                s.layers = state_->job->layers;
                s.layer = s.material = -1;
                s.image.clear();
                s.completion = s.seconds_done = 0;
                s.seconds_left = state_->times.back();
                s.finished = s.failed = false;
                s.exposures_s.assign(state_->job->materials.size(), 0);
            });
            state_->desk.event("log", "job " + state_->job->name);
            state_->look_at_journal();
        },
        false);
}

Status Control::start(const StartOptions& options) {
    return state_->ask_for(
        State::printing,
        [&](const Snapshot& s) -> Status {
            if (s.state != State::idle && s.state != State::offline && s.state != State::halted)
                return failure("not possible now: the printer is {}", state_text(s.state));
            return {};
        },
        [this, options] { state_->do_start(options, false); });
}

Status Control::pause(PauseWhen when) {
    Status status = only_when_printing(snapshot());
    if (!status) return status;
    state_->desk.wish([&](Wishes& w) { (when == PauseWhen::now ? w.pause_now : w.pause_after) = true; });
    return {};
}

Status Control::resume() {
    const Snapshot now = snapshot();
    if (now.state != State::paused) return failure("not possible now: the print is not paused");
    if (now.door_open.value_or(false)) return failure("not possible now: the door is open; close it first");
    state_->desk.wish([](Wishes& w) { w.resume = true; });
    return {};
}

Status Control::cancel() {
    const Snapshot now = snapshot();
    if (!is_printing(now.state) && now.can_resume && now.state == State::idle) {
        return state_->ask_for(State::cancelling, only_when_idle, [this] { state_->do_start({true, {}}, true); });
    }
    if (Status status = only_when_printing(now); !status) return status;
    state_->desk.wish([](Wishes& w) { w.cancel = true; });
    return {};
}

Status Control::suspend() {
    if (Status status = only_when_printing(snapshot()); !status) return status;
    state_->desk.wish([](Wishes& w) { w.suspend = true; });
    return {};
}

void Control::emergency_stop() {
    const Status pulled = state_->setup.emergency_line != nullptr ? state_->setup.emergency_line->pull() : Status{};
    std::shared_ptr<Wire> wire;  // kept alive while the working thread releases it
    bool hears_m112 = true;
    {
        const std::scoped_lock lock(state_->mutex);
        wire = state_->wire;
        hears_m112 = state_->hears_m112;
    }
    if (wire) (void)wire->write("\nM410\n");
    state_->desk.stop_everything();
    state_->woken.notify_all();
    if (wire) {
        // In real time: the devices' clock may be a virtual one that stands still.
        std::this_thread::sleep_for(std::chrono::duration<double>(m112_after_m410_s));
        (void)wire->write("\nM112\n");
        // Firmware that reads M112 only in its turn is stopped by a reset, if the wire supports it.
        if (!hears_m112) (void)wire->reset();
    }
    if (!pulled) state_->desk.event("error", pulled.error().message);
    state_->desk.event("error", "emergency stop");
}

Status Control::set_exposure(int material, double seconds) {
    const Snapshot now = snapshot();
    const double most_s = state_->setup.printer.limits.exposure_s;
    if (material < 0 || static_cast<std::size_t>(material) >= now.exposures_s.size())
        return input_error("the job has no material {}", material);
    if (!(seconds > 0 && seconds <= most_s))
        return input_error("exposure of {:g} s: {} allows up to {:g} s", seconds, state_->setup.printer.name, most_s);
    if (Status status = only_when_printing(now); !status) return status;
    state_->desk.change_exposure(material, seconds);
    return {};
}

Status Control::skip_layer(int layer) {
    const Snapshot now = snapshot();
    if (Status status = only_when_printing(now); !status) return status;
    if (layer <= now.layer || layer >= now.layers)
        return input_error("layer {}: only layers {} to {} have not begun", layer, now.layer + 1, now.layers - 1);
    state_->desk.skip_layer(layer);
    return {};
}

// Manual operations.

/// From any thread: sends M410 to the current manual move. False if there is none, or the firmware would not act on it.
bool Control::State_::stop_move() {
    const std::scoped_lock lock(mutex);
    if (!moves_by_hand || stopped_by_hand || !hears_m112 || !wire) return false;
    stopped_by_hand = true;
    return wire->write("\nM410\n").has_value();
}

Status Control::State_::run_one_move(const std::string& program) {
    {
        const std::scoped_lock lock(mutex);
        moves_by_hand = true;
    }
    const Status status = machine->run(program);
    bool stopped = false;
    {
        const std::scoped_lock lock(mutex);
        moves_by_hand = false;
        stopped = std::exchange(stopped_by_hand, false);
    }
    if (!status || !stopped) return status;
    if (Status asked = machine->stand_where_stopped(); !asked) return asked;
    return failure("the move was stopped on its way; home the axes before the next one");
}

/// Runs the program that `program` makes for the present state; no print may be running or waiting to be resumed.
Status Control::State_::by_hand(std::function<Result<std::string>(const machine::Interlock&)> program, bool one_move) {
    return ask_for(
        State::working,
        [](const Snapshot& s) -> Status {
            if (s.can_resume) return failure("an interrupted print waits: resume it or cancel it first");
            return only_when_idle(s);
        },
        [this, one_move, program = std::move(program)] {
            if (!machine) return;  // the link has failed since the request
            const auto text = program(machine->state());
            untouched_line.reset();
            Status status =
                text ? (one_move ? run_one_move(*text) : machine->run(*text)) : tl::unexpected(text.error());
            show_machine();
            if (status || (!machine->link().was_reset() && !machine->link().wire_failed() && !desk.stopped())) {
                if (!status) desk.event("error", status.error().message);
                desk.state(State::idle, status ? "" : status.error().message);
            } else {
                fail(status.error());
            }
        });
}

Status Control::move_to(Axis axis, int um, double feed_mm_s) {
    if (!(feed_mm_s == 0 || feed_mm_s >= slowest_feed_mm_s))
        return input_error("a speed of {:g} mm/s: the slowest is {:g} mm/s", feed_mm_s, slowest_feed_mm_s);
    if (state_->stop_move()) return failure("the move under way is stopped instead; home the axes before the next one");
    const auto program = [this, axis, um, feed_mm_s](const machine::Interlock& at) -> Result<std::string> {
        machine::Position to = at.position();
        to[axis] = um;
        const machine::Printer& printer = state_->setup.printer;
        const double feed =
            feed_mm_s > 0 ? std::min(feed_mm_s, printer.axis(axis).speed_mm_s) : printer.axis(axis).speed_mm_s;
        return "G90\n" + machine::write_move(printer, at.position(), to, feed) + "\n";
    };
    return state_->by_hand(program, true);
}

Status Control::jog(Axis axis, int um, double feed_mm_s) {
    return move_to(axis, snapshot().position[axis] + um, feed_mm_s);
}

Status Control::home(std::vector<Axis> axes) {
    if (axes.empty()) axes = machine::homing_order(state_->setup.printer);
    return state_->by_hand([this, axes](const machine::Interlock&) -> Result<std::string> {
        std::string text;
        for (const std::string& line : machine::preamble(state_->setup.printer)) text += line + "\n";
        for (const Axis axis : axes) {
            if (!state_->setup.printer.axis(axis).present())
                return input_error("the printer has no {}", machine::axis_name(axis));
            text += machine::write_home(state_->setup.printer, axis) + "\n";
        }
        return text;
    });
}

Status Control::bring_vat(int slot) {
    return state_->by_hand(
        [this, slot](const machine::Interlock& at) { return state_->setup.programs.bring_vat(at, slot); });
}

Status Control::clean(double seconds) {
    return state_->by_hand(
        [this, seconds](const machine::Interlock& at) { return state_->setup.programs.clean(at, seconds); });
}

Status Control::prime(double seconds) {
    return clean(seconds);
}

Status Control::expose_test(job::Image image, double seconds) {
    const machine::Printer& printer = state_->setup.printer;
    if (!(seconds > 0 && seconds <= printer.limits.exposure_s))
        return input_error("exposure of {:g} s: {} allows up to {:g} s", seconds, printer.name,
                           printer.limits.exposure_s);
    if (image.width_px != printer.projector.width_px || image.height_px != printer.projector.height_px)
        return input_error("the image has {} x {} pixels, the projector {} x {}", image.width_px, image.height_px,
                           printer.projector.width_px, printer.projector.height_px);
    return state_->ask_for(State::working, only_when_idle, [this, image = std::move(image), seconds] {
        State_& s = *state_;
        if (!s.machine) return;  // the link has failed since the request
        if (Status status = s.preflight(); !status) {
            s.desk.event("error", status.error().message);
            return s.desk.state(State::idle, status.error().message);
        }
        const double end_s = s.setup.clock.now() + seconds;
        Status status = s.setup.projector.show_for(image, seconds);
        s.desk.event("light", fmt::format("test, {:g} s", seconds));
        while (status && s.setup.clock.now() < end_s) {
            if (status = s.desk.watch(); !status) break;
            if (status = s.machine->ask_for_door(); !status) break;
            if (status = s.machine->link().listen_for(std::min(0.01, end_s - s.setup.clock.now()), false); !status)
                break;
            if (s.machine->door_open().value_or(false)) break;
        }
        const Status dark = s.setup.projector.black();
        s.desk.event("dark", "test");
        if (status) status = dark;
        if (!status) return s.fail(status.error());
        s.desk.state(State::idle);
    });
}

Status Control::reset_controller() {
    return state_->ask_for(
        State::connecting,
        [](const Snapshot& s) -> Status {
            if (!is_printing(s.state) && s.state != State::working) return {};
            return failure("not possible now: the printer is {}", state_text(s.state));
        },
        [this] {
            State_& s = *state_;
            Status status;
            if (!s.wire) status = s.open_wire();
            if (status) status = s.wire->reset();
            s.close();
            if (!status) return s.fail(status.error());
            s.do_connect();
        });
}

// Queries.

Snapshot Control::snapshot() const {
    return state_->desk.snapshot();
}

State Control::state() const {
    return state_->desk.state();
}

std::vector<Event> Control::events_since(long number) const {
    return state_->desk.events_since(number);
}

// The working thread.

bool Control::State_::run_next_task() {
    Task task;
    {
        const std::scoped_lock lock(mutex);
        if (tasks.empty()) return false;
        task = std::move(tasks.front());
        tasks.pop_front();
    }
    if (task.for_machine && task.stops != desk.stops())
        fail({Cause::failed, after_emergency_stop});
    else
        task.run();
    return true;
}

void Control::serve_until_idle() {
    while (state_->run_next_task()) {
    }
}

void Control::serve() {
    State_& s = *state_;
    for (;;) {
        if (s.run_next_task()) continue;
        {
            std::unique_lock lock(s.mutex);
            if (s.quitting && s.tasks.empty()) break;
            if (!s.machine) {
                s.woken.wait_for(lock, std::chrono::milliseconds(50));
                continue;
            }
        }
        Status status = s.desk.watch();
        if (status) status = s.machine->ask_for_switches();
        if (status) status = s.machine->link().listen_for(idle_listen_s);
        if (!status)
            s.fail(status.error());
        else
            s.show_switches();
    }
    s.close();
}

void Control::quit() {
    {
        const std::scoped_lock lock(state_->mutex);
        state_->quitting = true;
    }
    // In this order: a print that begins resets the wishes first, and looks at `quitting` then.
    state_->desk.wish([](Wishes& w) { w.suspend = true; });
    state_->woken.notify_all();
}

/// Opening may take seconds; an emergency stop must not wait for it.
Status Control::State_::open_wire() {
    auto opened = setup.open_wire();
    if (!opened) return tl::unexpected(opened.error());
    const std::scoped_lock lock(mutex);
    wire = std::move(*opened);
    return {};
}

Status Control::State_::open() {
    touched = true;
    if (setup.emergency_line != nullptr) {
        if (Status status = setup.emergency_line->release(); !status) return status;
    }
    LinkOptions options = setup.link;
    options.may_be_halted = may_be_halted;
    if (may_be_halted) options.most_connects = std::min(options.most_connects, connects_to_halted);
    if (machine) {
        machine->link().set_watch(nullptr);
        auto fresh = std::make_unique<Machine>(*wire, setup.clock, setup.printer, options);
        fresh->stand(machine->state());
        fresh->link().expect_no_start();
        machine = std::move(fresh);
    } else {
        if (Status status = open_wire(); !status) return status;
        machine = std::make_unique<Machine>(*wire, setup.clock, setup.printer, options);
    }
    machine->link().set_watch([this] { return desk.watch(); });
    machine->link().set_listener([this](std::string_view line) {
        machine->hear(line);
        for (const std::string_view told : {"//action:prompt_begin", "//action:notification", "echo:busy: paused"}) {
            if (line.substr(0, told.size()) == told) desk.event("log", std::string(line));
        }
    });
    const auto last = machine->link().last_line();
    if (!last) return tl::unexpected(last.error());
    may_be_halted = false;
    last_line = machine->link().has_started() ? 0 : untouched_line.value_or(*last);
    untouched_line = last_line;
    return {};
}

void Control::State_::close() {
    machine.reset();
    untouched_line.reset();
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
    });
}

void Control::State_::fail(const Error& error) {
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

void Control::State_::do_connect() {
    desk.clear_stop();
    Status status = open();
    if (status) status = machine->connect(last_base = new_base(setup.clock, std::max(last_line, last_base)));
    if (!status) return fail(status.error());
    note_firmware();
    show_machine();
    desk.state(State::idle);
}

void Control::State_::note_firmware() {
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

void Control::State_::show_machine() {
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

void Control::State_::show_switches() {
    desk.update([&](Snapshot& s) {
        s.door_open = machine->door_open();
        s.switches = machine->limit_switches();
    });
}

/// Whether the loaded job was interrupted on this printer.
void Control::State_::look_at_journal() {
    bool interrupted = false;
    std::error_code none;
    if (job && !job->journal.empty() && std::filesystem::exists(job->journal, none)) {
        const auto journal = Journal::open(job->journal, false);
        const auto facts = journal ? facts_of(journal->records()) : tl::unexpected(journal.error());
        interrupted = facts && is_interrupted(*facts) && check_journal(*facts);
    }
    desk.update([&](Snapshot& s) { s.can_resume = interrupted; });
}

/// Sets new line numbers, and records them in the journal before the controller gets them.
Status Control::State_::new_session(Journal* journal, const JournalFacts& facts, const Standing& standing) {
    const long base = new_base(setup.clock, std::max({last_line, last_base, facts.base}));
    last_base = base;
    machine->stand(standing.state);
    if (journal != nullptr) {
        const auto noted = journal->append("session", {{"base", fmt::format("{}", base)},
                                                       {"before", fmt::format("{}", last_line > 0 ? last_line : -1)},
                                                       {"boot", setup.clock_name ? *setup.clock_name : boot_name()},
                                                       {"state", write_state(standing.state.state())}});
        if (!noted) return tl::unexpected(noted.error());
    }
    if (Status status = machine->connect(base); !status) return status;
    note_firmware();
    machine->keep(journal);
    untouched_line.reset();
    return {};
}

/// Before any motion: checks the switches and that the door is shut.
Status Control::State_::preflight() const {
    if (Status status = machine->look_at_switches(); !status) return status;
    return machine->door_open().value_or(false) ? Status(failure("the door is open: close it")) : Status{};
}

Status Control::State_::check_journal(const JournalFacts& facts) const {
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
    return {};
}

Result<Ending> Control::State_::print_anew(Journal* journal) {
    if (journal != nullptr) {
        const auto facts = facts_of(journal->records());
        if (!facts) return tl::unexpected(facts.error());
        if (is_interrupted(*facts)) {
            return input_error(
                "{}: this job was interrupted; continue with --resume, or delete the journal to start over",
                job->journal.string());
        }
        may_be_halted = may_be_halted || facts->halted;
        if (Status status = journal->clear(); !status) return tl::unexpected(status.error());
        JournalValues values{
            {"job", job->name}, {"digest", job->digest}, {"printer", setup.printer.name}, {"format", "1"}};
        if (!job->vats.empty()) values.emplace_back("vats", job->vats);
        if (const auto begun = journal->append("begin", values); !begun) return tl::unexpected(begun.error());
    }
    Status ready = open();
    if (ready) ready = new_session(journal, {}, {machine::Interlock(setup.printer), false});
    if (ready) ready = preflight();
    if (!ready) {
        if (journal != nullptr) (void)journal->clear();  // nothing has begun yet
        return tl::unexpected(ready.error());
    }
    PrintRun run({setup, *job, script, times, *machine, journal, desk}, {});
    Result<Ending> ending = run.print();
    if (!ending) run.make_safe(ending.error());
    return ending;
}

Result<Ending> Control::State_::go_on(const StartOptions& options, bool abandon, Journal& journal) {
    auto facts = facts_of(journal.records());
    if (!facts) return tl::unexpected(facts.error());
    if (Status status = check_journal(*facts); !status) return tl::unexpected(status.error());
    const auto open_light = close_open_light(*facts, setup.guard, options.assume);
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
    if (Status status = new_session(&journal, *facts, {recovery->state, false}); !status)
        return tl::unexpected(status.error());
    if (Status status = preflight(); !status) return tl::unexpected(status.error());
    PrintRun run({setup, *job, script, times, *machine, &journal, desk}, std::move(*facts));
    Result<Ending> ending = abandon ? run.abandon(*recovery) : run.resume(*recovery);
    if (!ending) run.make_safe(ending.error());
    return ending;
}

Result<Ending> Control::State_::print(const StartOptions& options, bool abandon, Journal* journal) {
    if (!options.resume) return print_anew(journal);
    if (journal == nullptr) return input_error("without a journal nothing can be resumed");
    return go_on(options, abandon, *journal);
}

void Control::State_::do_start(const StartOptions& options, bool abandon) {
    if (!job) {
        desk.event("error", "no job is loaded");
        return desk.state(machine ? State::idle : State::offline, "no job is loaded");
    }
    touched = false;
    desk.clear_stop();
    desk.wish([](Wishes& w) { w = Wishes{}; });
    (void)desk.take_changes();
    (void)desk.take_skips();
    desk.update([&](Snapshot& s) {
        s.failed = s.finished = false;
        if (options.resume) return;
        s.layer = s.material = -1;
        s.image.clear();
        s.completion = s.seconds_done = 0;
        s.seconds_left = times.back();
        s.exposures_s.assign(s.exposures_s.size(), 0);
    });
    {
        const std::scoped_lock lock(mutex);
        if (quitting) return desk.state(machine ? State::idle : State::offline);
    }
    Result<Ending> ending = Ending::finished;
    if (job->journal.empty()) {
        ending = print(options, abandon, nullptr);
    } else {
        auto journal = Journal::open(job->journal, job->sync_journal);
        ending = journal ? print(options, abandon, &*journal) : tl::unexpected(journal.error());
    }
    finish(ending);
}

void Control::State_::finish(const Result<Ending>& ending) {
    (void)setup.projector.black();
    look_at_journal();
    if (!ending && !touched) {  // refused before anything was sent to the machine
        desk.event("error", ending.error().message);
        desk.update([](Snapshot& s) { s.failed = true; });
        return desk.state(machine ? State::idle : State::offline, ending.error().message);
    }
    if (!ending) return fail(ending.error());
    show_machine();
    machine->keep(nullptr);
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
