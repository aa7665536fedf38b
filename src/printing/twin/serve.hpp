// The virtual printer as a device: its clock follows real time at a given speed, and its projector is a folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "base/core/error.hpp"
#include "printing/twin/pty.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::twin {

struct ServeOptions {
    double speed = 1;                     ///< speed-up factor of the machine's clock; above 0
    std::function<bool()> stop;           ///< polled many times a second
    std::function<Status(Twin&)> lights;  ///< called as often: reads what the projector shows; may be empty
    std::function<void(std::string_view bytes, bool from_host)> log;  ///< receives what goes over the wire; may be
                                                                      ///< empty
    std::function<void(double now_s)> tick{};  ///< called as often, with the machine's clock; may be empty
    /// Upper limit for the real time between two polls: on a busy computer the machine's clock then lags instead of
    /// jumping. For hosts that share it.
    double longest_step_s = 1e9;
};

/// Runs `twin` at the machine's end of `pty` until `stop` returns true. Errors: the pseudo-terminal or `lights` failed.
[[nodiscard]] Status serve(Twin& twin, Pty& pty, const ServeOptions& options);

}  // namespace pliant::twin
