// The cured part of the virtual printer compared with the drawing, for the print report.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/twin/coarse_part.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::report {

struct CuredBlock {
    twin::Report report;
    twin::CoarsePart asked;  ///< by material of the job
    twin::CoarsePart cured;  ///< by the first material of the job that is printed in that resin
    twin::CoarsePart off;    ///< 0: cured resin where no image asks for it; 1: missing resin
};

/// Inspects the twin's block, which must be complete, and coarsens it for drawing. Cost: every image is requested
/// twice. Errors: an image is not available.
[[nodiscard]] Result<CuredBlock> cured_block(twin::Twin& twin, const job::Manifest& job, const twin::RunSource& images,
                                             const twin::Judgement& judgement = {});

/// Drawing and block side by side, seen from above and in front, 1200 x 540 pixels, PNG; differences in shades of red,
/// drawn however small they are. Errors: there is nothing to draw.
[[nodiscard]] Result<std::string> block_picture(const CuredBlock& block, const job::Manifest& job,
                                                const machine::Projector& projector);

/// The section of the report: verdict, picture (PNG), volumes, contamination, the first deviation.
[[nodiscard]] std::string block_section(const CuredBlock& block, const job::Manifest& job, const std::string& png);

}  // namespace pliant::report
