// What a running print is connected to: a wire, a projector and a clock. The only virtual functions of the printing
// side, because these are what is swapped: for the virtual printer, for tests, for other hardware.
#pragma once

#include <string>
#include <string_view>

#include "core/error.hpp"
#include "job/job.hpp"

namespace pliant::host {

/// A stream of bytes to and from the controller.
class Wire {
public:
    virtual ~Wire() = default;
    /// Sends all of `bytes`, or fails.
    [[nodiscard]] virtual Status write(std::string_view bytes) = 0;
    /// What has arrived; waits up to `timeout_s` for the first byte. "" if none came in time; an error if the wire
    /// broke.
    [[nodiscard]] virtual Result<std::string> read(double timeout_s) = 0;
};

class Projector {
public:
    virtual ~Projector() = default;
    /// Lights the image until black() or another show(). Returns once it is on its way to the panel.
    [[nodiscard]] virtual Status show(const job::Image& image) = 0;
    /// No light. Harmless when there is none.
    [[nodiscard]] virtual Status black() = 0;
};

class Clock {
public:
    virtual ~Clock() = default;
    [[nodiscard]] virtual double now() const = 0;  ///< seconds since some beginning; never goes back
    virtual void sleep(double seconds) = 0;
};

}  // namespace pliant::host
