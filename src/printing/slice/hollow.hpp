// Parts with walls of a given thickness, and holes that let the resin out.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/slice/slicer.hpp"

namespace pliant::slice {

struct HollowSettings {
    double wall_um = 2000;
    double drain_um = 0;  ///< diameter of the holes; 0: none
};

/// Refuses a wall or a drain that is not above 0 and at most 100 mm (drain: 0 is none).
[[nodiscard]] Status check(const HollowSettings& hollow);

struct Hollowing {
    std::shared_ptr<const Removal> removed;  ///< for Settings::removed
    int cavities = 0, drains = 0;
    double volume_mm3 = 0;              ///< of cavities, without drains
    std::vector<std::string> warnings;  ///< a cavity that is too low for its drain
};

/// What is taken out of a part that is sliced with `settings`: all that lies at least the wall away from every place
/// that the part does not fill, the platform included, whatever the material. Reckoned on cells of about a tenth of the
/// wall (exact squared distances by Felzenszwalb and Huttenlocher 2012), and on the safe side: no wall is thinner than
/// asked for, some are up to a quarter thicker. Every cavity that is high enough gets two drains, one at its lowest and
/// one at its highest place, sideways by the shortest way along x or y of the image. Errors: check(), what
/// Slicer::prepare refuses, nothing that is thick enough, cancellation. Memory: 13 bytes a cell, at most 60 million
/// cells (coarser ones are taken beyond).
[[nodiscard]] Result<Hollowing> hollow_out(std::span<const Body> part, const Settings& settings,
                                           const HollowSettings& hollow, Progress& progress);

}  // namespace pliant::slice
