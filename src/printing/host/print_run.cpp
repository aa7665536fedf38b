#include "printing/host/print_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "printing/host/print_names.hpp"
#include "printing/host/resume_point.hpp"

namespace pliant::host {
namespace {

constexpr double look_every_s = 0.01;   // interval of checks for requests during an exposure
constexpr double pause_look_s = 0.05;   // interval of checks for requests during a pause
constexpr double last_stretch_s = 0.5;  // of an exposure: resend requests on a noisy wire must not delay its end

std::string number(double value) {
    return fmt::format("{}", value);
}

/// Ends a run early without an error of its own.
tl::unexpected<Error> wish_to_end() {
    return cancelled();
}

/// Steps at whose end everything sent has been done: exposures, and homing.
bool is_waited_for(const std::variant<std::string, machine::Expose>& step) {
    const auto* command = std::get_if<std::string>(&step);
    return command == nullptr || command->compare(0, 3, "G28") == 0;
}

}  // namespace

using machine::Axis;

PrintRun::PrintRun(const RunSetup& run, JournalFacts facts)
    : run_(run),
      facts_(std::move(facts)),
      printer_(run.setup.printer),
      projector_(run.setup.projector),
      clock_(run.setup.clock),
      begin_s_(run.setup.clock.now()) {
    run_.desk.update([&](Snapshot& s) {
        s.begun_s = begin_s_;
        s.exposures_s.assign(run_.job.materials.size(), 0);
        for (const ChangeFact& change : facts_.changes) {
            if (change.material >= 0 && static_cast<std::size_t>(change.material) < s.exposures_s.size())
                s.exposures_s[static_cast<std::size_t>(change.material)] = change.seconds;
        }
    });
    const std::size_t next = next_light(facts_, run_.script);
    reach(next);
    recall_layer(next);
    recall_refill(next_layer(next));
    run_.machine.link().set_watch([this] {
        show_progress();
        return run_.desk.watch();
    });
}

PrintRun::~PrintRun() {
    run_.machine.link().set_watch([&desk = run_.desk] { return desk.watch(); });
    (void)projector_.black();
}

Result<Ending> PrintRun::print() {
    run_.desk.state(State::printing);
    if (Status status = projector_.black(); !status) return tl::unexpected(status.error());
    return steps_from(0);
}

Result<Ending> PrintRun::resume(const Recovery& recovery) {
    run_.desk.state(State::printing, "resuming: homing, fetching the vat");
    if (Status status = projector_.black(); !status) return tl::unexpected(status.error());
    if (has_refilled_) {
        if (Status status = note("resume", {}); !status) return tl::unexpected(status.error());
    }
    const auto program = run_.setup.programs.resume(recovery);
    if (!program) return tl::unexpected(program.error());
    const Status there_again = run_.machine.run(*program, [this] { return on_the_way(); });
    if (!there_again && there_again.error().cause == Cause::cancelled) return park_as_wished();
    if (!there_again) return tl::unexpected(there_again.error());
    if (recovery.finished) {
        if (Status status = note("end", {}); !status) return tl::unexpected(status.error());
        return Ending::finished;
    }
    const bool there = run_.machine.state().position()[Axis::platform] == recovery.target.position()[Axis::platform] &&
                       run_.machine.state().hooked_vat() == recovery.target.hooked_vat();
    if (!there) return failure("the program for resuming does not end where the next exposure begins");
    run_.desk.update([](Snapshot& s) { s.message.clear(); });  // it has resumed
    return steps_from(next_light(facts_, run_.script));
}

/// Before each command that brings the print back to where it was: the hook that the last layer has not had, and the
/// wish to end it, which can be granted once all axes are homed. A pause waits for the vat.
Status PrintRun::on_the_way() {
    const machine::Interlock& state = run_.machine.state();
    const Wishes wishes = run_.desk.wishes();
    const bool ends = wishes.cancel || wishes.suspend, pauses = wishes.pause_now || wishes.pause_after;
    if (ends && state.all_homed()) return wish_to_end();
    if (ends && !std::exchange(told_of_end_, true)) run_.desk.event("log", "the print ends when the axes are homed");
    if (pauses && !std::exchange(told_of_pause_, true))
        run_.desk.event("log", "the print pauses when the vat is in its place");
    const bool is_up = state.homed(Axis::platform) && state.position()[Axis::platform] > state.part_height_um();
    return is_up && owes_hook_ ? call_hook() : Status{};
}

Result<Ending> PrintRun::abandon(const Recovery& recovery) {
    Recovery end = recovery;
    end.finished = true;
    const auto program = run_.setup.programs.resume(end);
    if (!program) return tl::unexpected(program.error());
    if (Status status = run_.machine.run(*program); !status) return tl::unexpected(status.error());
    if (Status status = note("cancel", {}); !status) return tl::unexpected(status.error());
    return Ending::cancelled;
}

/// What the print had come to before it was interrupted: a layer that has begun gets no more changes, and nothing is
/// asked for before it again. `next`: step of the next exposure.
void PrintRun::recall_layer(std::size_t next) {
    if (!facts_.last_light) return;
    const LightFact& last = facts_.lights.at(*facts_.last_light);
    layer_ = last.layer;
    const bool is_whole = next_layer(next) != layer_;
    const bool is_hooked = is_whole && facts_.hook && facts_.hook->layer >= layer_;
    hooked_layer_ = is_hooked ? layer_ : layer_ - 1;
    owes_hook_ = run_.setup.after_layer && is_whole && !is_hooked;
    run_.desk.update([&](Snapshot& s) {
        s.layer = last.layer;
        s.material = last.material;
    });
}

/// What was asked for before the next exposure, which is of this layer, has been done since.
void PrintRun::recall_refill(int layer) {
    for (const Refill& refill : run_.job.refills) {
        if (refill.layer != layer || std::ranges::find(facts_.asked, refill.text) == facts_.asked.end()) continue;
        refilled_layer_ = layer;
        has_refilled_ = true;
    }
}

/// The machine has done everything before step `step`.
void PrintRun::reach(std::size_t step) {
    reached_s_ = sent_s_ = run_.times[step];
    reached_at_s_ = clock_.now();
}

Result<Ending> PrintRun::steps_from(std::size_t first) {
    reach(first);
    for (std::size_t i = first; i < run_.script.steps.size(); ++i) {
        sent_s_ = run_.times[i + 1];
        show_progress();
        Status status = serve_wishes(i);
        if (status) {
            const auto* command = std::get_if<std::string>(&run_.script.steps[i]);
            status = command != nullptr ? run_.machine.send(0, i, *command) : expose(i);
        }
        if (!status && status.error().cause == Cause::cancelled) return park_as_wished();
        if (!status) return tl::unexpected(status.error());
        if (is_waited_for(run_.script.steps[i])) reach(i + 1);
    }
    if (Status status = run_.machine.rest(); !status) return tl::unexpected(status.error());
    if (Status status = note("end", {}); !status) return tl::unexpected(status.error());
    return Ending::finished;
}

// Exposures.

/// A changed exposure is that of a normal layer. Bottom layers, transition layers and layers of other heights keep
/// their share of it: with the time of a normal layer they would not hold the part.
double PrintRun::exposure_s(const machine::Expose& light) const {
    const auto index = static_cast<std::size_t>(light.material);
    const double normal_s = index < run_.job.exposures_s.size() ? run_.job.exposures_s[index] : light.seconds;
    double seconds = light.seconds;
    for (const ChangeFact& change : facts_.changes) {
        if (change.material == light.material && light.layer >= change.from_layer)
            seconds = light.seconds / normal_s * change.seconds;
    }
    return std::min(seconds, printer_.limits.exposure_s);
}

bool PrintRun::skipped(int layer) const {
    return std::find(facts_.skipped_layers.begin(), facts_.skipped_layers.end(), layer) != facts_.skipped_layers.end();
}

Status PrintRun::expose(std::size_t step) {
    const machine::Expose& light = *run_.script.light(step);
    if (light.layer != told_layer_) run_.desk.event("layer", fmt::format("{}", light.layer + 1));
    layer_ = told_layer_ = light.layer;
    run_.desk.update([&](Snapshot& s) {
        s.layer = light.layer;
        s.material = light.material;
    });
    const auto [found, is_new] = facts_.lights.try_emplace(step);
    LightFact& fact = found->second;
    if (is_new && skipped(light.layer)) {
        facts_.lights.erase(found);
        run_.desk.event("log", fmt::format("the exposure of {} is skipped", layer_text(light.layer)));
        return {};
    }
    if (is_new) fact = {light.layer, light.material, exposure_s(light), 0, false, 0, 0};
    // The image is decoded while the machine moves.
    const auto image = fact.complete ? Result<job::Image>{} : run_.job.images(light.layer, light.material);
    if (!image) return tl::unexpected(image.error());
    while (!fact.complete) {
        if (Status status = run_.machine.rest_in_place(); !status) return status;
        if (Status status = serve_wishes(step); !status) return status;
        if (Status status = shine(step, *image, light.image, fact); !status) return status;
    }
    return {};
}

/// One piece of an exposure: all of its remaining time, unless it is interrupted.
Status PrintRun::shine(std::size_t step, const job::Image& image, const std::string& entry, LightFact& fact) {
    if (Status status = run_.machine.light_on(); !status) return status;
    const double left_s = fact.planned_s - fact.lit_s;
    const double noted_s = clock_.now();
    if (run_.setup.guard != nullptr && run_.journal != nullptr) {
        const Status announced = run_.setup.guard->announced(run_.journal->next_number());
        if (!announced && !std::exchange(without_guard_, true)) run_.desk.event("error", announced.error().message);
    }
    if (Status status = note("light", {{"step", fmt::format("{}", step)},
                                       {"layer", fmt::format("{}", fact.layer)},
                                       {"material", fmt::format("{}", fact.material)},
                                       {"planned", number(fact.planned_s)},
                                       {"at", number(noted_s)}});
        !status) {
        run_.machine.light_off();
        return status;
    }
    fact.open_light = last_record_;
    run_.machine.stay_for(step);
    // The last check before the exposure: a controller that has restarted reports it, or does not answer any more.
    Status alive = run_.machine.rest();
    if (alive) alive = run_.machine.link().listen_for(0);
    if (!alive) {
        run_.machine.light_off();
        (void)note("dark", {{"light", fmt::format("{}", fact.open_light)}, {"on", "0"}, {"done", "0"}, {"by", "host"}});
        return alive;
    }
    const double start_s = clock_.now();
    if (run_.setup.guard != nullptr) run_.setup.guard->lit(start_s);
    Status status = projector_.show_for(image, left_s);
    run_.desk.event("light", fmt::format("{}, {}, {:.3f} s", layer_text(fact.layer),
                                         material_text(run_.job.materials, fact.material), left_s));
    run_.desk.update([&](Snapshot& s) {
        s.lit = true;
        s.image = entry;
        s.lit_s = fact.lit_s;
        s.exposure_s = fact.planned_s;
    });
    bool whole = false;
    if (status) status = burn(start_s + left_s, fact.lit_s, whole);
    double on_s = 0;
    Status dark;
    if (whole) {
        const auto measured = projector_.finish();
        on_s = measured && *measured ? (*measured)->on_s : clock_.now() - start_s;
        if (!measured) dark = tl::unexpected(measured.error());
    } else {
        dark = projector_.black();
        on_s = clock_.now() - start_s;
    }
    if (!dark) (void)projector_.black();
    run_.machine.light_off();
    if (run_.setup.guard != nullptr) run_.setup.guard->dark(clock_.now());
    fact.lit_s += on_s;
    run_.desk.update([&](Snapshot& s) {
        s.lit = false;
        s.lit_s = fact.lit_s;
    });
    fact.complete = whole || is_enough(fact.lit_s, fact.planned_s);
    run_.desk.event("dark", fmt::format("{:.3f} s", on_s));
    const Status noted = note("dark", {{"light", fmt::format("{}", fact.open_light)},
                                       {"on", number(on_s)},
                                       {"done", fact.complete ? "1" : "0"},
                                       {"by", "host"}});
    fact.open_light = 0;
    if (run_.setup.after_light) run_.setup.after_light({fact.layer, fact.material, fact.lit_s, fact.complete});
    if (!status) return status;
    if (!dark) return dark;
    return noted;
}

/// Waits while listening to the wire. `before_s`: what has been exposed already; `whole`: whether the exposure reached
/// its end.
Status PrintRun::burn(double until_s, double before_s, bool& whole) {
    const double start_s = clock_.now();
    for (double now_s = start_s; now_s < until_s; now_s = clock_.now()) {
        const Wishes wishes = run_.desk.wishes();
        if (wishes.pause_now || wishes.cancel || wishes.suspend || door_is_open()) return {};
        run_.desk.update([&](Snapshot& s) { s.lit_s = before_s + now_s - start_s; });
        if (until_s - now_s > last_stretch_s) {
            if (Status status = run_.machine.ask_for_door(); !status) return status;
        }
        const double next_s = std::min(look_every_s, until_s - now_s);
        if (Status status = run_.machine.link().listen_for(next_s, until_s - now_s > last_stretch_s); !status)
            return status;
    }
    whole = true;
    return {};
}

// Requests.

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
                                              {"seconds", number(change.seconds)},
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

// The end.

Result<Ending> PrintRun::park_as_wished() {
    return park(run_.desk.wishes().cancel ? Ending::cancelled : Ending::suspended);
}

Result<Ending> PrintRun::park(Ending ending) {
    (void)projector_.black();
    run_.desk.state(State::cancelling);
    if (Status status = run_.machine.rest(); !status) return tl::unexpected(status.error());
    const auto may_park = wait_to_park(ending);
    if (!may_park) return may_park;
    if (*may_park == Ending::left) {
        if (Status status = note("suspend", {{"parked", "0"}}); !status) return tl::unexpected(status.error());
        return Ending::left;
    }
    const auto program = run_.setup.programs.cancel(run_.machine.state());
    if (!program) return tl::unexpected(program.error());
    if (Status status = run_.machine.run(*program); !status) return tl::unexpected(status.error());
    if (Status status = note(ending == Ending::cancelled ? "cancel" : "suspend", {}); !status)
        return tl::unexpected(status.error());
    return ending;
}

void PrintRun::make_safe(const Error& error) {
    (void)projector_.black();
    Link& link = run_.machine.link();
    const bool emergency = run_.desk.stopped();
    const bool quick = emergency || !(link.was_reset() || link.wire_failed() || journal_failed_);
    const bool halted = emergency || link.has_halted();
    (void)note("stop", {{"quick", quick ? "1" : "0"},
                        {"halted", halted ? "1" : "0"},
                        {"reset", link.was_reset() ? "1" : "0"},
                        {"why", error.message}});
    if (halted || link.was_reset() || link.wire_failed()) return;
    if (!journal_failed_) return link.stop(run_.script.stop_commands);
    // The journal cannot be written: what is in progress ends, and nothing else moves.
    for (const std::string& command : run_.script.stop_commands) (void)link.send(command);
    (void)link.fence();
}

Status PrintRun::note(std::string_view kind, const JournalValues& values) {
    if (run_.journal == nullptr) return {};
    const auto record = run_.journal->append(kind, values);
    journal_failed_ = journal_failed_ || !record;
    if (!record) return tl::unexpected(record.error());
    last_record_ = *record;
    return {};
}

/// Time is counted while the machine is homed or a vat is brought, but not beyond what has been sent.
void PrintRun::show_progress() {
    const double all_s = run_.times.back();
    const double now_s = clock_.now();
    if (!waits_) done_s_ = std::clamp(reached_s_ + now_s - reached_at_s_, reached_s_, std::max(reached_s_, sent_s_));
    const machine::Interlock& state = run_.machine.state();
    const auto vat = state.hooked_vat();
    run_.desk.update([&](Snapshot& s) {
        s.completion = all_s > 0 ? done_s_ / all_s : 1;
        s.seconds_left = all_s - done_s_;
        s.seconds_done = now_s - begin_s_;
        s.position = state.position();
        for (const Axis axis : machine::all_axes) s.homed[static_cast<std::size_t>(axis)] = state.homed(axis);
        s.slot = vat ? printer_.slot_of(*vat) : 0;
        s.pump = state.pump_runs();
        s.lines_sent = run_.machine.link().lines_sent();
        s.resends = run_.machine.link().resends();
    });
}

}  // namespace pliant::host
