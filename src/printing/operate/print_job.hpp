// A job archive made ready to print.
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
    std::shared_ptr<job::Archive> archive;  ///< the images come from it; one thread at a time
    machine::Printer printer;               ///< from the job's own printer.toml, its vats filled as the plan asks
    plan::Plan plan;
    host::PrintJob job;                 ///< its journal is JOB.zip.journal beside the job
    std::vector<std::string> warnings;  ///< of the proof
};

/// Errors: no job, or one that does not hold what it says (prove_job).
[[nodiscard]] Result<ReadyJob> load_job(const std::filesystem::path& path);

}  // namespace pliant::operate
