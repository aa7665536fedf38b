// Writes a robot as an input deck of CalculiX' solver `ccx`, so that results can be checked with another code.
//
// Same mesh, same law, same loads: C3D4 or C3D10 with NLGEOM, *HYPERELASTIC or *ELASTIC, supports as *BOUNDARY, loads
// as *CLOAD, pressures as *DLOAD (with NLGEOM they follow the surface), gravity as *DLOAD,GRAV, and cables of given
// tension as one SPRINGA element of constant force per segment, which follows its two nodes as a taut cable does. A
// guide point inside a tet is a node of its own, tied to the tet's nodes by *EQUATION. The whole load is applied in one
// step that ramps from rest to time 1. The deck is in mm, uN, Pa and g, because ccx treats every force below 1e-6 as
// zero, whatever the unit. Source of the keywords: CalculiX CrunchiX user's manual 2.20, chapter 7.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "simulation/model/model.hpp"

namespace pliant::sim::calculix {

struct Effort {
    double first_increment = 0.2;  ///< of the step; ccx itself halves and increases it
    /// Convergence criterion of ccx: largest out-of-balance force over the mean force (default of ccx: 5e-3), and last
    /// correction over the increment's displacement (1e-2).
    double tolerance = 1e-5;
};

/// The input deck at the end of a program of `duration` (s). Regions and supports are named sets. Errors for what
/// CalculiX has no counterpart of: laws that it lacks, cables that are not driven by tension, chambers that are not
/// driven by pressure or whose wall is not made of mesh faces, friction, supports that rotate by more than 60 degrees
/// (one step ramps along the chord), rigid plates, contact, growth, springs, torques, masses, joints, objects, a fluid,
/// a motion in time. The messages say what to set instead.
[[nodiscard]] Result<std::string> deck(const Description& description, double duration = 1, const Effort& effort = {});

}  // namespace pliant::sim::calculix
