// The motors of the virtual machine: moves are checked against the interlocks, queued, and run one after the other on
// the virtual clock.
#pragma once

#include <deque>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/interlock.hpp"
#include "printing/machine/motion.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::twin {

/// Times are seconds of the virtual clock and must not decrease from call to call. The printer must outlive it.
class Motors {
public:
    Motors(const machine::Printer& printer, const machine::Position& start);

    /// Queues a move; a forbidden one is refused without any change.
    [[nodiscard]] Status move(double now_s, const machine::Position& to, double feed_mm_s);
    /// Homes at once: the caller has already let `home_seconds` pass.
    [[nodiscard]] Status home(double now_s, machine::Axis axis);
    [[nodiscard]] double home_seconds(machine::Axis axis) const;

    /// When the last queued move ends; now or earlier if the machine is at rest.
    [[nodiscard]] double done_at() const { return done_at_s_; }
    /// When the queue has room for another move.
    [[nodiscard]] double room_at(double now_s);
    [[nodiscard]] bool moving(double now_s) const { return now_s < done_at_s_; }

    /// The position of the axes at a time not before the last one queried.
    [[nodiscard]] machine::Position position_at(double now_s) const;

    /// Clears the queue and stops at the present position; the machine must be homed again.
    void stop(double now_s);
    /// Disables the motors: positions are lost.
    void release(double now_s) { stop(now_s); }

    [[nodiscard]] machine::Interlock& interlock() { return interlock_; }
    [[nodiscard]] const machine::Interlock& interlock() const { return interlock_; }

private:
    struct Move {
        double start_s = 0;
        double end_s = 0;
        machine::Position from, to;
        machine::Profile profile;
        machine::Interlock before;  ///< restored if the move is not finished
    };
    void forget_done(double now_s);

    const machine::Printer* printer_;
    machine::Interlock interlock_;
    std::deque<Move> moves_;
    double done_at_s_ = 0;
};

}  // namespace pliant::twin
