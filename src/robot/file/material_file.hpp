// One table of elastic constants: [material.NAME] of a robot file, or a file of the library (data/materials).
#pragma once

#include "base/core/config.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// Law, density, resin and colour of one material; what is wrong goes to the reader's problems. Reads no other keys.
[[nodiscard]] MaterialSpec read_material(config::Reader& reader, const std::string& name);

/// Seconds of light for a layer; 0 where the key is missing.
[[nodiscard]] double read_exposure(config::Reader& reader, std::string_view key);

}  // namespace pliant::robot
