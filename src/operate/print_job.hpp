// A job archive made ready to print.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "host/control_types.hpp"
#include "job/job.hpp"
#include "machine/printer.hpp"
#include "plan/plan.hpp"

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
