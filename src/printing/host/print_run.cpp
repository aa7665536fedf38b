#include "printing/host/print_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "printing/host/print_names.hpp"
#include "printing/host/resume_point.hpp"

namespace pliant::host {
namespace {

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
