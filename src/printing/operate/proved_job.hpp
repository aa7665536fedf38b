// A verified job: the gate between a job file and everything that prints it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::operate {

struct ProvedJob {
    job::Archive archive;
    machine::Printer printer;  ///< from the job's own printer.toml, or the other printer
    plan::Plan plan;
    std::string gcode;
    std::vector<std::string> warnings;  ///< what could not be verified
};

/// How thoroughly images are checked.
enum class Pixels {
    fingerprints,  ///< every entry matches the manifest's SHA-256; for a job without hashes, as `areas`
    areas          ///< also decodes each: it has the manifest's area, and no two light the same pixel
};

/// Opens a job and verifies it: every entry against its hash, the images as `pixels` says, the program against manifest
/// and printer (plan::prove_program). Nothing is printed without this check. Errors: one line that names file, entry or
/// G-code line, and layer. A job of format 1 has no hashes, which gives a warning. With an `other` printer, the program
/// must print the job on that one. `progress`, if not null, is told about entries and images, and can cancel.
[[nodiscard]] Result<ProvedJob> prove_job(const std::filesystem::path& path, Pixels pixels = Pixels::fingerprints,
                                          const machine::Printer* other = nullptr, Progress* progress = nullptr);

}  // namespace pliant::operate
