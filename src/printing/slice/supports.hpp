// Supports under what would begin in mid-air or hang over, and a raft under them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/slice/slicer.hpp"
#include "printing/slice/support_paint.hpp"

namespace pliant::slice {

struct SupportSettings {
    std::string material;
    double angle_deg = 45;     ///< undersides that lie flatter than this above the platform need tips; 0: islands only
    double spacing_um = 3000;  ///< between tips, at most
    double tip_um = 400;       ///< diameter where a tip touches the part; not less than two pixels
    double pillar_um = 1000;   ///< diameter below
    double raft_um = 0;        ///< thickness of a plate under all pillars; 0: none
    std::vector<SupportTouch> paint{};  ///< by hand, on the part as it stands
};

/// Refuses diameters, distances and thicknesses that are not above 0 and at most 50 mm (raft: 0 to 20 mm), a tip wider
/// than its pillar, an angle that is not 0 to 89 degrees, paint that check() refuses.
[[nodiscard]] Status check(const SupportSettings& supports);

struct Supports {
    std::vector<Body> bodies;  ///< fillers, one for each tip and strut, and the raft; to be put before the part's
    int tips = 0;
    int painted = 0;  ///< of those, tips where somebody has painted that there be some
    int struts = 0;
    int on_part = 0;  ///< of the tips, those whose pillar stands on the part, as the way to the platform is barred
    int islands_left = 0;
    double volume_mm3 = 0;  ///< of the fillers, less what the part keeps
};

/// Supports of a part that stands on the platform or, with `settings` as it will be sliced, hangs above it. Each tip
/// ends at the part's lowest layer over a pixel that nothing holds: of every island one near its middle, and of
/// undersides so many that none of their pixels is farther than the spacing from a tip; where it was painted by hand,
/// there are tips under any underside, or none, not even of an island. From there a cone goes down to
/// a pillar, upright to the platform, with a foot; where the part is in the way it stands on the part with a second
/// tip. Slender pillars are braced (braces()); one that nothing near can hold, on the platform, gets a foot a twentieth
/// as wide as it is long and tapers. Then part and supports are sliced together, and islands that are left get tips in
/// turn, for at most `support_rounds` rounds. The part keeps what it shares with supports. Deterministic. Errors:
/// check(), what Slicer::prepare refuses, more than 20000 tips, cancellation. Cost: a few times that of slicing.
inline constexpr int support_rounds = 6;
[[nodiscard]] Result<Supports> make_supports(std::span<const Body> part, const Settings& settings,
                                             const SupportSettings& supports, Progress& progress);

}  // namespace pliant::slice
