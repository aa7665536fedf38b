// How long each material is exposed: by the printer file, by the robot file, and by --exposure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "printing/job/exposure.hpp"
#include "printing/machine/printer.hpp"
#include "printing/prepare/drawing.hpp"
#include "printing/prepare/make_job.hpp"
#include "printing/prepare/order.hpp"

namespace pliant::prepare {

/// The materials of the drawing, each with the printer file's exposures of its resin or those of its own. For a resin
/// that the printer does not know, assumptions are made, of which `drawing.warnings` tells.
[[nodiscard]] std::vector<job::Material> with_exposures(Drawing& drawing, const machine::Printer& printer);

/// Exposure rules of the materials whose layers are not all exposed alike.
[[nodiscard]] std::map<std::string, job::ExposureRule> exposure_rules(const Drawing& drawing,
                                                                      const machine::Printer& printer,
                                                                      bool many_heights);

/// The most bottom layers of a material are those of the job; a material with fewer keeps its own number.
void set_bottom_layers(job::JobSettings& settings);

/// Sets what --exposure says; exposures far from the printer file's are told in `drawing.warnings`. Errors name the
/// option. Precondition: `settings` has materials, layer height and exposure rules.
[[nodiscard]] Status set_exposures(const Order& order, const machine::Printer& printer, job::JobSettings& settings,
                                   Drawing& drawing);

/// Errors: an exposure of the robot file beyond the printer's limit. Those of printer file and options are checked
/// where they are read.
[[nodiscard]] Status check_limits(const Drawing& drawing, const std::vector<job::Material>& materials,
                                  const machine::Printer& printer);

}  // namespace pliant::prepare
