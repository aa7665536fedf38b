// Types that the robot file and the simulation share, under the simulation's namespace.
#pragma once

#include "robot/description/curve.hpp"
#include "robot/description/drive.hpp"
#include "robot/description/program.hpp"
#include "robot/description/solver.hpp"

namespace pliant::sim {

using robot::all_solvers;
using robot::CableTarget;
using robot::ChamberTarget;
using robot::Curve;
using robot::Damping;
using robot::default_air_weight;
using robot::default_gap_weight;
using robot::Dynamics;
using robot::Integrator;
using robot::largest_space_weight;
using robot::name;
using robot::Program;
using robot::ramp;
using robot::Solver;
using robot::solver_named;

}  // namespace pliant::sim
