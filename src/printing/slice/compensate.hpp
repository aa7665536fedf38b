// Moves outlines so that the cured part has the drawn size.
#pragma once

#include <span>

#include "printing/slice/body.hpp"
#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// Offset of the outer borders of a material. Borders between materials do not move.
struct Compensation {
    double grow_um = 0;   ///< outwards; negative: inwards
    double foot_um = 0;   ///< elephant foot: inwards in the first layer, decreasing linearly in the `foot_layers` - 1
                          ///< above it
    int foot_layers = 0;  ///< counted from the platform
    double bleed_um = 0;  ///< cure depth beyond the layer: undersides are left out by this height

    /// Outward offset in a layer; 0 if nothing moves.
    [[nodiscard]] double offset_um(int layer) const;
    bool operator==(const Compensation&) const = default;
};

/// How far a body of this many layers grows outwards; 0 if it does not.
[[nodiscard]] double growth_um(const Compensation& compensation, int layers);

/// "body 1 (soft), grown by its xy_compensation of 0.5 mm"; the label alone where nothing grows.
[[nodiscard]] std::string grown_label(const std::string& label, double growth_um);

/// Errors: a value that is not finite or beyond 10 mm, or a foot that grows. The message starts with `where`.
[[nodiscard]] Status check(const Compensation& compensation, const std::string& where);

/// Subdivisions of a pixel's edge into fine pixels: 16, or fewer if an image would exceed 65535 fine pixels.
[[nodiscard]] int fine_factor(const Raster& raster);
/// The same raster in fine pixels.
[[nodiscard]] Raster refined(const Raster& raster, int factor);

/// Moves outer borders. `fine` is a layer composed on refined(raster, factor) without anti-aliasing, `offset_um` per
/// material. Offsets are those of sets of fine pixels (run_set.hpp), rounded to whole fine pixels: straight borders
/// move by the offset to within 1 / (2 factor) of a pixel, growing corners are rounded, shrinking thin walls vanish,
/// and a slanted border is accurate to half a fine pixel. Where two materials grow into the same place the later one
/// gets it. A pixel then goes entirely to the material that covers most of it, as in compose(), with the light of all
/// of its fine pixels; gaps between materials are closed before anything moves.
[[nodiscard]] ComposedLayer compensated(const ComposedLayer& fine, int factor, std::span<const double> offset_um,
                                        const Raster& raster, const ComposeRules& rules);

}  // namespace pliant::slice
