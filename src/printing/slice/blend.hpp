// Bodies that change from one material to another, pixel by pixel.
#pragma once

#include <utility>

#include "base/core/error.hpp"
#include "printing/slice/body.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::slice {

/// Refuses a blend without a second material, with equal ends, fewer than two shares, a share outside 0 to 1, or cells
/// that are not 1 to 1000 pixels. The message starts with `where`.
[[nodiscard]] Status check(const Blend& blend, const std::string& where);

/// The share of the second material at a place on the platform.
[[nodiscard]] double share_at(const Blend& blend, const Vec3& place_um);

/// Deals the pixels of an image out to the two materials of a blend: first and second. Whole cells of Blend::cell_px
/// pixels change hands, so that no pixel has two owners. Error diffusion (Floyd and Steinberg 1976) from row to row and
/// to and fro, among cells that have light; what finds no neighbour goes to the next cell. So the light of the second
/// material in a layer is the integral of its share to about a cell. Thresholds differ from layer to layer by a fixed
/// hash, lest equal patterns pile up into threads. Cost: the image's rows times its width.
[[nodiscard]] std::pair<RunImage, RunImage> dealt(const RunImage& image, const Blend& blend, const Raster& raster,
                                                  double z_um, int layer);

}  // namespace pliant::slice
