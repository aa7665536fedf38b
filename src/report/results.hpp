// The result folder of `pliant simulate -o DIR`. docs/reference/results.md describes every file.
#pragma once

#include <filesystem>

#include "core/progress.hpp"
#include "report/pictures.hpp"
#include "report/simulation.hpp"

namespace pliant::report {

/// Writes summary.json, steps.csv, markers.csv, iterations.csv, frames.pvd with frames/*.vtu, robot.glb, pictures/*.png
/// and report.html into `folder`, which exists and is written aside by the caller (core/files.hpp, write_folder). Ray
/// casting the pictures takes seconds; the rest is quick.
[[nodiscard]] Status write_results(const std::filesystem::path& folder, const Simulation& simulation,
                                   Progress& progress, const PictureSize& picture_size = {});

}  // namespace pliant::report
