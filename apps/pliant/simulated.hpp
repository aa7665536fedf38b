// A finished run, put together for reports.
#pragma once

#include "presentation/report/simulation.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"

namespace pliant::app {

/// All must outlive it.
[[nodiscard]] report::Simulation describe(const robot::Robot& robot, const sim::Model& model,
                                          const sim::Trajectory& trajectory);

}  // namespace pliant::app
