// What a shown picture means: how much of each pixel cures, on a projector that is not the same everywhere and a resin
// that does not answer to grey in proportion. The printer file's `grey` and `mask` say what must be shown for a wanted
// coverage; this is the way back.
#pragma once

#include <array>
#include <optional>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/twin/runs.hpp"

namespace pliant::twin {

/// A pixel that is shown v where the mask holds m gets light v / m of the brightest even light, and cures the coverage
/// to which `grey` gives that light.
class Screen {
public:
    /// `mask`: 8-bit grey of the projector's size; nullopt where the printer has none.
    Screen(const machine::Projector& projector, std::optional<job::Image> mask);

    /// Whether what is shown is not the coverage itself.
    [[nodiscard]] bool corrects() const { return covered_.has_value() || mask_.has_value(); }

    struct Picture {
        Runs runs;            ///< coverage; 255: the whole pixel
        long overlit_px = 0;  ///< pixels that get more light than a whole one needs
    };
    [[nodiscard]] Picture coverage(const Runs& shown) const;

private:
    [[nodiscard]] std::uint16_t coverage_of(int shown, int mask, long& overlit_px) const;

    std::optional<std::array<std::uint8_t, 256>> covered_;  ///< by light; nullopt: light is coverage
    std::optional<job::Image> mask_;
};

}  // namespace pliant::twin
