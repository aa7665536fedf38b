// The virtual printer in this program, in the time of people: its clock runs at most `speed` times as fast as the
// wall's, so that a print can be watched. All of it belongs to the thread that serves the print.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>

#include "host/devices.hpp"
#include "twin/twin.hpp"

namespace pliant::studio {

/// Holds the thread back until the wall's clock has caught up.
class Pace {
public:
    explicit Pace(double speed) : speed_(speed) {}
    /// From any thread; from now on.
    void set_speed(double speed) { speed_ = speed; }
    [[nodiscard]] double speed() const { return speed_; }
    /// Nobody is held back any more: the print is to end.
    void let_go() { free_ = true; }
    /// The twin is at `virtual_s`.
    void wait_for(double virtual_s);

private:
    std::atomic<double> speed_;
    std::atomic<bool> free_ = false;
    double last_virtual_s_ = 0;
    std::chrono::steady_clock::time_point due_ = std::chrono::steady_clock::now();
};

/// Wire, projector and clock of one twin. Errors: none.
class PacedTwin {
public:
    PacedTwin(const machine::Printer& printer, double speed);
    PacedTwin(const PacedTwin&) = delete;
    PacedTwin& operator=(const PacedTwin&) = delete;

    [[nodiscard]] std::unique_ptr<host::Wire> wire();
    [[nodiscard]] host::Projector& projector() { return projector_; }
    [[nodiscard]] host::Clock& clock() { return clock_; }
    [[nodiscard]] Pace& pace() { return pace_; }

private:
    class Projector final : public host::Projector {
    public:
        explicit Projector(twin::Twin& twin) : twin_(twin) {}
        [[nodiscard]] Status show(const job::Image& image) override;
        [[nodiscard]] Status black() override;

    private:
        twin::Twin& twin_;
    };
    class Clock final : public host::Clock {
    public:
        Clock(twin::Twin& twin, Pace& pace) : twin_(twin), pace_(pace) {}
        [[nodiscard]] double now() const override { return twin_.now(); }
        void sleep(double seconds) override;

    private:
        twin::Twin& twin_;
        Pace& pace_;
    };

    twin::Twin twin_;
    Pace pace_;
    Projector projector_;
    Clock clock_;
};

}  // namespace pliant::studio
