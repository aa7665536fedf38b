// The devices of a running print: a wire, a projector and a clock. They have the only virtual functions of the printing
// side, because they are what is replaced: by the virtual printer, by tests, by other hardware.
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
    /// Sends all of `bytes`; anything less is an error.
    [[nodiscard]] virtual Status write(std::string_view bytes) = 0;
    /// What has arrived; waits up to `timeout_s` for the first byte. "" if nothing came in time; an error if the wire
    /// broke.
    [[nodiscard]] virtual Result<std::string> read(double timeout_s) = 0;
    /// Deliberately resets the controller: its position is lost.
    [[nodiscard]] virtual Status reset() { return failure("this wire cannot reset the controller"); }
};

/// An exposure as the projector measured it, from the frames that it presented.
struct Light {
    double asked_s = 0;
    double on_s = 0;             ///< from the first lit frame to the first black one
    int frames = 0;              ///< number of lit frames
    double frame_s = 0;          ///< nominal time of a frame
    double longest_frame_s = 0;  ///< longest of the lit frames: over `frame_s` if one was late
};

class Projector {
public:
    virtual ~Projector() = default;
    /// Shows the image until black() or another show(). Returns once it is on its way to the panel.
    [[nodiscard]] virtual Status show(const job::Image& image) = 0;
    /// Turns the light off. Harmless when it is off.
    [[nodiscard]] virtual Status black() = 0;

    /// As show(), but the projector itself turns dark after `seconds` (above 0), even if the host dies. A projector
    /// without its own timing stays lit until finish().
    [[nodiscard]] virtual Status show_for(const job::Image& image, double /*seconds*/) { return show(image); }
    /// Waits until the exposure of show_for() has ended by itself. nullopt: the projector has no timing of its own, and
    /// is black now.
    [[nodiscard]] virtual Result<std::optional<Light>> finish() {
        if (Status status = black(); !status) return tl::unexpected(status.error());
        return std::nullopt;
    }
};

class Clock {
public:
    virtual ~Clock() = default;
    [[nodiscard]] virtual double now() const = 0;  ///< seconds since a fixed start; never decreases
    virtual void sleep(double seconds) = 0;
};

}  // namespace pliant::host
