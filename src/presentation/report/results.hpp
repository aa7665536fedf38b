// The result folder of `pliant simulate -o DIR`. docs/reference/results.md describes every file.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/progress.hpp"
#include "presentation/report/pictures.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

struct Written {
    Timing timing;                 ///< of the simulation, with that of files and pictures
    bool drawing_stopped = false;  ///< no pictures, because drawing them was cancelled
    std::string warning;           ///< why pictures or the film are missing, if drawing failed; else empty
};

/// Writes summary.json, steps.csv, markers.csv, iterations.csv, frames.pvd with frames/*.vtu, robot.glb, pictures/*.png
/// and report.html into `folder`, a temporary folder that the caller has created (base/core/files.hpp, write_folder).
/// Ray casting the pictures takes seconds; the rest is quick. Cancelling `drawing` only omits the pictures, as does a
/// failure while drawing; cancelling `writing` is an error.
[[nodiscard]] Result<Written> write_results(const std::filesystem::path& folder, const Simulation& simulation,
                                            const PictureChoice& pictures, Progress& writing, Progress& drawing);

}  // namespace pliant::report
