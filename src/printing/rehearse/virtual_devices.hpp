// A virtual printer as the devices of a running print: the host's wire ends in the twin, its projector lights the
// twin's resin, its clock is the twin's. Nothing takes wall time: waiting moves the virtual clock on. All refer to the
// twin, which must outlive them.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "printing/twin/twin.hpp"
#include "printing/wire/devices.hpp"
#include "printing/wire/guard.hpp"

namespace pliant::rehearse {

class TwinWire final : public host::Wire {
public:
    /// `look` is called whenever the host listens, before the clock moves: the moment for what people do meanwhile; may
    /// be empty.
    explicit TwinWire(twin::Twin& twin, std::function<void()> look = {}) : twin_(twin), look_(std::move(look)) {}
    [[nodiscard]] Status write(std::string_view bytes) override;
    /// Runs the virtual clock until the twin says something, at most for `timeout_s`.
    [[nodiscard]] Result<std::string> read(double timeout_s) override;

private:
    twin::Twin& twin_;
    std::function<void()> look_;
};

class TwinProjector final : public host::Projector {
public:
    explicit TwinProjector(twin::Twin& twin) : twin_(twin) {}
    [[nodiscard]] Status show(const job::Image& image) override;
    [[nodiscard]] Status black() override;

private:
    twin::Twin& twin_;
};

class TwinClock final : public host::Clock {
public:
    explicit TwinClock(twin::Twin& twin) : twin_(twin) {}
    [[nodiscard]] double now() const override { return twin_.now(); }
    void sleep(double seconds) override { twin_.advance_to(twin_.now() + seconds); }

private:
    twin::Twin& twin_;
};

/// Sees of every light what the guard's process sees, and like it answers only when the host has died.
class TwinGuard final : public host::Guard {
public:
    explicit TwinGuard(const twin::Twin& twin) : twin_(twin) {}
    void announced(long light) override;
    void lit(double now_s) override;
    void dark(double now_s) override;
    [[nodiscard]] std::optional<double> lit_s(long light) override;
    /// Now; the light goes out with it.
    void host_died();

private:
    const twin::Twin& twin_;
    long light_ = 0, seen_ = -1;
    double lit_at_s_ = 0;
    std::optional<double> on_s_;  ///< of that light; nullopt: it is on
    double seen_on_s_ = 0;
};

}  // namespace pliant::rehearse
