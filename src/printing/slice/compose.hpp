// Who owns a pixel: from the coverage of all bodies to one image per material.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "printing/slice/coverage.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::slice {

struct ComposeRules {
    bool anti_alias = true;
    double threshold = 0.5;    ///< without anti-aliasing: pixels covered at least so much get full light
    double close_gap_um = 20;  ///< see compose()
};

struct MaterialImage {
    int material = 0;
    RunImage image;
    std::int64_t value_sum = 0;   ///< of all pixels, for the area
    std::int64_t shared_sum = 0;  ///< of those that another material's image lights too, on purpose
};

/// How a blended body was dealt out, in whole pixels of light.
struct DealtBody {
    int body = 0;
    double first_px = 0, second_px = 0;
};

struct ComposedLayer {
    std::vector<MaterialImage> images;  ///< ordered by material; blank ones are left out
    std::vector<double> lost_px;        ///< (bodies), area that later bodies of other materials took from each, pixels
    std::int64_t closed_gap_pixels = 0;
    bool overlapping = false;          ///< there are pixels of which outlines cover more than there is
    std::vector<double> doubled_px{};  ///< (bodies), area that later bodies of the same material, or itself, cover too
    std::vector<DealtBody> dealt{};    ///< of bodies that have a blend
};

/// The images (materials) that are not blank.
[[nodiscard]] std::vector<MaterialImage> lit_images(std::vector<RunImage> images);

/// The image of a material; null where the layer has none.
[[nodiscard]] const MaterialImage* find(const ComposedLayer& layer, int material);
[[nodiscard]] MaterialImage* find(ComposedLayer& layer, int material);

/// Paints one layer. `cells` as CellBuffer::sorted() gives them; `material_of` names each body's material.
///
/// A body covers |winding| of a pixel, at most 1 (the nonzero rule). Where outlines cover more than a pixel they
/// overlap: `overlapping` says so, later bodies are served first, and a pixel that outer borders of both pass through
/// gets too much; divided() makes outlines that do not overlap, which is exact. `lost_px` and `doubled_px` are 0 here.
/// The pixel goes whole to the material with the largest share (the one with the latest body on a tie), at the light
/// of all shares together: an interface between materials has neither a dark line nor a pixel in two images.
///
/// Where a gap of up to `close_gap_um` between different materials runs through a pixel or along its border, the pixel
/// gets full light: one that misses at most that width and lies, in its row or its column, between two pixels of
/// different materials, one of them full and the other missing no more than that either.
[[nodiscard]] ComposedLayer compose(const std::vector<Cell>& cells, std::span<const int> material_of,
                                    const Raster& raster, const ComposeRules& rules);

}  // namespace pliant::slice
