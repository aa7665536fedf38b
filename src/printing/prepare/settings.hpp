// From an order, a drawing and a printer to the slicer settings and the placement of the part.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/make_job.hpp"
#include "printing/prepare/order.hpp"
#include "printing/prepare/settings_record.hpp"
#include "printing/slice/hollow.hpp"

namespace pliant::prepare {

/// Everything that follows from order, drawing and printer before the part is placed: materials with resins and
/// exposures, raster, layer height, compensations, pairs, light. `mask`: of the projector, if it has one.
/// `drawing.warnings` gets the assumptions made. Errors name the option.
[[nodiscard]] Result<job::JobSettings> job_settings(const Order& order, const machine::Printer& printer,
                                                    std::optional<job::Image> mask, Drawing& drawing);

/// Errors: an option that says something only beside another one, without it: `raft` without `support`.
[[nodiscard]] Status check_companions(const Order& order);

/// Errors that arrange() finds in the options of supports, apart from what they have to do with the part.
[[nodiscard]] Status check_supports(const Order& order);

/// Of an order that has `hollow`. Errors name the option.
[[nodiscard]] Result<slice::HollowSettings> hollow_settings(const Order& order);

/// Rotates the part, arranges its copies, places them on the platform (or above it, on supports), sets layer heights,
/// hollows the part and adds supports, as far as the order asks for it. `notes` gets lines that describe the result.
[[nodiscard]] Status arrange(const Order& order, job::JobSettings& settings, Drawing& drawing,
                             std::vector<std::string>& notes, Progress& progress);

/// The part of the order that settings.json records.
[[nodiscard]] job::Request request_of(const Order& order, const job::JobSettings& settings);

}  // namespace pliant::prepare
