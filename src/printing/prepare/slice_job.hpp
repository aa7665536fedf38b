// From a drawing to a whole job file: images, settings, plan and checked G-code.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/settings.hpp"

namespace pliant::prepare {

struct PrinterFile {
    machine::Printer printer;
    std::string text;                  ///< the job keeps it
    std::optional<job::Image> mask{};  ///< of its projector
};

struct SlicedJob {
    job::Manifest manifest;
    plan::Plan plan;
    std::vector<std::string> notes;  ///< lines of what was made: supports, cavities
};

/// Writes `file` whole or not at all. `watch` hears of its layers as they are made. Errors: of the order, the slicer,
/// the planner, the disk; cancelled.
[[nodiscard]] Result<SlicedJob> slice_job(const Order& order, const PrinterFile& printer, Drawing drawing,
                                          const std::filesystem::path& file, Progress& progress,
                                          job::LayerWatch watch = {});

}  // namespace pliant::prepare
