// The virtual printer in this program, slowed down for viewing: its clock runs at most `speed` times as fast as the
// wall clock.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

#include "printing/twin/twin.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::studio {

/// Blocks the thread until the wall clock has caught up.
class Pace {
public:
    explicit Pace(double speed) : speed_(speed) {}
    /// Thread-safe; applies from now on.
    void set_speed(double speed) { speed_ = speed; }
    [[nodiscard]] double speed() const { return speed_; }
    /// Stops pacing, so that the print can end quickly.
    void let_go() { free_ = true; }
    /// Called before anything waits: the twin is at `virtual_s`, and this time is not waited for.
    void begin_at(double virtual_s) { last_virtual_s_ = virtual_s; }
    /// Waits for the wall clock; the twin is at `virtual_s`.
    void wait_for(double virtual_s);

private:
    std::atomic<double> speed_;
    std::atomic<bool> free_ = false;
    double last_virtual_s_ = 0;
    std::chrono::steady_clock::time_point due_ = std::chrono::steady_clock::now();
};

/// The twin with a lock: used by the print, the door control and the display of the block.
struct SharedTwin {
    explicit SharedTwin(const machine::Printer& printer, twin::Options options) : twin(printer, std::move(options)) {}
    std::mutex mutex;
    twin::Twin twin;
};

/// Wire, projector and clock of one twin. Errors: none.
class PacedTwin {
public:
    PacedTwin(const machine::Printer& printer, twin::Options options, double speed);
    PacedTwin(const PacedTwin&) = delete;
    PacedTwin& operator=(const PacedTwin&) = delete;

    [[nodiscard]] std::unique_ptr<host::Wire> wire();
    [[nodiscard]] host::Projector& projector() { return projector_; }
    [[nodiscard]] host::Clock& clock() { return clock_; }
    [[nodiscard]] Pace& pace() { return pace_; }
    /// Thread-safe; the print is paused meanwhile.
    template <class Do>
    auto with(const Do& todo) {
        const std::lock_guard lock(shared_.mutex);
        return todo(shared_.twin);
    }

private:
    class Projector final : public host::Projector {
    public:
        explicit Projector(SharedTwin& shared) : shared_(shared) {}
        [[nodiscard]] Status show(const job::Image& image) override;
        [[nodiscard]] Status black() override;

    private:
        SharedTwin& shared_;
    };
    class Clock final : public host::Clock {
    public:
        Clock(SharedTwin& shared, Pace& pace) : shared_(shared), pace_(pace) {}
        [[nodiscard]] double now() const override;
        void sleep(double seconds) override;

    private:
        SharedTwin& shared_;
        Pace& pace_;
    };

    SharedTwin shared_;
    Pace pace_;
    Projector projector_;
    Clock clock_;
};

}  // namespace pliant::studio
