// From a robot file to a job file: meshing of surfaces, slicing, plan, G-code, as `pliant slice` does it.
#pragma once

#include "base/core/progress.hpp"
#include "presentation/studio/make_session.hpp"
#include "printing/plan/plan.hpp"

namespace pliant::studio {

/// Colours of the job's materials, in their order. `seen` gets its layers as they are made. Errors: of the robot, the
/// printer, the slicer, the planner.
[[nodiscard]] Result<std::vector<std::string>> slice_robot(const SliceOrder& order, const std::filesystem::path& job,
                                                           Progress& progress, JobUnderWay& seen);

/// The plan as prepare::estimate() guesses it. Errors: as that one, and of the robot.
[[nodiscard]] Result<plan::Plan> estimate_robot(const SliceOrder& wanted);

}  // namespace pliant::studio
