// The robots of the solver's benchmarks.
#pragma once

#include <string>

#include "simulation/model/model.hpp"

namespace pliant::bench {

/// Box of 100 x 10 x 10 mm in cells of (cells_along, cells_across, cells_across), six linear tets each (or ten-node
/// ones, order 2): 45 and 12 MPa, one half each, bent by 5 N at its end. Marker "tip" is the mean of the loaded face.
[[nodiscard]] sim::Description two_material_bend(double nu, int order, int cells_along = 48, int cells_across = 5);

/// The same bar without the load and with a cable along its upper side, pulled to 0.8 of its length.
[[nodiscard]] sim::Description cable_bar(int order);

/// A block of 60 x 12 x 12 mm, 1 MPa, nu 0.45, clamped at one end, with a closed chamber of 40 x 4 x 4 mm near its
/// lower side, inflated to 1.5 of its volume: 7,200 linear tets.
[[nodiscard]] sim::Description air_bar(int order = 1);

/// The thesis' models at the size that it names: a bar of 100 x 20 x 15 mm of its two materials (T3.4 with equal
/// weights, R_omega 1 and 7.08) with five notches that are meshed as gap elements (T3.5), and a cable that pulls it to
/// 0.88 of its length; or the air bar of the soft one with meshed air (T3.6). 7,200 linear tets each.
[[nodiscard]] sim::Description thesis_gap_bar();
[[nodiscard]] sim::Description thesis_air_bar();

/// The cable finger of the SoftRobots examples (softrobots/README.md of the reference data), its mesh of 7,407 tets:
/// 600 kPa, nu 0.45, no gravity, pulled by 40 mm.
[[nodiscard]] sim::Description finger_7k(const std::string& reference_data);

/// The thesis' cable gripper finger (fem/README.md of the reference data): 8,563 tets, 45 MPa, nu 0.45.
[[nodiscard]] sim::Description notched_finger(const std::string& reference_data, int order,
                                              const sim::CableTarget& target);

}  // namespace pliant::bench
