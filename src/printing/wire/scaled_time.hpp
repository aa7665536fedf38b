// Accelerated time, for a virtual printer with a fast clock: the host's timeouts and exposures shrink with it.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "printing/wire/devices.hpp"

namespace pliant::host {

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

}  // namespace pliant::host
