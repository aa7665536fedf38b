// Outlines that are moved so that what the printer cures has the size of the drawing.
#pragma once

#include <span>

#include "printing/slice/body.hpp"
#include "printing/slice/compose.hpp"

namespace pliant::slice {

/// By how much the outer borders of a material move. Borders between materials stay where they are.
struct Compensation {
    double grow_um = 0;   ///< outwards; negative: inwards
    double foot_um = 0;   ///< elephant foot: inwards in the first layer, evenly less in the `foot_layers` - 1 above it
    int foot_layers = 0;  ///< from the platform
    double bleed_um = 0;  ///< light that goes deeper than its layer: undersides are left out by so much

    /// Outwards in a layer; 0 where nothing moves.
    [[nodiscard]] double offset_um(int layer) const;
    bool operator==(const Compensation&) const = default;
};

/// Refuses what is not finite, beyond 10 mm, or a foot that grows. The message starts with `where`.
[[nodiscard]] Status check(const Compensation& compensation, const std::string& where);

/// How many fine pixels the edge of a pixel is cut into: 16, or less where an image would pass 65535 fine pixels.
[[nodiscard]] int fine_factor(const Raster& raster);
/// The same picture in fine pixels.
[[nodiscard]] Raster refined(const Raster& raster, int factor);

/// Moves outer borders. `fine` is a layer composed on refined(raster, factor) without anti-aliasing, `offset_um` per
/// material. Offsets are those of sets of fine pixels (run_set.hpp), rounded to whole fine pixels: straight borders
/// move by the offset to 1 / (2 factor) of a pixel, corners that grow are rounded, thin walls that shrink vanish, and a
/// slanted border is true to half a fine pixel. Where two materials grow into the same place the later one has it. A
/// pixel then goes whole to the material that covers most of it, as in compose(), at the light of all of its fine
/// pixels; gaps between materials are closed before anything moves.
[[nodiscard]] ComposedLayer compensated(const ComposedLayer& fine, int factor, std::span<const double> offset_um,
                                        const Raster& raster, const ComposeRules& rules);

}  // namespace pliant::slice
