// Who makes dark when the host dies in the middle of a light: a process of its own that waits for the end of a pipe.
#pragma once

#include <optional>

namespace pliant::host {

class Guard {
public:
    virtual ~Guard() = default;
    /// Light number `light` (of the journal) is about to go on.
    virtual void lit(long light) = 0;
    /// It is off.
    virtual void dark() = 0;
    /// When, on the devices' clock, the guard of an earlier host made light number `light` dark; nullopt: nobody saw.
    [[nodiscard]] virtual std::optional<double> dark_at(long light) = 0;
};

}  // namespace pliant::host
