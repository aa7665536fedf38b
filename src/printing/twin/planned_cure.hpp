// What a job's images and exposures cure in themselves, without program, wire and faults. Shows before the print how
// deep the light will cure below undersides.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/job/job.hpp"
#include "printing/twin/cure.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/twin/screen.hpp"

namespace pliant::twin {

/// What the whole job cures; its layers are not kept. Every image is exposed as long as the manifest says, in the first
/// vat of its resin, which does not run empty. `printer` must outlive it, and its vats hold the job's resins. Errors:
/// an image is unavailable; cancelled.
[[nodiscard]] Result<Cure> planned_cure(const machine::Printer& printer, const job::Manifest& job,
                                        const RunSource& images, const Screen& screen, Progress& progress);

/// One line for each resin that cures deeper below undersides than `allowed_overcure_um`; empty if there is none.
[[nodiscard]] std::vector<std::string> overcure_warnings(const Cure& cure, const machine::Printer& printer);

}  // namespace pliant::twin
