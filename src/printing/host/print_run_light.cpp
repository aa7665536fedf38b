// The exposures of a print.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "printing/host/print_names.hpp"
#include "printing/host/print_run.hpp"

namespace pliant::host {
namespace {

constexpr double look_every_s = 0.01;   // interval of checks for requests during an exposure
constexpr double last_stretch_s = 0.5;  // of an exposure: resend requests on a noisy wire must not delay its end

}  // namespace

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
    if (Status status = announce(step, fact); !status) return status;
    const double start_s = clock_.now(), left_s = fact.planned_s - fact.lit_s;
    if (run_.setup.guard != nullptr) run_.setup.guard->lit(start_s);
    Status status = projector_.show_for(image, left_s);
    show_light(fact, entry, left_s);
    bool whole = false;
    if (status) status = burn(start_s + left_s, fact.lit_s, whole);
    const Darkness dark = go_dark(whole, start_s);
    fact.lit_s += dark.on_s;
    fact.complete = whole || is_enough(fact.lit_s, fact.planned_s);
    const Status noted = note_dark(fact, dark.on_s);
    if (!status) return status;
    return dark.status ? noted : dark.status;
}

/// What comes before the light: its record in the journal, and that the controller is still there. Without either, the
/// light is off afterwards.
Status PrintRun::announce(std::size_t step, LightFact& fact) {
    const double noted_s = clock_.now();
    if (run_.setup.guard != nullptr && run_.journal != nullptr) {
        const Status announced = run_.setup.guard->announced(run_.journal->next_number());
        if (!announced && !std::exchange(without_guard_, true)) run_.desk.event("error", announced.error().message);
    }
    if (Status status = note("light", {{"step", fmt::format("{}", step)},
                                       {"layer", fmt::format("{}", fact.layer)},
                                       {"material", fmt::format("{}", fact.material)},
                                       {"planned", fmt::format("{}", fact.planned_s)},
                                       {"at", fmt::format("{}", noted_s)}});
        !status) {
        run_.machine.light_off();
        return status;
    }
    fact.open_light = last_record_;
    run_.machine.stay_for(step);
    // The last check before the exposure: a controller that has restarted reports it, or does not answer any more.
    Status alive = run_.machine.rest();
    if (alive) alive = run_.machine.link().listen_for(0);
    if (alive) return {};
    run_.machine.light_off();
    (void)note("dark", {{"light", fmt::format("{}", fact.open_light)}, {"on", "0"}, {"done", "0"}, {"by", "host"}});
    return alive;
}

void PrintRun::show_light(const LightFact& fact, const std::string& entry, double left_s) {
    run_.desk.event("light", fmt::format("{}, {}, {:.3f} s", layer_text(fact.layer),
                                         material_text(run_.job.materials, fact.material), left_s));
    run_.desk.update([&](Snapshot& s) {
        s.lit = true;
        s.image = entry;
        s.lit_s = fact.lit_s;
        s.exposure_s = fact.planned_s;
    });
}

/// Ends the light that began at `start_s`. `whole`: the projector ends it by itself, and may have measured it.
PrintRun::Darkness PrintRun::go_dark(bool whole, double start_s) {
    Darkness dark;
    if (whole) {
        const auto measured = projector_.finish();
        dark.on_s = measured && *measured ? (*measured)->on_s : clock_.now() - start_s;
        if (!measured) dark.status = tl::unexpected(measured.error());
    } else {
        dark.status = projector_.black();
        dark.on_s = clock_.now() - start_s;
    }
    if (!dark.status) (void)projector_.black();
    run_.machine.light_off();
    if (run_.setup.guard != nullptr) run_.setup.guard->dark(clock_.now());
    return dark;
}

/// Everybody is told of a light that has ended after `on_s`.
Status PrintRun::note_dark(LightFact& fact, double on_s) {
    run_.desk.update([&](Snapshot& s) {
        s.lit = false;
        s.lit_s = fact.lit_s;
    });
    run_.desk.event("dark", fmt::format("{:.3f} s", on_s));
    const Status noted = note("dark", {{"light", fmt::format("{}", fact.open_light)},
                                       {"on", fmt::format("{}", on_s)},
                                       {"done", fact.complete ? "1" : "0"},
                                       {"by", "host"}});
    fact.open_light = 0;
    if (run_.setup.after_light) run_.setup.after_light({fact.layer, fact.material, fact.lit_s, fact.complete});
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

}  // namespace pliant::host
