// frames.pvd and frames/frame_0000.vtu...: the motion with its fields, for ParaView.
#pragma once

#include <filesystem>

#include "base/core/progress.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

/// One file per step, rest state first, and the collection with their times. Points of the tets in mm; point data
/// displacement_mm and, with contact, contact_pressure_kPa; cell data region, material (-1: void), J, von_mises_kPa,
/// max_stretch, energy_density_kPa; field data region_names. Precondition: check() passes.
[[nodiscard]] Status write_frames(const std::filesystem::path& folder, const Simulation& simulation,
                                  Progress& progress);

}  // namespace pliant::report
