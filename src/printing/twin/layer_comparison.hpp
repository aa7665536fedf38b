// Compares one layer of the block with the job, voxel by voxel: how much of each pixel cured in which resin, and its
// exposure. Works on runs of equal pixels; where all images are as required, only on their sums.
#pragma once

#include <vector>

#include "printing/twin/runs.hpp"

namespace pliant::twin {

/// What an image requires. Resins are numbers; the same one may be in several vats and used by several materials.
struct AskedImage {
    int resin = 0;
    Runs runs;           ///< coverage
    double seconds = 0;  ///< of light
};

/// An image shown in a resin, and for how long.
struct ShownPicture {
    int resin = 0;
    const Runs* runs = nullptr;  ///< coverage; must outlive the call
    double seconds = 0;
    int pieces = 1;  ///< number of pieces of the exposure
};

/// Pixels are counted once for each resin of which they have too much or too little.
struct LayerDifference {
    struct OfImage {
        long long light = 0;    ///< required grey values: 255 for a whole pixel
        long long foreign = 0;  ///< part of it that cured in another resin
        long long missing = 0;  ///< part of it that did not cure
    };
    std::vector<OfImage> images;             ///< parallel to the required images
    long missing_px = 0;                     ///< less of a resin than required, and no other in its place
    long foreign_px = 0;                     ///< less than required, and another resin there
    long stray_px = 0;                       ///< more of a resin than required, in no other's place
    long wrong_px = 0;                       ///< more or less of a resin than required
    long wrong_dose_px = 0;                  ///< correct resin, but exposed longer or shorter
    double least_share = 1, most_share = 1;  ///< ratio of actual to required exposure, over those
};

/// Whether an exposure was as long as required: within 1 % and `slack_s`. A dose that is 1 % off changes the cure depth
/// by 1 % of the resin's depth of penetration, about a micrometre. An exposure in several pieces must not have been
/// given twice, however inaccurate the clock: at most 1.5 times the required time.
[[nodiscard]] bool is_right_dose(double asked_s, double lit_s, int pieces, double slack_s);

[[nodiscard]] LayerDifference difference(const std::vector<AskedImage>& asked, const std::vector<ShownPicture>& shown,
                                         double slack_s);

}  // namespace pliant::twin
