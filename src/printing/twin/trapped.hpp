// Resin trapped in the part: closed pockets, and cups that hold it when the part is taken out.
//
// The part hangs below the platform as printed: each layer is below the one before. Liquid drains down and sideways,
// never up. A pocket has no outlet at all; a cup has one, but only upwards.
#pragma once

#include <vector>

#include "printing/twin/cure.hpp"

namespace pliant::twin {

/// One connected space. Pixels and heights are those of the job: x to the right, y down in the image, z from the
/// platform.
struct Trapped {
    bool closed = false;  ///< a pocket; otherwise a cup
    double ml = 0;
    int z_begin_um = 0, z_end_um = 0;  ///< height above the platform
    int x_begin_px = 0, x_end_px = 0;
    int y_begin_px = 0, y_end_px = 0;
};

/// Largest first. A pixel is solid if at least half of it cured, in one resin or several; otherwise liquid. Whether air
/// can enter where liquid leaves is not checked. Cost: proportional to the runs.
[[nodiscard]] std::vector<Trapped> trapped_resin(const std::vector<CuredLayer>& layers, int width_px, int height_px,
                                                 double pixel_um);

}  // namespace pliant::twin
