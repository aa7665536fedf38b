// What an actuator value of a page means for the model, or why it cannot be.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/actuators/actuator.hpp"
#include "simulation/model/model.hpp"
#include "studio/requests/message.hpp"

namespace pliant::studio {

struct ActuatorDrive {
    std::size_t actuator = 0;  ///< first the cables, then the chambers
    sim::Drive drive;
};

/// `rest_measures`: lengths and volumes at rest, in SI, one for each actuator. Errors name the actuator and what is
/// possible: an unknown name, a kind that this actuator does not have, a value that it cannot take.
[[nodiscard]] Result<ActuatorDrive> drive_of(const sim::Model& model, const std::vector<double>& rest_measures,
                                             const ActuatorValue& value);

/// `there is no marker "nose"; the robot has "tip"`, or another part with a name.
[[nodiscard]] std::string no_such_part(const char* part, const std::string& name, std::vector<std::string> names);

}  // namespace pliant::studio
