// Bodies that grade from one material to another, pixel by pixel.
#pragma once

#include <utility>

#include "base/core/error.hpp"
#include "printing/slice/body.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::slice {

/// Errors: a blend without second material, with coincident ends, fewer than two shares, a share outside 0 to 1, or
/// cells outside 1 to 1000 pixels. The message starts with `where`.
[[nodiscard]] Status check(const Blend& blend, const std::string& where);

/// The fraction of the second material at a point on the platform.
[[nodiscard]] double share_at(const Blend& blend, const Vec3& place_um);

/// Divides the pixels of an image between the two materials of a blend: first and second. Whole cells of Blend::cell_px
/// pixels are assigned, so that no pixel has two owners. Error diffusion (Floyd and Steinberg 1976) in alternating row
/// direction, over lit cells only; an error without unassigned neighbours goes to the next cell. The total light of the
/// second material in a layer thus equals the integral of its fraction to about one cell. Thresholds vary from layer to
/// layer by a fixed hash, so that equal patterns do not stack up into threads. Cost: the image's rows times its width.
[[nodiscard]] std::pair<RunImage, RunImage> dealt(const RunImage& image, const Blend& blend, const Raster& raster,
                                                  double z_um, int layer);

}  // namespace pliant::slice
