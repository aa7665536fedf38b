// In-memory jobs for tests: a plan depends only on which materials print on which layer.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan::test {

/// 50 um layers; material m is called "m0", "m1", ... and printed in the resin that `resins` gives it.
/// Every image covers 100 mm^2.
inline job::Manifest make_job(const std::vector<std::vector<int>>& layers, const std::vector<std::string>& resins) {
    job::Manifest job;
    job.name = "job";
    job.width_px = 1920;
    job.height_px = 1080;
    job.pixel_um = 158.75;
    job.bottom_layers = 3;
    job.any_vat = true;  // most tests are about orders and times, not names of resins
    for (std::size_t m = 0; m < resins.size(); ++m) {
        job.materials.push_back({fmt::format("m{}", m), resins[m], 0, 0, 2.5, 12});
    }
    for (const auto& materials : layers) {
        job::Layer layer;
        layer.z_um = 50 * static_cast<int>(job.layers.size() + 1);
        layer.thickness_um = 50;
        for (const int m : materials) {
            layer.images.push_back({m, fmt::format("layers/{}_m{}.png", job.layers.size(), m), 100});
        }
        job.layers.push_back(std::move(layer));
    }
    return job;
}

/// For that machine's projector.
inline job::Manifest make_job_for(const machine::Printer& printer, const std::vector<std::vector<int>>& layers,
                                  const std::vector<std::string>& resins) {
    job::Manifest job = make_job(layers, resins);
    job.width_px = printer.projector.width_px;
    job.height_px = printer.projector.height_px;
    job.pixel_um = printer.projector.pixel_um;
    return job;
}

/// All machines in examples/printers.
inline std::vector<machine::Printer> machines() {
    std::vector<machine::Printer> all;
    for (const char* name :
         {"tower", "tower8", "two_towers", "carousel", "tower_magnet", "wall", "rotary", "linear", "single"}) {
        all.push_back(machine::load_printer(fmt::format("examples/printers/{}.toml", name)).value());
    }
    return all;
}

/// That of examples/printers.
inline machine::Printer machine_of(const char* name) {
    return machine::load_printer(fmt::format("examples/printers/{}.toml", name)).value();
}

inline machine::Printer tower() {
    return machine_of("tower");
}

/// The materials of so many equal layers.
inline std::vector<std::vector<int>> repeated(const std::vector<int>& layer, std::size_t times) {
    return std::vector<std::vector<int>>(times, layer);
}

}  // namespace pliant::plan::test
