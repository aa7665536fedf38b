// The result folder of `pliant simulate -o DIR`. docs/reference/results.md describes every file.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/core/files.hpp"
#include "base/core/progress.hpp"
#include "presentation/report/pictures.hpp"
#include "presentation/report/simulation.hpp"

namespace pliant::report {

struct Written {
    Timing timing;                 ///< of the simulation, with that of files and pictures
    bool drawing_stopped = false;  ///< no pictures, because drawing them was cancelled
    std::string warning;           ///< why pictures or the film are missing, if drawing failed; else empty
};

/// Files that only inverse, identify and study write, each beside a summary.json: simulate does not replace their
/// results by its own.
inline constexpr std::array<std::string_view, 3> other_results = {"inverse.json", "identified.toml", "plan.json"};

[[nodiscard]] inline FolderMark simulation_mark() {
    return {"summary.json", other_results};
}
[[nodiscard]] inline FolderMark inverse_mark() {
    return {"summary.json", std::span(other_results).subspan(1)};
}

/// Writes summary.json, steps.csv, markers.csv, iterations.csv, frames.pvd with frames/*.vtu, robot.glb, pictures/*.png
/// and report.html into `folder`, a temporary folder that the caller has created (base/core/files.hpp, write_folder).
/// Ray casting the pictures takes seconds; the rest is quick. Cancelling `drawing` only omits the pictures, as does a
/// failure while drawing; cancelling `writing` is an error.
[[nodiscard]] Result<Written> write_results(const std::filesystem::path& folder, const Simulation& simulation,
                                            const PictureChoice& pictures, Progress& writing, Progress& drawing);

}  // namespace pliant::report
