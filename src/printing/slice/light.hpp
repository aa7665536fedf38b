// Converts coverage to the values that a projector must show.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "printing/slice/run_image.hpp"

namespace pliant::slice {

struct LightCorrection {
    std::optional<std::array<std::uint8_t, 256>> grey;  ///< value to show for each grey value; 0 remains 0
    std::optional<Image> mask;  ///< fraction of light that each pixel may get, in 1/255; of the images' size

    [[nodiscard]] bool none() const { return !grey && !mask; }
};

/// Values for 0 to 255 from the light at evenly spaced coverages (fractions of full light, at least two, ascending from
/// 0), interpolated linearly.
[[nodiscard]] std::array<std::uint8_t, 256> grey_values(std::span<const double> light);

/// Applies first the grey values, then the mask. Cost: the runs, and with a mask every lit pixel. Precondition: the
/// mask has the image's size.
[[nodiscard]] RunImage corrected(const RunImage& image, const LightCorrection& correction);

/// The sum of the image's values where the mask is black: what gets no light at all. 0 without a mask. Precondition: as
/// above.
[[nodiscard]] std::int64_t darkened_sum(const RunImage& image, const LightCorrection& correction);

}  // namespace pliant::slice
