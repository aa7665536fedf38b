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
    std::string text;                  ///< content of the printer file, kept in the job
    std::optional<job::Image> mask{};  ///< of its projector
};

/// Errors: the name of a job that does not end in .zip, or that is one of the inputs ("MATERIAL=FILE" as in an order)
/// or the printer file, which it would replace.
[[nodiscard]] Status check_job_name(const std::filesystem::path& job, const std::vector<std::string>& inputs,
                                    const std::filesystem::path& printer);

struct SlicedJob {
    job::Manifest manifest;
    plan::Plan plan;
    std::vector<std::string> notes;  ///< remarks: overlaps of drawn bodies; what was added, supports, cavities
};

/// Writes `file` atomically. `watch` is called for each layer as it is made. Errors: in the order, from the slicer, the
/// planner, the disk; cancelled.
[[nodiscard]] Result<SlicedJob> slice_job(const Order& order, const PrinterFile& printer, Drawing drawing,
                                          const std::filesystem::path& file, Progress& progress,
                                          job::LayerWatch watch = {});

}  // namespace pliant::prepare
