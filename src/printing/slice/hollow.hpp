// Hollow parts: walls of a given thickness, and drain holes for the resin.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/slice/slicer.hpp"

namespace pliant::slice {

/// Of walls, and of drains.
inline constexpr double most_hollow_um = 100000;

struct HollowSettings {
    double wall_um = 2000;
    double drain_um = 0;  ///< diameter of the holes; 0: none
};

/// Errors: a wall or a drain outside (0, 100] mm (a drain of 0 means none).
[[nodiscard]] Status check(const HollowSettings& hollow);

struct Hollowing {
    std::shared_ptr<const Removal> removed;  ///< for Settings::removed
    int cavities = 0, drains = 0;
    double volume_mm3 = 0;              ///< of cavities, without drains
    std::vector<std::string> warnings;  ///< cavities that are too low for their drains, or that no drain leads out of
};

/// The volume to remove from a part that is sliced with `settings`: everything at least the wall thickness away from
/// all space outside the part (the platform counts as outside), whatever the material. Computed on cells of about a
/// tenth of the wall, no lower than a layer (exact squared distances by Felzenszwalb and Huttenlocher 2012), rounded to
/// the safe side: no wall, floor or ceiling is thinner than requested, some are up to two cells thicker. Every cavity
/// that is high enough gets two drains, at its lowest and its highest place, sideways by the shortest way along x or y
/// of the image out of the part: not into a void inside of it, nor past its outer face. Errors: check(), what
/// Slicer::prepare rejects, no place thick enough, cancellation. Memory: 15 bytes per cell, at most 60 million cells
/// (beyond, coarser cells are used).
[[nodiscard]] Result<Hollowing> hollow_out(std::span<const Body> part, const Settings& settings,
                                           const HollowSettings& hollow, Progress& progress);

}  // namespace pliant::slice
