// Turns the light off if the host dies during an exposure, and records how long it was on: a separate process that
// notices the end of a connection.
#pragma once

#include <optional>

#include "base/core/error.hpp"

namespace pliant::host {

class Guard {
public:
    virtual ~Guard() = default;
    /// Exposure number `light` (of the journal) is about to be recorded; it has not started yet.
    /// Errors: there is no guard any more.
    [[nodiscard]] virtual Status announced(long light) = 0;
    /// It starts now, on the devices' clock.
    virtual void lit(double now_s) = 0;
    /// It has ended.
    virtual void dark(double now_s) = 0;
    /// How long exposure number `light` lasted if its host died, as observed by that host's guard; 0: it had not
    /// started. nullopt: not observed.
    [[nodiscard]] virtual std::optional<double> lit_s(long light) = 0;
    /// A new print begins, which counts its exposures anew: nothing observed before is about them.
    virtual void forget() = 0;
};

}  // namespace pliant::host
