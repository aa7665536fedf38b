// Who makes dark when the host dies in the middle of a light, and knows how long it was on: a process of its own that
// waits for the end of a pipe.
#pragma once

#include <optional>

namespace pliant::host {

class Guard {
public:
    virtual ~Guard() = default;
    /// Light number `light` (of the journal) is about to be noted; it is not on yet.
    virtual void announced(long light) = 0;
    /// It goes on now, on the devices' clock.
    virtual void lit(double now_s) = 0;
    /// It is off.
    virtual void dark(double now_s) = 0;
    /// For how long light number `light` was on when the host died that had announced it, as the guard of that host saw
    /// it; 0: it had not gone on. nullopt: nobody saw.
    [[nodiscard]] virtual std::optional<double> lit_s(long light) = 0;
};

}  // namespace pliant::host
