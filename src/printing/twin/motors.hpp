// The virtual machine's motors: moves wait in a queue, run one after the other on the virtual clock, and are held
// against the interlocks when they are queued.
#pragma once

#include <deque>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/motion.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::twin {

/// Times are seconds of the virtual clock and never go back from call to call. The printer must outlive it.
class Motors {
public:
    Motors(const machine::Printer& printer, const machine::Position& start);

    /// Queues a move; a forbidden one is refused and leaves everything as it is.
    [[nodiscard]] Status move(double now_s, const machine::Position& to, double feed_mm_s);
    /// Homes at once: the caller has let `home_seconds` pass.
    [[nodiscard]] Status home(double now_s, machine::Axis axis);
    [[nodiscard]] double home_seconds(machine::Axis axis) const;

    /// When the last queued move is done; now or earlier if the machine stands still.
    [[nodiscard]] double done_at() const { return done_at_s_; }
    /// When the queue takes another move.
    [[nodiscard]] double room_at(double now_s);
    [[nodiscard]] bool moving(double now_s) const { return now_s < done_at_s_; }

    /// Where the axes are at a moment that is not before the last one asked for.
    [[nodiscard]] machine::Position position_at(double now_s) const;

    /// Drops the queue and stands where the machine is; it must be homed again.
    void stop(double now_s);
    /// The motors let go: positions are lost.
    void release(double now_s) { stop(now_s); }

    [[nodiscard]] machine::Interlock& interlock() { return interlock_; }
    [[nodiscard]] const machine::Interlock& interlock() const { return interlock_; }

private:
    struct Move {
        double start_s = 0;
        double end_s = 0;
        machine::Position from, to;
        machine::Profile profile;
        machine::Interlock before;  ///< to go back to if the move never runs to its end
    };
    void forget_done(double now_s);

    const machine::Printer* printer_;
    machine::Interlock interlock_;
    std::deque<Move> moves_;
    double done_at_s_ = 0;
};

}  // namespace pliant::twin
