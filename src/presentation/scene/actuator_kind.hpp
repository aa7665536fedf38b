// Names and units of actuator drives on the page.
#pragma once

#include <cstddef>

#include "simulation/parts/description.hpp"

namespace pliant::view {

struct ActuatorKind {
    const char* name;     ///< as in messages: length_ratio, shortening_mm, ...
    double per_unit = 1;  ///< value on the page for one SI unit
};

[[nodiscard]] ActuatorKind kind_of(const sim::CableTarget& target);
[[nodiscard]] ActuatorKind kind_of(const sim::ChamberTarget& target);
/// `actuator`: first the cables, then the chambers.
[[nodiscard]] ActuatorKind kind_of(const sim::Description& robot, std::size_t actuator);

}  // namespace pliant::view
