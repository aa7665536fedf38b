#include "printing/host/control.hpp"

#include <algorithm>
#include <thread>

#include "base/core/digest.hpp"
#include "printing/host/control_private.hpp"

namespace pliant::host {
namespace {

constexpr double idle_listen_s = 0.05;

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

std::string_view state_text(const Snapshot& snapshot) {
    return state_text(snapshot.connecting ? State::connecting : snapshot.state);
}

std::string job_digest(std::string_view bytes) {
    Digest digest;
    digest.add(bytes.data(), bytes.size());
    return digest.text();
}

bool is_printing(State state) {
    return state == State::printing || state == State::pausing || state == State::paused || state == State::cancelling;
}

std::function<Status(const Snapshot&)> only_when(std::vector<State> states) {
    return [states = std::move(states)](const Snapshot& s) -> Status {
        if (std::ranges::find(states, s.state) != states.end()) return {};
        return failure("not possible now: the printer is {}", state_text(s));
    };
}

// Requests.

/// Checks the state and changes it to the next one atomically, so that only one of two concurrent requests succeeds.
/// Without `next` the state is unchanged. Until an emergency stop has been dealt with, nothing is allowed.
Status Control::Private::ask_for(std::optional<State> next, const std::function<Status(const Snapshot&)>& allowed,
                                 std::function<void()> task, bool for_machine) {
    const long stops = desk.stops();
    const bool stopping = for_machine && desk.stopped();
    const Status status = desk.ask(next, [&](const Snapshot& s) -> Status {
        if (stopping && s.state != State::offline && s.state != State::halted) return failure(after_emergency_stop);
        return allowed(s);
    });
    if (!status) return status;
    if (next) desk.event("state", std::string(state_text(desk.snapshot())));
    {
        const std::scoped_lock lock(mutex);
        tasks.push_back({std::move(task), for_machine, stops});
    }
    woken.notify_all();
    return {};
}

Control::Control(ControlSetup setup) : state_(std::make_unique<Private>(std::move(setup))) {
    state_->desk.update([&](Snapshot& s) {
        for (const machine::Axis axis : machine::all_axes)
            s.has_axis[static_cast<std::size_t>(axis)] = state_->setup.printer.axis(axis).present();
    });
}

Control::~Control() = default;

Status Control::connect() {
    return state_->ask_for(State::connecting, only_when({State::offline, State::halted}),
                           [this] { state_->do_connect(); });
}

Status Control::disconnect() {
    return state_->ask_for(State::offline, only_when({State::offline, State::idle, State::halted}),
                           [this] { state_->close(); });
}

Status Control::load(PrintJob job) {
    auto script = read_script(job.gcode);
    if (!script) return tl::unexpected(script.error());
    auto times = script_times(*script, state_->setup.printer);
    if (!times) return tl::unexpected(times.error());
    return state_->ask_for(
        std::nullopt, only_when({State::offline, State::idle, State::halted}),
        [this, job = std::move(job), script = std::move(*script), times = std::move(*times)]() mutable {
            state_->job = std::move(job);
            state_->script = std::move(script);
            state_->times = std::move(times);
            state_->desk.update([&](Snapshot& s) {
                s.job = state_->job->name;
                s.layers = state_->job->layers;
                s.layer = s.material = -1;
                s.image.clear();
                s.begun_s.reset();
                s.completion = s.seconds_done = s.lit_s = s.exposure_s = 0;
                s.seconds_left = s.seconds_planned = state_->times.back();
                s.finished = s.failed = false;
                s.exposures_s.assign(state_->job->materials.size(), 0);
            });
            state_->desk.event("log", "job " + state_->job->name);
            state_->look_at_journal();
        },
        false);
}

Status Control::start(const StartOptions& options) {
    return state_->ask_for(State::printing, only_when({State::offline, State::idle, State::halted}),
                           [this, options] { state_->do_start(options, false); });
}

Status Control::pause(PauseWhen when) {
    return state_->desk.wish([&](Wishes& w) { (when == PauseWhen::now ? w.pause_now : w.pause_after) = true; });
}

Status Control::resume() {
    const Snapshot now = snapshot();
    if (now.state != State::paused) return failure("not possible now: the print is not paused");
    if (now.door_open.value_or(false)) return failure("not possible now: the door is open; close it first");
    return state_->desk.wish([](Wishes& w) { w.resume = true; });
}

Status Control::cancel() {
    const Snapshot now = snapshot();
    if (!is_printing(now.state) && now.can_resume && now.state == State::idle) {
        return state_->ask_for(State::cancelling, only_when({State::idle}), [this] {
            state_->do_start({true, {}}, true);
        });
    }
    return state_->desk.wish([](Wishes& w) { w.cancel = true; });
}

Status Control::suspend() {
    return state_->desk.wish([](Wishes& w) { w.suspend = true; });
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
    return state_->desk.change_exposure(material, seconds);
}

Status Control::skip_layer(int layer) {
    const Snapshot now = snapshot();
    if (is_printing(now.state) && (layer <= now.layer || layer >= now.layers))
        return input_error("layer {}: only layers {} to {} have not begun", layer, now.layer + 1, now.layers - 1);
    return state_->desk.skip_layer(layer);
}

Status Control::reset_controller() {
    return state_->ask_for(State::connecting,
                           only_when({State::offline, State::connecting, State::idle, State::halted}), [this] {
                               Private& s = *state_;
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

bool Control::Private::run_next_task() {
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
    Private& s = *state_;
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
        if (status) status = s.keep_line_numbers();
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
    // In this order: a print that begins forgets earlier requests first, and looks at `quitting` then.
    state_->desk.suspend();
    state_->woken.notify_all();
}

}  // namespace pliant::host
