// Accelerated time, for a virtual printer with a fast clock: the host's timeouts and exposures shrink with it, or
// follow a clock that the printer moves on.
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <utility>

#include "printing/wire/devices.hpp"

namespace pliant::host {

/// Slower than a tenth, a print would take minutes to answer Ctrl-C: it looks up between waits of the machine's time.
[[nodiscard]] inline Status check_speed(double speed) {
    if (speed >= 0.1 && speed <= 1e6) return {};
    return input_error("--speed {}: must be 0.1 to 1e6", speed);
}

/// `clock` must outlive it; `speed` seconds pass here per second of `clock`.
class ScaledClock final : public Clock {
public:
    ScaledClock(Clock& clock, double speed) : clock_(clock), speed_(speed) {}
    [[nodiscard]] double now() const override { return clock_.now() * speed_; }
    void sleep(double seconds) override { clock_.sleep(seconds / speed_); }

private:
    Clock& clock_;
    double speed_;
};

/// Waits for answers in the time of a ScaledClock, but at least a millisecond, to avoid busy waiting.
class ScaledWire final : public Wire {
public:
    ScaledWire(std::unique_ptr<Wire> wire, double speed) : wire_(std::move(wire)), speed_(speed) {}
    [[nodiscard]] Status write(std::string_view bytes) override { return wire_->write(bytes); }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        constexpr double shortest_s = 0.001;
        return wire_->read(timeout_s > 0 ? std::max(timeout_s / speed_, shortest_s) : 0);
    }
    [[nodiscard]] Status reset() override { return wire_->reset(); }

private:
    std::unique_ptr<Wire> wire_;
    double speed_;
};

/// Waits for answers in the time of a clock that another process moves on; never longer than the same time on this
/// computer's clock, since that process may have died. A clock that has not moved since the wire was opened is that of
/// an earlier process, and an error. `clock` must outlive it.
class ClockedWire final : public Wire {
public:
    ClockedWire(std::unique_ptr<Wire> wire, const Clock& clock, double most_still_s = 5)
        : wire_(std::move(wire)), clock_(clock), first_s_(clock.now()), most_still_s_(most_still_s) {}
    [[nodiscard]] Status write(std::string_view bytes) override { return wire_->write(bytes); }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        if (stands_still()) return failure("the clock does not move; is it that of this printer?");
        constexpr std::chrono::microseconds look_every(200);
        const double end_s = clock_.now() + timeout_s;
        const auto latest = Real::now() + std::chrono::duration<double>(timeout_s);
        for (;;) {
            Result<std::string> bytes = wire_->read(0);
            if (!bytes || !bytes->empty() || clock_.now() >= end_s || Real::now() >= latest) return bytes;
            std::this_thread::sleep_for(look_every);
        }
    }
    [[nodiscard]] Status reset() override { return wire_->reset(); }

private:
    using Real = std::chrono::steady_clock;

    [[nodiscard]] bool stands_still() {
        moved_ = moved_ || clock_.now() != first_s_;
        return !moved_ && Real::now() - opened_ > std::chrono::duration<double>(most_still_s_);
    }

    std::unique_ptr<Wire> wire_;
    const Clock& clock_;
    double first_s_;
    double most_still_s_;
    Real::time_point opened_ = Real::now();
    bool moved_ = false;
};

}  // namespace pliant::host
