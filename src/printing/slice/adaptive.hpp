// Adaptive layers: thin where the surface is slanted, thick where it is steep.
#pragma once

#include <span>
#include <vector>

#include "printing/slice/body.hpp"

namespace pliant::slice {

struct AdaptiveHeights {
    int least_um = 25, most_um = 100;
};

/// Layer tops, ascending, up to the highest body. A layer of thickness h on a face whose normal has the vertical
/// component n (0 for an upright face, 1 for a flat one) deviates from the drawn surface by h n (the cusp height,
/// Dolenc and Makela 1994): no layer exceeds a cusp height of `least_um`, but none is thinner than that or thicker than
/// `most_um`. Layers end at horizontal faces, to a micrometre where the minimum allows it and else to less than the
/// minimum; other thicknesses are multiples of 5 um if both limits are. The slice thickness of bodies given as outlines
/// is a further limit. Errors: limits outside 1 to 10000 um or out of order; what bounds() rejects; more than a million
/// layers.
[[nodiscard]] Result<std::vector<int>> adaptive_tops(std::span<const Body> bodies, const AdaptiveHeights& heights);

}  // namespace pliant::slice
