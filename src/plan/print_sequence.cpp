#include "plan/print_sequence.hpp"

#include <fmt/format.h>

#include <optional>

#include "plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Printer;

/// What the machine must know before anything moves.
void begin(Sequence& s, const Plan& plan) {
    const Printer& p = s.printer();
    s.comment(fmt::format("{} on {}: {} layers, {} swaps, {}", plan.job, plan.printer, plan.layers, plan.swaps,
                          clock_text(plan.seconds.total)));
    for (const VatUse& use : plan.vats) s.comment(fmt::format("slot {}: {}", use.slot, use.resin));
    for (const machine::Switch& device : {p.pump, p.fans}) {
        if (!device.off.empty()) s.command(machine::write_stop(device.off));
    }
    s.command("G90");
    s.command("M84 S0");  // idle motors would let platform and tower sink
    s.command(p.pump.off);
    s.command(p.fans.off);
    for (const Axis axis : {Axis::platform, Axis::carriage, Axis::tower}) s.home(axis);
    s.fence();
}

/// Down into the resin: fast, then slowly for the last stretch, and a rest.
void approach(Sequence& s, int z_um) {
    const machine::Platform& platform = s.printer().platform;
    if (s.position()[Axis::platform] > z_um + platform.approach_um) s.move(Axis::platform, z_um + platform.approach_um);
    s.move(Axis::platform, z_um, platform.approach_speed_mm_s);
    s.dwell(platform.settle_s);
}

/// Sideways to loosen the layer, then up to peel it and let resin flow back.
void loosen(Sequence& s, int z_um) {
    const Printer& p = s.printer();
    s.dwell(p.projector.delay_s);
    s.move(Axis::carriage, p.carriage.print_um + p.carriage.shear_um, p.carriage.shear_speed_mm_s);
    s.move(Axis::carriage, p.carriage.print_um, p.carriage.shear_speed_mm_s);
    s.move(Axis::platform, z_um + p.platform.lift_um, p.platform.lift_speed_mm_s);
}

double exposure_s(const job::Manifest& job, int layer, int material) {
    const job::Material& m = job.materials[static_cast<std::size_t>(material)];
    return layer < job.bottom_layers ? m.bottom_exposure_s : m.exposure_s;
}

/// Everything that one vat prints on one layer.
void print_from_vat(Sequence& s, const Plan& plan, const job::Manifest& job, int index, int vat) {
    const job::Layer& layer = job.layers[static_cast<std::size_t>(index)];
    approach(s, layer.z_um);
    for (const job::LayerImage& image : layer.images) {
        if (plan.vat_of_material[static_cast<std::size_t>(image.material)] != vat) continue;
        s.expose({index, image.material, exposure_s(job, index, image.material), image.file});
    }
    loosen(s, layer.z_um);
}

void print_layers(Sequence& s, const Plan& plan, const job::Manifest& job) {
    const Printer& p = s.printer();
    const auto slot = [&](int vat) { return p.vats[static_cast<std::size_t>(vat)].slot; };
    std::optional<int> loaded;
    int part_um = 0;
    for (int i = 0; i < plan.layers; ++i) {
        for (const int vat : plan.order[static_cast<std::size_t>(i)]) {
            if (!loaded) {
                s.comment(fmt::format("load slot {}", slot(vat)));
                load_vat(s, slot(vat));
            } else if (*loaded != vat) {
                s.comment(fmt::format("swap slot {} for {}", slot(*loaded), slot(vat)));
                s.move(Axis::platform, p.clear_um(part_um));
                swap_vat(s, slot(*loaded), slot(vat));
            }
            loaded = vat;
            part_um = job.layers[static_cast<std::size_t>(i)].z_um;
            s.comment(fmt::format("layer {} slot {}", i, slot(vat)));
            print_from_vat(s, plan, job, i, vat);
        }
    }
    if (!loaded) return;
    s.comment(fmt::format("store slot {}", slot(*loaded)));
    s.move(Axis::platform, p.clear_um(part_um));
    store_vat(s, slot(*loaded));
}

}  // namespace

Sequence print_sequence(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    Sequence s(printer);
    begin(s, plan);
    print_layers(s, plan, job);
    s.move(Axis::platform, printer.axis(Axis::platform).home_um());
    s.fence();
    return s;
}

}  // namespace pliant::plan
