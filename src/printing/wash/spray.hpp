// How much solution the sprinkler heads bring to each piece of a part's surface while the cleaning vat oscillates below
// it and the platform goes up and down, and how clean that makes it.
//
// A head sprays a cone, equally dense in all its directions. Drops fly straight; what the part itself hides from a head
// gets nothing of it: rays from the surface to the heads find out. Solution of depth D that has hit a place leaves
// exp(-D / wash_depth_mm) of its film.
#pragma once

#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/wash/part_cells.hpp"

namespace pliant::wash {

/// Depth of solution that takes a film to 1 / e of it, for which cone, cylinder and pyramids of the thesis' table 4.2
/// come as clean as there (spray_test.cpp) by jets alone. Not measured on its own: it goes with the heads and the flow
/// of tower.toml.
inline constexpr double wash_depth_mm = 0.022;

/// Oscillation: out and up, and back.
struct Strokes {
    int x_um = 0;  ///< of the carriage; tables have none
    int z_um = 0;  ///< of the platform
};

[[nodiscard]] Strokes strokes_of(const machine::Printer& printer);

/// Depth of solution that jets bring to each face in a second, in mm, in the mean over one stroke. What runs on from
/// there is in run_off.hpp. Needs sprinklers. Cost: some
/// 10 us for every face.
[[nodiscard]] std::vector<double> spray_rates(const PartCells& part, const std::vector<Face>& faces,
                                              const machine::Printer& printer, const Strokes& strokes);

/// How clean a part comes out of the spray.
struct Cleanness {
    double removed = 0;        ///< share of the film
    double unseen = 0;         ///< share of the surface that no solution reaches at any time
    std::vector<double> left;  ///< of each face: share of its film that stays
};

[[nodiscard]] Cleanness cleanness(const std::vector<Face>& faces, const std::vector<double>& rates_mm_s,
                                  double seconds);

}  // namespace pliant::wash
