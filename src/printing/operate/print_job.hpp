// A job archive prepared for printing.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::operate {

struct ReadyJob {
    std::shared_ptr<job::Archive> archive;  ///< source of the images; not thread-safe
    machine::Printer printer;               ///< from the job's own printer.toml, its vats filled as the plan requires
    plan::Plan plan;
    host::PrintJob job;                 ///< its journal is JOB.zip.journal beside the job
    std::vector<std::string> warnings;  ///< of prove_job()
};

/// Errors: not a job, or one whose content is wrong (prove_job).
[[nodiscard]] Result<ReadyJob> load_job(const std::filesystem::path& path);

}  // namespace pliant::operate
