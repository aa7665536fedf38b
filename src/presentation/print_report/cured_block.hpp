// What has cured in the virtual printer, held against the drawing: for the page about a print.
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
    twin::CoarsePart off;    ///< 0: resin that no image asks for there; 1: missing
};

/// Inspects the twin's block, which must grow no more, and makes it coarse enough to draw. Cost: every image is asked
/// for twice. Errors: an image cannot be had.
[[nodiscard]] Result<CuredBlock> cured_block(twin::Twin& twin, const job::Manifest& job, const twin::RunSource& images,
                                             const twin::Judgement& judgement = {});

/// Drawing and block side by side from above and in front, 1200 x 540 pixels, PNG; where they differ in shades of red.
/// What is not as it should be is drawn however little it is. Errors: there is nothing to draw.
[[nodiscard]] Result<std::string> block_picture(const CuredBlock& block, const job::Manifest& job,
                                                const machine::Projector& projector);

/// The section of the page: verdict, picture (PNG), volumes, contamination, the first deviation.
[[nodiscard]] std::string block_section(const CuredBlock& block, const std::string& png);

}  // namespace pliant::report
