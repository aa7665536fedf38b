// From an order, a drawing and a printer to the settings of the slicer, and to where the part stands.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/make_job.hpp"
#include "printing/prepare/order.hpp"
#include "printing/prepare/settings_record.hpp"

namespace pliant::prepare {

/// All that follows from order, drawing and printer before the part is placed: materials with resins and exposures,
/// raster, layer height, compensations, pairs, light. `mask`: of the projector, where it has one. `drawing.warnings`
/// tells what was assumed. Errors name the option.
[[nodiscard]] Result<job::JobSettings> job_settings(const Order& order, const machine::Printer& printer,
                                                    std::optional<job::Image> mask, Drawing& drawing);

/// Turns the part, lays out its copies, stands them on the platform (or above it, on supports), gives layers their
/// heights, hollows the part out and adds supports, as far as the order asks for it. Lines of what was made go to
/// `notes`.
[[nodiscard]] Status arrange(const Order& order, job::JobSettings& settings, Drawing& drawing,
                             std::vector<std::string>& notes, Progress& progress);

/// What settings.json keeps of the order.
[[nodiscard]] job::Request request_of(const Order& order, const job::JobSettings& settings);

}  // namespace pliant::prepare
