// Result of a simulation, step by step. Everything in SI; positions of all nodes of the mesh.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/core/vec3.hpp"
#include "simulation/run/node_positions.hpp"
#include "simulation/run/sensors.hpp"
#include "simulation/solver/iteration_record.hpp"

namespace pliant::sim {

struct CableState {
    std::string name;
    double length_ratio = 1;  ///< current length over rest length
    double length_m = 0;
    double tension_N = 0;  ///< never negative: a cable only pulls
};

struct ChamberState {
    std::string name;
    double volume_ratio = 1;  ///< current volume over rest volume
    double volume_m3 = 0;
    double pressure_Pa = 0;
};

struct SpringState {
    std::string name;
    double length_m = 0;
    double force_N = 0;  ///< positive where it pulls
};

struct SupportState {
    std::string name;
    Vec3 force_N;  ///< total force of the support on the robot
};

struct MarkerState {
    std::string name;
    Vec3 position_m;
};

struct ContactState {
    std::string name;  ///< of the obstacle
    Vec3 force_N;      ///< normal force and friction of the obstacle on the robot
};

struct ObjectState {
    std::string name;
    Vec3 position_m;                             ///< of the centre of mass
    std::array<double, 4> rotation{1, 0, 0, 0};  ///< since the start: unit quaternion w, x, y, z with w >= 0
    Vec3 force_N;                                ///< normal force and friction of everything that touches it
};

struct JointState {
    std::string name;
    Vec3 force_N, torque_Nm;  ///< from the first thing on the second, about the joint's point there
    bool turns = false, slides = false;
    double coordinate = 0;  ///< hinge: angle with whole turns, rad; slider: displacement, m; 0 at rest
    double effort = 0;      ///< drive, hold and damping along it, N m or N
};

struct SensorState {
    std::string name;
    std::vector<Reading> readings;
};

/// One step of the program at equilibrium. Step 0 is the rest state.
struct Step {
    int index = 0;
    double time = 0;        ///< program time; 0 at rest
    bool converged = true;  ///< false: accepted at a looser tolerance; `reason` says which
    std::string reason;
    int iterations = 0;
    int substeps = 1;                   ///< more than one if the step was halved
    int refused = 0;                    ///< substeps that were repeated, for their time error or for lack of
                                        ///< convergence
    double residual = 0;                ///< norm of the out-of-balance force over the norm of the forces that balance
    Solver solver = Solver::automatic;  ///< the one that finished the step; `automatic` at rest
    double wall_s = 0;
    double min_J = 1;  ///< smallest det F over all integration points
    double energy_J =
        0;  ///< elastic energy, with that of springs, and contact energy, minus the work of dead loads and gravity
    double kinetic_energy_J = 0;  ///< of a motion in time
    std::vector<CableState> cables;
    std::vector<ChamberState> chambers;
    std::vector<SpringState> springs;
    std::vector<SupportState> supports;
    std::vector<ContactState> contacts;  ///< (obstacles)
    double self_contact_N = 0;           ///< sum of the magnitudes of the self-contact forces
    double smallest_distance_m = std::numeric_limits<double>::infinity();  ///< of surfaces within contact range
    bool met = false;                ///< self-contact, if deferred, has become active
    std::optional<Vec3> crossing_m;  ///< a point where surfaces intersect, if contact is off
    std::vector<MarkerState> markers;
    std::vector<ObjectState> objects;
    std::vector<JointState> joints;
    std::vector<SensorState> sensors;
    NodePositions positions;  ///< (n, 3)
};

struct Trajectory {
    std::vector<Step> steps;            ///< rest state first; accepted ones only
    bool converged = true;              ///< the program ran to its end
    std::string message;                ///< where and why it stopped early
    std::vector<std::string> warnings;  ///< reasons not to trust the result
    std::string solver;                 ///< name of the solver that was requested or chosen; see also Step::solver
    std::vector<IterationRecord> iterations;  ///< all, in order, including those of steps that did not converge
    double setup_s = 0;  ///< time until the first step, from the model on: matrices and their factors
    double solve_s = 0;  ///< of the steps and of the checks at the end
};

}  // namespace pliant::sim
