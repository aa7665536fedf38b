// CalculiX beside us: writes a robot as an input deck of its solver `ccx` (Debian package calculix-ccx), runs it and
// reads what it found. For tests and benchmarks only: nothing of CalculiX is linked.
//
// Same mesh, same law, same loads, another code: C3D4 or C3D10 with NLGEOM, *HYPERELASTIC or *ELASTIC, supports as
// *BOUNDARY, loads as *CLOAD, pressures as *DLOAD (with NLGEOM they follow the surface), and cables of given tension
// as one SPRINGA element of constant force per segment, which follows its two nodes as a taut cable does. The whole
// load comes in one step that ramps from rest to time 1. The deck is in mm, uN and Pa: ccx takes every force below 1e-6
// for none, whatever the unit. Source of the keywords: CalculiX CrunchiX user's manual 2.20, chapter 7.
#pragma once

#include <string>
#include <vector>

#include "core/error.hpp"
#include "sim/model.hpp"

namespace pliant::sim::calculix {

struct Effort {
    double first_increment = 0.2;  ///< of the step; halved and grown by ccx itself
    /// Of the largest out-of-balance force over the mean force (ccx' own default is 5e-3), and of the last correction
    /// over the increment's displacement (1e-2).
    double tolerance = 1e-5;
};

struct Solution {
    std::vector<Vec3> displacement_m;  ///< (n, 3), nodes as in the description's mesh
    std::vector<Vec3> force_N;         ///< (n, 3), from outside: reactions at supports, loads elsewhere
    int increments = 0;
    int iterations = 0;
    double wall_s = 0;  ///< of the whole program: reading, solving, writing
};

/// Whether `ccx` is on the PATH.
[[nodiscard]] bool installed();

/// The input deck at the end of the program (time 1). Errors where CalculiX has no counterpart: laws that it lacks,
/// cables that are not driven by tension or whose points are not nodes, chambers that are not driven by pressure,
/// friction, turning supports, rigid plates, gravity, contact, growth.
[[nodiscard]] Result<std::string> deck(const Description& description, const Effort& effort = {});

/// Runs `ccx` on one thread in a temporary folder of its own, which goes again.
[[nodiscard]] Result<Solution> solve(const Description& description, const Effort& effort = {});

/// Sum of the forces of a support on the robot.
[[nodiscard]] Vec3 support_force(const Solution& solution, const Support& support);

/// Mean displacement of an attachment's nodes, by its weights.
[[nodiscard]] Vec3 displacement(const Solution& solution, const Attachment& point);

}  // namespace pliant::sim::calculix
