// Ownership of pixels: from the coverage of all bodies to one image per material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "printing/slice/coverage.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::slice {

struct ComposeRules {
    bool anti_alias = true;
    double threshold = 0.5;    ///< without anti-aliasing: pixels covered at least this much get full light
    double close_gap_um = 20;  ///< see compose()
};

struct MaterialImage {
    int material = 0;
    RunImage image;
    std::int64_t value_sum = 0;   ///< of all pixels, for the area
    std::int64_t shared_sum = 0;  ///< of the pixels that another material's image exposes too, on purpose
};

/// How a blended body was divided, in whole pixels of light.
struct DealtBody {
    int body = 0;
    double first_px = 0, second_px = 0;
};

struct ComposedLayer {
    std::vector<MaterialImage> images;  ///< ordered by material; without blank ones
    std::vector<double> lost_px;        ///< (bodies) area that later bodies of other materials took from each, pixels
    std::int64_t closed_gap_pixels = 0;
    bool overlapping = false;          ///< some pixels are covered by more than their area
    std::vector<double> doubled_px{};  ///< (bodies) area also covered by later bodies of the same material or by the
                                       ///< body itself
    std::vector<DealtBody> dealt{};    ///< of bodies that have a blend
    std::vector<double> air_px{};      ///< (bodies, or empty) area that was cut out of each
    std::vector<bool> interlocked{};   ///< (interlocks, or empty) whether each changed a pixel
    std::vector<bool> overlapped{};    ///< (overlaps, or empty) whether each has a pixel exposed twice
};

/// The non-blank ones of the images (one per material).
[[nodiscard]] std::vector<MaterialImage> lit_images(std::vector<RunImage> images);

/// The image of a material; null if the layer has none.
[[nodiscard]] const MaterialImage* find(const ComposedLayer& layer, int material);
[[nodiscard]] MaterialImage* find(ComposedLayer& layer, int material);

/// Composes one layer. `cells` as returned by CellBuffer::sorted(); `material_of` names each body's material.
///
/// A body covers |winding| of a pixel, at most 1 (the nonzero rule). Where outlines cover more than a pixel's area they
/// overlap: `overlapping` says so, later bodies have priority, and a pixel crossed by outer borders of both gets too
/// much; divided() makes outlines that do not overlap, which is exact. `lost_px` and `doubled_px` are 0 here. The pixel
/// goes entirely to the material with the largest share (on a tie, that of the latest body), with the light of all
/// shares together: an interface between materials has neither a dark line nor a pixel in two images.
///
/// Where a gap of up to `close_gap_um` between different materials runs through a pixel or along its border, the pixel
/// gets full light. Condition: it lacks at most that width and is, in its row or its column, between two pixels of
/// different materials, one of them full and the other lacking no more than that.
[[nodiscard]] ComposedLayer compose(const std::vector<Cell>& cells, std::span<const int> material_of,
                                    const Raster& raster, const ComposeRules& rules);

}  // namespace pliant::slice
