// The virtual printer in this program, in the time of people: its clock runs at most `speed` times as fast as the
// wall's, so that a print can be watched.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>

#include "printing/twin/twin.hpp"
#include "printing/wire/devices.hpp"

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
    /// Before anybody waits: the twin is at `virtual_s`, and nobody has to make up for it.
    void begin_at(double virtual_s) { last_virtual_s_ = virtual_s; }
    /// The twin is at `virtual_s`.
    void wait_for(double virtual_s);

private:
    std::atomic<double> speed_;
    std::atomic<bool> free_ = false;
    double last_virtual_s_ = 0;
    std::chrono::steady_clock::time_point due_ = std::chrono::steady_clock::now();
};

/// The twin, for one at a time: who serves the print, who opens its door, who looks at its block.
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
    /// From any thread; the print stands still meanwhile.
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
