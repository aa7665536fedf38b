// Layers that are thin where the surface is slanted and thick where it is steep.
#pragma once

#include <span>
#include <vector>

#include "printing/slice/body.hpp"

namespace pliant::slice {

struct AdaptiveHeights {
    int least_um = 25, most_um = 100;
};

/// The tops of layers, rising, up to the highest body. A layer of thickness h across a face whose normal leans to the
/// vertical by n (its vertical part, 0 upright to 1 flat) leaves steps of depth h n from the drawn surface (their cusp
/// height, Dolenc and Makela 1994): no layer leaves deeper ones than `least_um`, but none is thinner than that nor
/// thicker than `most_um`. Whole steps of 5 um where both limits are such. Bodies that come as outlines have the
/// thickness of their own slices as a limit. Errors: limits that are not 1 to 10000 um in order; what bounds() refuses;
/// more than a million layers.
[[nodiscard]] Result<std::vector<int>> adaptive_tops(std::span<const Body> bodies, const AdaptiveHeights& heights);

}  // namespace pliant::slice
