// The volume that solids share, from points: it knows nothing of Open CASCADE, whose results it can judge.
#pragma once

#include <functional>
#include <span>

#include "geometry/shapes/solid.hpp"

namespace pliant::mesh::kernel {

/// A volume from points, and its standard deviation if they were random. They are evenly spread and always the same, so
/// it is much nearer in fact.
struct SampledVolume {
    double volume = 0, deviation = 0;
};

/// False if contains() is not exact for the solid, or for a part of it: solids of STEP files, and the space between
/// walls.
[[nodiscard]] bool can_be_sampled(const Solid& solid);
[[nodiscard]] bool can_be_sampled(std::span<const Solid> solids);

/// What all of `others` together cover of a solid, with `points` for each of them, fewer where they are over 100.
[[nodiscard]] SampledVolume covered_volume(const Solid& solid, std::span<const Solid> others, int points);

/// What the volumes of the parts have in sum more than their union, with as many points.
[[nodiscard]] SampledVolume repeated_volume(std::span<const Solid> parts, int points);

/// True if a calculated volume fits the sampled one. `slack`: the error that the calculated one may have. Where a few
/// points leave doubt, many decide.
[[nodiscard]] bool fits(double volume, double slack, const std::function<SampledVolume(int points)>& sampled);

}  // namespace pliant::mesh::kernel
