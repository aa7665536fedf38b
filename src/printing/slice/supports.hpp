// Supports under islands and overhangs, and a raft under the supports.
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
    double angle_deg = 45;              ///< undersides at a smaller angle to the platform need tips; 0: islands only
    double spacing_um = 3000;           ///< maximum distance between tips
    double tip_um = 400;                ///< diameter where a tip touches the part; at least two pixels
    double pillar_um = 1000;            ///< diameter of the pillar below
    double raft_um = 0;                 ///< thickness of a plate under all pillars; 0: none
    std::vector<SupportTouch> paint{};  ///< hand-painted, on the part in its present position
};

/// Errors: diameters, distances and thicknesses outside (0, 50] mm (raft: 0 to 20 mm), a tip wider than its pillar, an
/// angle outside 0 to 89 degrees, paint that check() rejects.
[[nodiscard]] Status check(const SupportSettings& supports);

struct Supports {
    std::vector<Body> bodies;  ///< fillers, one for each tip and strut, and the raft; to be put before the part's
                               ///< bodies
    int tips = 0;
    int painted = 0;  ///< of those, tips at hand-painted places
    int struts = 0;
    int on_part = 0;  ///< tips whose pillar stands on the part because the way to the platform is blocked
    int islands_left = 0;
    double volume_mm3 = 0;  ///< of the fillers, without what the part keeps
};

/// Supports of a part that stands on the platform or, with `settings` as for slicing, hangs above it. Each tip ends at
/// the part's lowest layer over an unsupported pixel: one near the middle of every island, and on undersides enough
/// that no pixel is farther than the spacing from a tip. Hand-painted places get tips under any underside, or none, not
/// even under an island. From the tip a cone leads down to a vertical pillar with a foot on the platform; where the
/// part is in the way, the pillar stands on the part with a second tip. Slender pillars are braced (braces()); one on
/// the platform without a neighbour to brace it gets a foot a twentieth as wide as it is long, and a taper. Then part
/// and supports are sliced together, and remaining islands get tips, for at most `support_rounds` rounds. The part
/// keeps what it shares with supports. Deterministic. Errors: check(), what Slicer::prepare rejects, more than 20000
/// tips, cancellation. Cost: a few times that of slicing.
inline constexpr int support_rounds = 6;
[[nodiscard]] Result<Supports> make_supports(std::span<const Body> part, const Settings& settings,
                                             const SupportSettings& supports, Progress& progress);

}  // namespace pliant::slice
