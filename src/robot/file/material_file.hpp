// Reads one table of elastic constants: [material.NAME] of a robot file, or a file of the library (data/materials).
#pragma once

#include "base/core/config.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Law, density, resin and colour of one material; errors go to the reader's problems. Other keys are not read.
[[nodiscard]] MaterialSpec read_material(config::Reader& reader, const std::string& name);

/// Exposure of a layer, s; 0 if the key is missing.
[[nodiscard]] double read_exposure(config::Reader& reader, std::string_view key);

}  // namespace pliant::robot
