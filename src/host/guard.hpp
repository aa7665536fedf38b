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
    /// It is about to go on.
    virtual void lit(long light) = 0;
    /// It is off.
    virtual void dark() = 0;
    /// What the guard of an earlier host has seen of light number `light` when that host died: when, on the devices'
    /// clock, it went dark, by the guard's doing or before; `never_lit`: it had not gone on. nullopt: nobody saw.
    [[nodiscard]] virtual std::optional<double> dark_at(long light) = 0;

    static constexpr double never_lit = -1;
};

}  // namespace pliant::host
