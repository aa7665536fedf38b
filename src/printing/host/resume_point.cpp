#include "printing/host/resume_point.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "printing/host/machine.hpp"
#include "printing/host/print_names.hpp"
#include "printing/machine/follow.hpp"

namespace pliant::host {
namespace {

using machine::Interlock;

constexpr long most_introduction_lines = 100;  // sent by a session before it moves anything

/// Whether the controller is in the state that its last host left it in; that host had at most `commands` to send.
bool is_proven(const JournalFacts& facts, long last_line, std::size_t commands) {
    if (facts.stopped_short || last_line <= 0) return false;
    if (facts.go->program >= 0) {
        const long most = facts.go->line + static_cast<long>(commands) + most_questions;
        return last_line >= facts.go->line - 1 && last_line <= most;
    }
    if (last_line == facts.before_base) return true;
    return last_line >= facts.base && last_line < facts.base + most_introduction_lines;
}

/// The commands from there on, up to an exposure or the end.
std::vector<std::string> commands_from(const GoFact& go, const JournalFacts& facts, const Script& script) {
    std::vector<std::string> commands;
    if (go.program > 0) {
        const std::vector<std::string>& all = facts.programs.at(go.program);
        if (go.step < all.size()) commands.assign(all.begin() + static_cast<std::ptrdiff_t>(go.step), all.end());
    }
    for (std::size_t i = go.step; go.program == 0 && i < script.steps.size(); ++i) {
        const auto* command = std::get_if<std::string>(&script.steps[i]);
        if (command == nullptr) break;
        commands.push_back(*command);
    }
    if (go.most > 0 && static_cast<std::size_t>(go.most) < commands.size())
        commands.resize(static_cast<std::size_t>(go.most));
    return commands;
}

/// Checks the exposures in the journal against the machine's limits.
Status check_lights(const JournalFacts& facts, const machine::Printer& printer) {
    const auto allowed = [&](double seconds) { return seconds >= 0 && seconds <= printer.limits.exposure_s; };
    for (const auto& [step, light] : facts.lights) {
        if (!allowed(light.planned_s))
            return input_error("the journal asks for an exposure of {:g} s, {} allows up to {:g} s", light.planned_s,
                               printer.name, printer.limits.exposure_s);
    }
    for (const ChangeFact& change : facts.changes) {
        if (!allowed(change.seconds))
            return input_error("the journal changes an exposure to {:g} s, {} allows up to {:g} s", change.seconds,
                               printer.name, printer.limits.exposure_s);
    }
    return {};
}

/// One past the highest layer and material of the job, lit or not.
struct JobEnds {
    int layers = 0, materials = 0;
};

JobEnds ends_of(const Script& script, const PrintJob& job) {
    JobEnds ends{job.layers, static_cast<int>(job.materials.size())};
    for (std::size_t i = 0; i < script.steps.size(); ++i) {
        const machine::Expose* light = script.light(i);
        if (light == nullptr) continue;
        ends.layers = std::max(ends.layers, light->layer + 1);
        ends.materials = std::max(ends.materials, light->material + 1);
    }
    return ends;
}

Interlock without_position(const Interlock& state) {
    Interlock lost = state;
    lost.stopped_at(state.position());
    return lost;
}

}  // namespace

Status check_fits(const JournalFacts& facts, const Script& script, const PrintJob& job) {
    const auto wrong = [](long record, std::string_view kind, const std::string& what) {
        return input_error("journal record {} ({}): this job has no {}", record, kind, what);
    };
    const JobEnds ends = ends_of(script, job);
    for (const auto& [step, fact] : facts.lights) {
        const machine::Expose* light = step < script.steps.size() ? script.light(step) : nullptr;
        if (light == nullptr || light->layer != fact.layer || light->material != fact.material)
            return wrong(fact.record, "light",
                         fmt::format("exposure of layer {}, material {} at step {}", fact.layer, fact.material, step));
    }
    for (std::size_t i = 0; i < facts.skip_records.size(); ++i) {
        if (facts.skipped_layers[i] >= ends.layers)
            return wrong(facts.skip_records[i], "skip", fmt::format("layer {}", facts.skipped_layers[i]));
    }
    if (facts.hook && facts.hook->layer >= ends.layers)
        return wrong(facts.hook->record, "hook", fmt::format("layer {}", facts.hook->layer));
    for (const ChangeFact& change : facts.changes) {
        if (change.material >= ends.materials)
            return wrong(change.record, "exposure", fmt::format("material {}", change.material));
        if (change.from_layer > ends.layers)  // one past the last: it was changed too late to matter
            return wrong(change.record, "exposure", fmt::format("layer {}", change.from_layer));
    }
    if (facts.go && facts.go->program == 0 && facts.go->step > script.steps.size())
        return wrong(facts.go->record, "go", fmt::format("step {}", facts.go->step));
    return {};
}

Result<Interlock> last_known(const JournalFacts& facts, const machine::Printer& printer) {
    auto restored = Interlock::restored(printer, facts.go->state);
    if (!restored)
        return input_error("journal record {} ({}): {}", facts.go->record, facts.go->program < 0 ? "session" : "go",
                           restored.error().message);
    return restored;
}

Result<Standing> standing_of(const JournalFacts& facts, const Script& script, const machine::Printer& printer,
                             long last_line, const Assume& assume) {
    if (!facts.go) return Standing{Interlock(printer), false};
    const auto restored = last_known(facts, printer);
    if (!restored) return tl::unexpected(restored.error());
    const std::vector<std::string> commands = commands_from(*facts.go, facts, script);
    const bool proven = is_proven(facts, last_line, commands.size());
    if (!proven && last_line > 0 && !facts.stopped_short && !assume.vats_untouched) {
        return failure(
            "another program has used the controller since this print was interrupted; if every vat is "
            "where it was then, continue with --assume-vats-untouched");
    }
    const machine::Switch& magnet = printer.hooks.magnet.coil;
    const bool needs_power = !magnet.on.empty() && !machine::on_without_power(magnet);
    machine::Followed at{*restored};
    bool on_hooks = false;
    const long carried_out = proven ? last_line - facts.go->line + 1 : static_cast<long>(commands.size());
    for (std::size_t i = 0; i < commands.size() && static_cast<long>(i) < carried_out; ++i) {
        machine::Followed after = at;
        if (Status status = after.line(printer, commands[i]); !status) return tl::unexpected(status.error());
        // At the start of the next phase the journal would have another entry.
        if (i > 0 && !same_phase(printer, at.lock, after.lock)) break;
        const bool stroke =
            at.lock.in_hooks_stroke() && after.lock.in_hooks_stroke() && at.lock.position() != after.lock.position();
        const bool dragged =
            needs_power && at.lock.hooked_vat() && !same_phase(printer, at.lock, after.lock) &&
            at.lock.position()[machine::Axis::carriage] != after.lock.position()[machine::Axis::carriage];
        const bool reaches = at.lock.fork_out() || after.lock.fork_out();
        if (!proven && (stroke || dragged || reaches)) {
            on_hooks = true;
            break;
        }
        at = std::move(after);
    }
    if (proven) return Standing{at.lock, false};
    // The vat on the hooks is the same all along; other state does not matter, because the axes are homed again.
    return Standing{without_position(commands.empty() ? at.lock : *restored), on_hooks};
}

bool is_enough(double lit_s, double planned_s) {
    return planned_s - lit_s < std::min(0.02, 0.02 * planned_s);
}

Result<std::optional<OpenLight>> close_open_light(JournalFacts& facts, Guard* guard, const Assume& assume,
                                                  const std::vector<std::string>& materials) {
    for (auto& [step, fact] : facts.lights) {
        if (fact.open_light == 0) continue;
        OpenLight open{fact.open_light, 0, false, false};
        const auto seen_s = guard != nullptr ? guard->lit_s(fact.open_light) : std::nullopt;
        if (seen_s) {
            open.on_s = std::max(0.0, *seen_s);
        } else if (assume.lit_s) {
            constexpr double late = 1.05, late_s = 0.1;  // by which the light may have gone off after its time
            const double left_s = fact.planned_s - fact.lit_s;
            if (!(*assume.lit_s >= 0 && *assume.lit_s <= late * left_s + late_s))
                return input_error("--assume-lit {:g}: the exposure that was in progress lasts from 0 to {:g} s",
                                   *assume.lit_s, left_s);
            open.on_s = *assume.lit_s;
            open.assumed = true;
        } else {
            return failure(
                "{}, {}: an exposure of {:g} s was in progress when the host ended, and how long it "
                "lasted is not recorded; inspect the part and resume with --assume-lit SECONDS (0: none, {:g}: all of "
                "it)",
                layer_text(fact.layer), material_text(materials, fact.material), fact.planned_s - fact.lit_s,
                fact.planned_s - fact.lit_s);
        }
        fact.lit_s += open.on_s;
        fact.complete = open.complete = is_enough(fact.lit_s, fact.planned_s);
        fact.open_light = 0;
        return open;
    }
    return std::nullopt;
}

std::size_t next_light(const JournalFacts& facts, const Script& script) {
    const auto skipped = [&](int layer) {
        return std::find(facts.skipped_layers.begin(), facts.skipped_layers.end(), layer) != facts.skipped_layers.end();
    };
    for (std::size_t i = 0; i < script.steps.size(); ++i) {
        const machine::Expose* light = script.light(i);
        if (light == nullptr) continue;
        const auto fact = facts.lights.find(i);
        if (fact != facts.lights.end() ? fact->second.complete : skipped(light->layer)) continue;
        return i;
    }
    return script.steps.size();
}

Result<Recovery> recovery_of(const JournalFacts& facts, const Script& script, const machine::Printer& printer,
                             const Standing& standing) {
    if (Status status = check_lights(facts, printer); !status) return tl::unexpected(status.error());
    const std::size_t step = next_light(facts, script);
    Recovery recovery{standing.state, state_before(script, printer, step), step == script.steps.size(), -1,
                      standing.on_hooks};
    if (facts.last_light) {
        if (*facts.last_light >= script.steps.size() || script.light(*facts.last_light) == nullptr)
            return input_error("the journal names step {}, which is not an exposure of this job", *facts.last_light);
        const Interlock lit = state_before(script, printer, *facts.last_light + 1);
        recovery.last_lit_vat = lit.hooked_vat().value_or(-1);
        Interlock::State state = recovery.state.state();
        state.part_height_um = std::max(state.part_height_um, lit.part_height_um());
        auto taller = Interlock::restored(printer, state);
        if (!taller) return tl::unexpected(taller.error());
        recovery.state = std::move(*taller);
    }
    return recovery;
}

Status check_way_on(const JournalFacts& facts, const Script& script, const machine::Printer& printer,
                    const std::function<Result<std::string>(const Recovery&)>& resume) {
    if (!facts.was_reset && !facts.halted) return {};
    constexpr long after_reset = 0;  // last line of a controller that has restarted
    const auto standing = standing_of(facts, script, printer, after_reset, {});
    if (!standing) return tl::unexpected(standing.error());
    const auto recovery = recovery_of(facts, script, printer, *standing);
    if (!recovery) return tl::unexpected(recovery.error());
    const auto program = resume(*recovery);
    return program ? Status{} : tl::unexpected(program.error());
}

}  // namespace pliant::host
