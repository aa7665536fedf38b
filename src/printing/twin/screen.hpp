// The coverage that a shown image cures, given the projector's uneven light and the resin's nonlinear response to grey.
// The printer file's `grey` and `mask` say what to show for a wanted coverage; this is the inverse.
#pragma once

#include <array>
#include <optional>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/twin/runs.hpp"

namespace pliant::twin {

/// A pixel shown at v where the mask is m gets light v / m of the brightest even light, and cures the coverage to which
/// `grey` assigns that light.
class Screen {
public:
    /// `mask`: 8-bit grey of the projector's size; nullopt if the printer has none.
    Screen(const machine::Projector& projector, std::optional<job::Image> mask);

    /// Whether the shown value differs from the coverage.
    [[nodiscard]] bool corrects() const { return covered_.has_value() || mask_.has_value(); }

    struct Picture {
        Runs runs;            ///< coverage; 255: the whole pixel
        long overlit_px = 0;  ///< pixels with more light than a whole one needs
    };
    [[nodiscard]] Picture coverage(const Runs& shown) const;

private:
    [[nodiscard]] std::uint16_t coverage_of(int shown, int mask, long& overlit_px) const;

    std::optional<std::array<std::uint8_t, 256>> covered_;  ///< by light; nullopt: equal to the light
    std::optional<job::Image> mask_;
};

}  // namespace pliant::twin
