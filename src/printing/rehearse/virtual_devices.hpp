// A virtual printer as the devices of a running print: the host's wire leads to the twin, its projector exposes the
// twin's resin, its clock is the twin's. No wall time passes: waiting advances the virtual clock. All refer to the
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
    /// `look` is called whenever the host listens, before the clock advances, so that operator actions can be
    /// simulated; may be empty.
    explicit TwinWire(twin::Twin& twin, std::function<void()> look = {}) : twin_(twin), look_(std::move(look)) {}
    [[nodiscard]] Status write(std::string_view bytes) override;
    /// Advances the virtual clock until the twin sends something, at most by `timeout_s`.
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

/// Receives the same messages as the guard process, and like it reports only once the host has died.
class TwinGuard final : public host::Guard {
public:
    explicit TwinGuard(const twin::Twin& twin) : twin_(twin) {}
    [[nodiscard]] Status announced(long light) override;
    void lit(double now_s) override;
    void dark(double now_s) override;
    [[nodiscard]] std::optional<double> lit_s(long light) override;
    void forget() override { seen_ = -1; }
    /// Simulates the host's death at this moment; the light goes off.
    void host_died();

private:
    const twin::Twin& twin_;
    long light_ = 0, seen_ = -1;
    double lit_at_s_ = 0;
    std::optional<double> on_s_;  ///< duration of that exposure; nullopt: still on
    double seen_on_s_ = 0;
};

}  // namespace pliant::rehearse
