// A printer as JSON, for the page that draws it; lengths in mm.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "printing/machine/printer.hpp"

namespace pliant::studio {

/// Position of images on the platform.
[[nodiscard]] nlohmann::json projector_json(const machine::Projector& projector);
/// Data for drawing the machine: axes, vats, platform, tower, projector and safety devices.
[[nodiscard]] nlohmann::json printer_json(const machine::Printer& printer);

}  // namespace pliant::studio
