// The virtual printer as a device: its clock follows the wall's, as fast as asked, and its projector a folder.
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
    std::function<bool()> stop;           ///< asked many times a second
    std::function<Status(Twin&)> lights;  ///< called as often: sees what the projector shows; may be empty
    std::function<void(std::string_view bytes, bool from_host)> log;  ///< what goes over the wire; may be empty
    std::function<void(double now_s)> tick{};  ///< called as often, with the machine's clock; may be empty
    /// A wall time that passed between two looks counts as no more than this: on a busy computer the machine's clock
    /// lags then, instead of jumping. For hosts that share it.
    double longest_step_s = 1e9;
};

/// Runs `twin` at the machine's end of `pty` until `stop` says so. Errors: the pseudo-terminal broke, or `lights` did.
[[nodiscard]] Status serve(Twin& twin, Pty& pty, const ServeOptions& options);

}  // namespace pliant::twin
