// The oscillation and duration with which the spray cleans a part using the least solution.
#pragma once

#include "base/core/error.hpp"
#include "printing/wash/spray.hpp"

namespace pliant::wash {

struct BestSpray {
    Strokes strokes;
    double seconds = 0;
    double solution_ml = 0;  ///< per cleaning
    double removed = 0;      ///< fraction of the film, at least the required one
    double unseen = 0;       ///< fraction of the surface that no solution reaches
};

/// Searches all strokes that the machine has room for, first coarsely, then around the best. A cleaning is at least one
/// stroke out and back and, with a tower, what its hooks need meanwhile. Errors: the machine has no nozzles, pumps
/// nothing, or no oscillation gets the part clean enough within the machine's longest cleaning; then the error says how
/// clean it gets.
[[nodiscard]] Result<BestSpray> best_spray(const PartCells& part, const machine::Printer& printer, double wanted);

}  // namespace pliant::wash
