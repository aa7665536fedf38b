// From a robot file to a job file: meshing of surfaces, slicing, plan, G-code, as by `pliant slice`.
#pragma once

#include "base/core/progress.hpp"
#include "printing/plan/plan.hpp"
#include "studio/make/make_session.hpp"

namespace pliant::studio {

/// Returns the colours of the job's materials, in order. `seen` receives its layers as they are sliced. Errors: those
/// of the robot, the printer, the slicer, the planner.
[[nodiscard]] Result<std::vector<std::string>> slice_robot(const SliceOrder& order, const std::filesystem::path& job,
                                                           Progress& progress, JobUnderWay& seen);

/// A plan estimated by prepare::estimate(). Errors: those of that function, and of the robot.
[[nodiscard]] Result<plan::Plan> estimate_robot(const SliceOrder& wanted);

}  // namespace pliant::studio
