// What a running print is connected to: a wire, a projector and a clock. The only virtual functions of the printing
// side, because these are what is swapped: for the virtual printer, for tests, for other hardware.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"

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
    /// Resets the controller, on purpose only: its position is lost.
    [[nodiscard]] virtual Status reset() { return failure("this wire cannot reset the controller"); }
};

/// A light as the projector measured it, from the frames that it presented.
struct Light {
    double asked_s = 0;
    double on_s = 0;             ///< from the first lit frame to the first black one
    int frames = 0;              ///< that were lit
    double frame_s = 0;          ///< nominal time of a frame
    double longest_frame_s = 0;  ///< of those lit: over `frame_s` where the machine was late
};

class Projector {
public:
    virtual ~Projector() = default;
    /// Lights the image until black() or another show(). Returns once it is on its way to the panel.
    [[nodiscard]] virtual Status show(const job::Image& image) = 0;
    /// No light. Harmless when there is none.
    [[nodiscard]] virtual Status black() = 0;

    /// As show(), and dark again after `seconds` (above 0) by the projector's own doing, whatever becomes of the host.
    /// A projector that keeps no time is left lit; finish() makes it dark.
    [[nodiscard]] virtual Status show_for(const job::Image& image, double /*seconds*/) { return show(image); }
    /// Waits until the light of show_for() is out by itself. nullopt: the projector keeps no time, and is black now.
    [[nodiscard]] virtual Result<std::optional<Light>> finish() {
        if (Status status = black(); !status) return tl::unexpected(status.error());
        return std::nullopt;
    }
};

class Clock {
public:
    virtual ~Clock() = default;
    [[nodiscard]] virtual double now() const = 0;  ///< seconds since some beginning; never goes back
    virtual void sleep(double seconds) = 0;
};

}  // namespace pliant::host
