// The spray section of `pliant plan`: how clean the finished part gets, and the oscillation that achieves this with the
// least solution.
#pragma once

#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/wash/best_spray.hpp"

namespace pliant::app {

struct SprayOrder {
    bool wanted = false;
    std::optional<double> cleanness;  ///< share of the film to remove; empty: use the printer's own oscillation
    std::string picture_file;
};

struct SprayResult {
    double seconds = 0;
    wash::Strokes strokes;
    double removed = 0, unseen = 0;
    std::optional<double> before_ml, now_ml;  ///< solution per cleaning before and after optimisation, if any
};

/// Empty if nothing is requested. With a target cleanness, `printer` gets the best oscillation and time. Decodes all
/// images of the job.
[[nodiscard]] Result<std::optional<SprayResult>> look_at_spray(const SprayOrder& order, const job::Archive& archive,
                                                               machine::Printer& printer);

/// The plan as JSON with a key "spray" added if there is a result.
[[nodiscard]] std::string with_spray(const std::string& plan_json, const std::optional<SprayResult>& spray);
[[nodiscard]] std::string spray_text(const std::optional<SprayResult>& spray);

}  // namespace pliant::app
