// Speed of planning: a tall job of many materials, its G-code, and the check of that G-code against the machine.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "printing/plan/check.hpp"
#include "printing/plan/plan.hpp"

using namespace pliant;

namespace {

/// 300 mm in layers of 50 um, the tower's whole height; each layer holds two to four of eight materials, another set
/// every 40 layers.
job::Manifest tall_job(const machine::Printer& printer) {
    constexpr int layers = 6000, materials = 8;
    job::Manifest job;
    job.name = "tall";
    job.width_px = printer.projector.width_px;
    job.height_px = printer.projector.height_px;
    job.pixel_um = printer.projector.pixel_um;
    job.bottom_layers = 3;
    job.any_vat = true;
    for (int m = 0; m < materials; ++m)
        job.materials.push_back({fmt::format("m{}", m), fmt::format("r{}", m), 0, 0, 2.5, 12});
    for (int i = 0; i < layers; ++i) {
        job::Layer layer{50 * (i + 1), 50, {}};
        const int set = i / 40;
        for (int m = 0; m < materials; ++m) {
            if ((m + set) % materials < 2 + set % 3)
                layer.images.push_back({m, fmt::format("layers/{}_{}.png", i, m), 100});
        }
        job.layers.push_back(std::move(layer));
    }
    return job;
}

/// The tower with a vat in each of its eight slots.
machine::Printer full_tower() {
    machine::Printer printer = machine::load_printer("examples/printers/tower.toml").value();
    while (static_cast<int>(printer.vats.size()) < printer.tower.slots) {
        machine::Vat vat = printer.vats.back();
        vat.slot = static_cast<int>(printer.vats.size()) + 1;
        vat.resin.clear();
        printer.vats.push_back(vat);
    }
    return printer;
}

void plan_tall(benchmark::State& state, bool with_gcode) {
    const machine::Printer printer = full_tower();
    const job::Manifest job = tall_job(printer);
    plan::Plan plan;
    std::string gcode;
    for (auto _ : state) {
        auto made = plan::make_plan(job, printer);
        if (!made) return state.SkipWithError(made.error().message.c_str());
        plan = std::move(*made);
        if (!with_gcode) continue;
        gcode = plan::write_gcode(plan, job, printer);
        if (const Status checked = plan::check_gcode(gcode, printer); !checked)
            return state.SkipWithError(checked.error().message.c_str());
    }
    state.counters["layers"] = plan.layers;
    state.counters["swaps"] = plan.swaps;
    state.counters["swap_lower_bound"] = plan.swap_lower_bound;
    state.counters["gcode_MB"] = static_cast<double>(gcode.size()) / 1e6;
}

}  // namespace

/// 10,000 layers, all of eight materials in each: the most swaps there can be.
void plan_full(benchmark::State& state) {
    machine::Printer printer = full_tower();
    printer.platform.build_height_um = 600000;
    job::Manifest job = tall_job(printer);
    job.layers.clear();
    for (int i = 0; i < 10000; ++i) {
        job::Layer layer{50 * (i + 1), 50, {}};
        for (int m = 0; m < 8; ++m) layer.images.push_back({m, "a", 100});
        job.layers.push_back(std::move(layer));
    }
    plan::Plan plan;
    for (auto _ : state) {
        auto made = plan::make_plan(job, printer);
        if (!made) return state.SkipWithError(made.error().message.c_str());
        plan = std::move(*made);
    }
    state.counters["layers"] = plan.layers;
    state.counters["swaps"] = plan.swaps;
    state.counters["hours"] = plan.seconds.total / 3600;
}

BENCHMARK(plan_full)->Name("plan_10000_layers_8_materials")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plan_tall, plan_only, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(plan_tall, plan_gcode_check, true)->Unit(benchmark::kMillisecond);
