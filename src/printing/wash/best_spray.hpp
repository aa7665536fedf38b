// The oscillation and the time with which the spray cleans a part with the least solution.
#pragma once

#include "base/core/error.hpp"
#include "printing/wash/spray.hpp"

namespace pliant::wash {

struct BestSpray {
    Strokes strokes;
    double seconds = 0;
    double solution_ml = 0;  ///< of one cleaning
    double removed = 0;      ///< share of the film, at least what was wanted
    double unseen = 0;       ///< share of the surface that no solution reaches
};

/// Searches all strokes that the machine has room for, first coarsely, then around the best. A cleaning is at least one
/// stroke out and back, and of a tower what its hooks take meanwhile. Errors: the machine has no sprinklers, pumps
/// nothing, or no oscillation makes the part so clean within the longest cleaning that the machine allows; then it says
/// how clean it gets.
[[nodiscard]] Result<BestSpray> best_spray(const PartCells& part, const machine::Printer& printer, double wanted);

}  // namespace pliant::wash
