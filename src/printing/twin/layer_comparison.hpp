// One layer of the block against what the job asks for there, voxel by voxel: how much of each pixel cured in which
// resin, and how long it was lit. It works on runs of equal pixels; where all pictures are as asked, only on their
// sums.
#pragma once

#include <vector>

#include "printing/twin/runs.hpp"

namespace pliant::twin {

/// What an image asks for. Resins are numbers; the same one may be in several vats and of several materials.
struct AskedImage {
    int resin = 0;
    Runs runs;           ///< coverage
    double seconds = 0;  ///< of light
};

/// A picture that was shown in a resin, and for how long.
struct ShownPicture {
    int resin = 0;
    const Runs* runs = nullptr;  ///< coverage; must outlive the call
    double seconds = 0;
    int pieces = 1;  ///< in which it was given
};

/// Pixels are counted once for each resin of which they have too much or too little.
struct LayerDifference {
    struct OfImage {
        long long light = 0;    ///< grey values asked for: 255 for a whole pixel
        long long foreign = 0;  ///< of that, cured in another resin
        long long missing = 0;  ///< of that, not at all
    };
    std::vector<OfImage> images;             ///< parallel to what was asked
    long missing_px = 0;                     ///< less of a resin than asked, and no other in its place
    long foreign_px = 0;                     ///< less than asked, and another resin there
    long stray_px = 0;                       ///< more of a resin than asked, and it is in no other's place
    long wrong_px = 0;                       ///< more or less of a resin than asked
    long wrong_dose_px = 0;                  ///< as much as asked, lit longer or shorter
    double least_share = 1, most_share = 1;  ///< of the asked time, of those
};

/// Whether a light was as long as asked: within 1 % and `slack_s`. A dose that is 1 % off moves the depth that it cures
/// by 1 % of the resin's depth of penetration, about a micrometre. One that was given in several pieces must not have
/// been given twice, however little the clock is worth: half as much more is the most.
[[nodiscard]] bool is_right_dose(double asked_s, double lit_s, int pieces, double slack_s);

[[nodiscard]] LayerDifference difference(const std::vector<AskedImage>& asked, const std::vector<ShownPicture>& shown,
                                         double slack_s);

}  // namespace pliant::twin
