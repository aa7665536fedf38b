// What is asked of a print while it runs: pauses, changes, refills, its end, and the open door.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "printing/host/print_names.hpp"
#include "printing/host/print_run.hpp"

namespace pliant::host {

using machine::Axis;

namespace {

constexpr double pause_look_s = 0.05;  // interval of checks for requests during a pause

}  // namespace

bool PrintRun::wants_to_end() const {
    const Wishes wishes = run_.desk.wishes();
    return wishes.cancel || wishes.suspend;
}

/// Between two layers or vats: pump off, the vat under the platform, the part detached from its floor.
bool PrintRun::at_safe_point() const {
    const machine::Interlock& state = run_.machine.state();
    if (state.pump_runs()) return false;
    const bool tower = printer_.has_carriage();
    if (tower && state.position()[Axis::carriage] != printer_.carriage.print_um) return false;
    return state.position()[Axis::platform] > state.part_height_um();
}

int PrintRun::next_layer(std::size_t step) const {
    for (std::size_t i = step; i < run_.script.steps.size(); ++i) {
        if (const machine::Expose* light = run_.script.light(i)) return light->layer;
    }
    return -1;
}

Status PrintRun::serve_wishes(std::size_t step) {
    if (Status status = run_.desk.watch(); !status) return status;
    if (Status status = keep_changes(); !status) return status;
    const Wishes wishes = run_.desk.wishes();
    if (wishes.cancel || wishes.suspend) return wish_to_end();
    show_switches();
    if (door_is_open()) return hold_for_door();
    if (wishes.pause_now || (wishes.pause_after && at_safe_point())) return pause("");
    return at_safe_point() ? between_layers(step) : Status{};
}

/// Calls the hook for the layer before, and requests resin for the next one.
Status PrintRun::between_layers(std::size_t step) {
    const bool hook = run_.setup.after_layer && layer_ > hooked_layer_;
    if (!hook && run_.job.refills.empty()) return {};
    const int next = next_layer(step);
    if (hook && next != layer_) {
        if (Status status = call_hook(); !status) return status;
    }
    for (const Refill& refill : run_.job.refills) {
        if (refill.layer != next || refilled_layer_ >= next || next == layer_) continue;
        refilled_layer_ = next;
        return pause(refill.text);
    }
    return {};
}

/// The journal knows of it afterwards: if this program dies meanwhile, it is called again rather than never.
Status PrintRun::call_hook() {
    owes_hook_ = false;
    hooked_layer_ = layer_;
    if (Status status = run_.machine.rest(); !status) return status;
    run_.setup.after_layer(layer_);
    return note("hook", {{"layer", fmt::format("{}", layer_)}});
}

Status PrintRun::keep_changes() {
    for (ChangeFact change : run_.desk.take_changes()) {
        change.from_layer = layer_ + 1;
        if (Status status = note("exposure", {{"material", fmt::format("{}", change.material)},
                                              {"seconds", fmt::format("{}", change.seconds)},
                                              {"from", fmt::format("{}", change.from_layer)}});
            !status)
            return status;
        facts_.changes.push_back(change);
        run_.desk.update([&](Snapshot& s) {
            s.exposures_s.resize(run_.job.materials.size());
            s.exposures_s[static_cast<std::size_t>(change.material)] = change.seconds;
        });
        run_.desk.event("log", fmt::format("from {} on, {} is exposed for {:g} s; layers with another exposure keep "
                                           "their share",
                                           layer_text(change.from_layer),
                                           material_text(run_.job.materials, change.material), change.seconds));
    }
    for (const int layer : run_.desk.take_skips()) {
        if (layer <= layer_) {  // it has begun since the request was accepted
            run_.desk.event("log", fmt::format("{} has begun, it is not skipped", layer_text(layer)));
            continue;
        }
        if (Status status = note("skip", {{"layer", fmt::format("{}", layer)}}); !status) return status;
        facts_.skipped_layers.push_back(layer);
        run_.desk.event("log", fmt::format("{} will be skipped", layer_text(layer)));
    }
    return {};
}

Status PrintRun::pause(const std::string& prompt) {
    return halt(prompt, run_.setup.programs.pause_begin, run_.setup.programs.pause_end);
}

/// The door was opened: nothing moves until it is shut and the print is resumed.
Status PrintRun::hold_for_door() {
    if (Status status = note("door", {{"open", "1"}}); !status) return status;
    run_.desk.event("log", "the door is open");
    Status status =
        halt("the door is open: close it, then resume", run_.setup.programs.hold_begin, run_.setup.programs.hold_end);
    return status ? note("door", {{"open", "0"}}) : status;
}

/// Stops the machine with `begin`, waits for resume(), and returns with `end`.
Status PrintRun::halt(const std::string& prompt, const Programs::Make& make_begin, const Programs::Make& make_end) {
    run_.desk.state(State::pausing);
    if (Status status = run_.machine.rest(); !status) return status;
    const machine::Interlock before = run_.machine.state();
    const auto begin = make_begin(before);
    if (!begin) return tl::unexpected(begin.error());
    if (Status status = run_.machine.run(*begin); !status) return status;
    const JournalValues asked = prompt.empty() ? JournalValues{} : JournalValues{{"asked", prompt}};
    if (Status status = note("pause", asked); !status) return status;
    (void)run_.desk.wish([](Wishes& w) { w.pause_after = w.pause_now = w.resume = false; });
    run_.desk.update([&](Snapshot& s) { s.prompt = prompt; });
    if (!prompt.empty()) run_.desk.event("prompt", prompt);
    run_.desk.state(State::paused, prompt);
    Status status = wait_for_resume();
    run_.desk.update([](Snapshot& s) { s.prompt.clear(); });
    if (!status) return status;
    if (status = note("resume", {}); !status) return status;
    const auto end = make_end(before);
    if (!end) return tl::unexpected(end.error());
    return run_.machine.run(*end);
}

Status PrintRun::wait_for_resume() {
    waits_ = true;
    for (;;) {
        if (Status status = run_.desk.watch(); !status) return status;
        if (wants_to_end()) return wish_to_end();
        const bool resume = run_.desk.take_resume();  // ignored while the door is open
        if (resume && !door_is_open()) break;
        if (Status status = listen_at_door(pause_look_s); !status) return status;
    }
    waits_ = false;
    reached_s_ = done_s_;
    reached_at_s_ = clock_.now();
    run_.desk.state(State::printing);
    return {};
}

// The door.

Status PrintRun::listen_at_door(double seconds) {
    if (Status status = run_.machine.ask_for_door(); !status) return status;
    Status status = run_.machine.link().listen_for(seconds);
    show_switches();
    return status;
}

void PrintRun::show_switches() {
    run_.desk.update([&](Snapshot& s) {
        s.door_open = run_.machine.door_open();
        s.switches = run_.machine.limit_switches();
    });
}

/// No parking while the door is open. A suspended print stays as it is; a cancelled one waits, unless the host must
/// end.
Result<Ending> PrintRun::wait_to_park(Ending ending) {
    if (!door_is_open()) return ending;
    if (ending == Ending::cancelled)
        run_.desk.state(State::cancelling, "the door is open: close it, then the machine parks");
    while (door_is_open()) {
        if (Status status = run_.desk.watch(); !status) return tl::unexpected(status.error());
        if (run_.desk.wishes().suspend) return Ending::left;
        if (Status status = listen_at_door(pause_look_s); !status) return tl::unexpected(status.error());
    }
    return ending;
}

}  // namespace pliant::host
