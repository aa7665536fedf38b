#include "printing/plan/print_sequence.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "base/core/counted.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Printer;

/// Commands that must come before any motion.
void begin(Sequence& s, const Plan& plan) {
    const Printer& p = s.printer();
    s.comment(fmt::format("{} on {}: {}, {}, {}", plan.job, plan.printer,
                          counted(static_cast<std::size_t>(plan.layers), "layer"),
                          counted(static_cast<std::size_t>(plan.swaps), "swap"), clock_text(plan.seconds.total)));
    for (const VatUse& use : plan.vats) s.comment(fmt::format("slot {}: {}", use.slot, use.resin));
    if (!p.pump.off.empty()) s.command(machine::write_stop(p.pump.off));
    for (const machine::Switch& fan : p.fans) s.command(machine::write_stop(fan.off));
    for (const std::string& line : machine::preamble(p)) s.command(line);
    s.command(p.pump.off);
    for (const machine::Switch& fan : p.fans) s.command(fan.off);
    s.command(p.hooks.magnet.coil.off);
    s.command(p.wall.fork.off);
    s.dwell(p.wall.fork_s);
    for (const Axis axis : machine::homing_order(p)) s.home(axis);
    s.fence();
}

/// Sideways to shear the layer off, then up to peel it and let resin flow back.
void loosen(Sequence& s, int z_um) {
    const Printer& p = s.printer();
    s.dwell(p.projector.delay_s);
    if (p.has_carriage()) {
        s.move(Axis::carriage, p.carriage.print_um + p.carriage.shear_um, p.carriage.shear_speed_mm_s);
        s.move(Axis::carriage, p.carriage.print_um, p.carriage.shear_speed_mm_s);
    }
    s.move(Axis::platform, z_um + p.platform.lift_um, p.platform.lift_speed_mm_s);
}

/// Stores the vat. With a lift higher than the vat the platform came down for that: over a vat that stays it rises
/// slowly as far as it does after a layer, since that way is within the lift.
void put_away(Sequence& s, int slot, int part_um) {
    const Printer& p = s.printer();
    store_vat(s, slot);
    const int lifted_um = part_um + p.platform.lift_um;
    if (!p.has_carriage() && s.position()[Axis::platform] < lifted_um)
        s.move(Axis::platform, lifted_um, p.platform.lift_speed_mm_s);
}

/// The parts of a print, in order. `Steps` executes them or computes their duration.
template <class Steps>
void walk(const Plan& plan, const job::Manifest& job, const Printer& p, Steps& steps) {
    std::optional<int> loaded;
    int part_um = 0;
    for (int i = 0; i < plan.layers; ++i) {
        const int z_um = job.layers[static_cast<std::size_t>(i)].z_um;
        for (const int vat : plan.order[static_cast<std::size_t>(i)]) {
            if (!loaded)
                steps.load(p.slot_of(vat));
            else if (*loaded != vat)
                steps.swap(p.slot_of(*loaded), p.slot_of(vat), part_um);
            loaded = vat;
            part_um = z_um;
            steps.print(i, vat);
        }
        steps.layer_done();
    }
    if (loaded) steps.store(p.slot_of(*loaded), part_um);
}

/// Whether image k of a layer is printed from `vat`, and its exposure.
double light_s(const Plan& plan, const job::Manifest& job, int layer, std::size_t k, int vat) {
    const auto index = static_cast<std::size_t>(layer);
    if (plan.vat_of_image[index][k] != vat) return 0;
    return job::exposure_s(job, index, k);
}

/// Writes the commands.
struct Writing {
    Sequence& s;
    const Plan& plan;
    const job::Manifest& job;
    JobTimeline* timeline = nullptr;

    void load(int slot) const {
        s.comment(fmt::format("load slot {}", slot));
        load_vat(s, slot);
    }
    void swap(int from, int to, int part_um) const {
        s.comment(fmt::format("swap slot {} for {}", from, to));
        s.move(Axis::platform, s.printer().push_um(part_um));
        swap_vat(s, from, to);
    }
    void print(int index, int vat) const {
        const job::Layer& layer = job.layers[static_cast<std::size_t>(index)];
        const int slot = s.printer().slot_of(vat);
        const double begin_s = s.seconds().total;
        s.comment(fmt::format("layer {} slot {}", index, slot));
        approach(s, layer.z_um);
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const double seconds = light_s(plan, job, index, k, vat);
            if (seconds > 0) s.expose({index, layer.images[k].material, seconds, layer.images[k].file});
        }
        loosen(s, layer.z_um);
        if (timeline != nullptr) timeline->visits.push_back({index, slot, begin_s, s.seconds().total});
    }
    void layer_done() const {}
    void store(int slot, int part_um) const {
        s.comment(fmt::format("store slot {}", slot));
        s.move(Axis::platform, s.printer().push_um(part_um));
        put_away(s, slot, part_um);
    }
};

/// Computes durations, and caches them.
class Reckoning {
public:
    Reckoning(const Sequence& homed, const Plan& plan, const job::Manifest& job)
        : p_(homed.printer()), plan_(plan), job_(job), at_(homed.position()), layer_start_(homed.seconds()) {
        times_.all = homed.seconds();
    }

    void load(int slot) {
        take([&](Sequence& s) { load_vat(s, slot); });
    }
    void swap(int from, int to, int part_um) {
        rise_over(part_um);
        Known& known = swaps_[{from, to, at_[Axis::table]}];
        if (!known.valid) {
            Sequence s = muted();
            swap_vat(s, from, to);
            known = {true, s.seconds(), s.position()};
            known.end[Axis::platform] -= at_[Axis::platform];
        }
        times_.all += known.seconds;
        const int platform_um = at_[Axis::platform];
        at_ = known.end;
        at_[Axis::platform] += platform_um;
    }
    void print(int index, int vat) {
        const job::Layer& layer = job_.layers[static_cast<std::size_t>(index)];
        Known& known = prints_[at_[Axis::platform] - layer.z_um];
        if (!known.valid) {
            Sequence s = muted();
            approach(s, layer.z_um);
            loosen(s, layer.z_um);
            known = {true, s.seconds(), s.position()};
        }
        times_.all += known.seconds;
        at_[Axis::platform] = layer.z_um + p_.platform.lift_um;
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const double seconds = light_s(plan_, job_, index, k, vat);
            times_.all.expose += seconds;
            times_.all.total += seconds;
        }
    }
    void layer_done() {
        times_.layers.push_back(times_.all - layer_start_);
        layer_start_ = times_.all;
    }
    void store(int slot, int part_um) {
        rise_over(part_um);
        take([&](Sequence& s) { put_away(s, slot, part_um); });
    }
    PrintTimes finish() {
        take([&](Sequence& s) { s.move(Axis::platform, p_.axis(Axis::platform).home_um()); });
        return std::move(times_);
    }

private:
    struct Known {
        bool valid = false;
        Seconds seconds;
        machine::Position end;  ///< for a swap, the platform's entry is the height it rises by
    };

    Sequence muted() const {
        Sequence s(p_);
        s.mute();
        s.stand_at(at_);
        return s;
    }
    template <class Work>
    void take(Work work) {
        Sequence s = muted();
        work(s);
        times_.all += s.seconds();
        at_ = s.position();
    }
    void rise_over(int part_um) {
        const int push_um = p_.push_um(part_um);
        Known& known = rises_[push_um - at_[Axis::platform]];
        if (!known.valid) {
            Sequence s = muted();
            s.move(Axis::platform, push_um);
            known = {true, s.seconds(), s.position()};
        }
        times_.all += known.seconds;
        at_[Axis::platform] = push_um;
    }

    const Printer& p_;
    const Plan& plan_;
    const job::Manifest& job_;
    machine::Position at_;
    Seconds layer_start_;
    PrintTimes times_;
    std::map<std::tuple<int, int, int>, Known> swaps_;  ///< by slots and the table's position
    std::map<int, Known> prints_;                       ///< by the platform's height above the layer
    std::map<int, Known> rises_;                        ///< by distance
};

}  // namespace

Sequence print_sequence(const Plan& plan, const job::Manifest& job, const Printer& printer, JobTimeline* timeline) {
    Sequence s(printer);
    if (timeline != nullptr) {
        s.mute();
        s.record(&timeline->stretches);
    }
    begin(s, plan);
    Writing writing{s, plan, job, timeline};
    walk(plan, job, printer, writing);
    s.comment("the end: platform up, everything off");
    s.move(Axis::platform, printer.axis(Axis::platform).home_um());
    s.fence();
    s.record(nullptr);
    return s;
}

PrintTimes print_times(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    Sequence s(printer);
    s.mute();
    begin(s, plan);
    Reckoning reckoning(s, plan, job);
    walk(plan, job, printer, reckoning);
    return reckoning.finish();
}

}  // namespace pliant::plan
