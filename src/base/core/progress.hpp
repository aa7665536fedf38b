// Progress reports from long-running work to its caller, and cancellation. The library never prints.
#pragma once

#include <string_view>

namespace pliant {

/// The base class reports nothing and never cancels; the command line and the tests derive from it.
class Progress {
public:
    virtual ~Progress() = default;
    /// `stage` names the work ("mesh", "simulate"), `fraction` is in [0, 1]. May be called from the calling thread
    /// only.
    virtual void advance(std::string_view stage, double fraction) {
        (void)stage;
        (void)fraction;
    }
    /// True once the caller wants the work to stop; polled between pieces of work. May be called from any thread.
    [[nodiscard]] virtual bool cancelled() const { return false; }
};

}  // namespace pliant
