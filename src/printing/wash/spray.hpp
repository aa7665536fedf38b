// How much solution the nozzles bring to each part of the surface while the cleaning vat oscillates below and the
// platform moves up and down, and how clean that makes it.
//
// A nozzle sprays a cone, uniform over all its directions. Drops fly straight; places hidden from a nozzle by the part
// itself get nothing, which rays from the surface to the nozzles determine. Solution of depth D that has hit a place
// leaves exp(-D / wash_depth_mm) of its film.
#pragma once

#include <vector>

#include "printing/machine/printer.hpp"
#include "printing/wash/part_cells.hpp"

namespace pliant::wash {

/// Depth of solution that reduces a film to 1 / e, chosen so that cone, cylinder and pyramids of the thesis' table 4.2
/// get as clean as there (spray_test.cpp) by jets alone. Not measured independently: it belongs to the nozzles and the
/// flow of tower.toml.
inline constexpr double wash_depth_mm = 0.022;

/// One period of the oscillation: out and up, and back.
struct Strokes {
    int x_um = 0;  ///< of the carriage; 0 for tables
    int z_um = 0;  ///< of the platform
};

[[nodiscard]] Strokes strokes_of(const machine::Printer& printer);

/// Depth of solution that jets bring to each face per second, in mm, averaged over one stroke; run_off.hpp adds the
/// run-off. Requires nozzles. Cost: some 10 us per face.
[[nodiscard]] std::vector<double> spray_rates(const PartCells& part, const std::vector<Face>& faces,
                                              const machine::Printer& printer, const Strokes& strokes);

/// The result of a spray cleaning.
struct Cleanness {
    double removed = 0;        ///< fraction of the film
    double unseen = 0;         ///< fraction of the surface never reached by solution
    std::vector<double> left;  ///< fraction of its film left on each face
};

[[nodiscard]] Cleanness cleanness(const std::vector<Face>& faces, const std::vector<double>& rates_mm_s,
                                  double seconds);

}  // namespace pliant::wash
