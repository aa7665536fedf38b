#include "printing/twin/motors.hpp"

#include <algorithm>

namespace pliant::twin {
namespace {

constexpr std::size_t most_moves = 15;  // one less than Marlin's BLOCK_BUFFER_SIZE of 16

}  // namespace

using machine::Axis;
using machine::Position;

Motors::Motors(const machine::Printer& printer, const Position& start)
    : printer_(&printer), interlock_(printer, start) {}

void Motors::forget_done(double now_s) {
    while (!moves_.empty() && moves_.front().end_s <= now_s) moves_.pop_front();
}

Status Motors::move(double now_s, const Position& to, double feed_mm_s) {
    forget_done(now_s);
    Move move{0, 0, interlock_.position(), to, {}, interlock_};
    if (Status status = interlock_.move(to); !status) return status;
    move.profile = machine::profile(*printer_, move.from, to, feed_mm_s);
    move.start_s = std::max(now_s, done_at_s_);
    move.end_s = move.start_s + move.profile.seconds();
    done_at_s_ = move.end_s;
    moves_.push_back(std::move(move));
    return {};
}

Status Motors::home(double now_s, Axis axis) {
    done_at_s_ = std::max(done_at_s_, now_s);
    return interlock_.home(axis);
}

double Motors::home_seconds(Axis axis) const {
    return machine::home_seconds(*printer_, axis, interlock_.position()[axis]);
}

double Motors::room_at(double now_s) {
    forget_done(now_s);
    if (moves_.size() < most_moves) return now_s;
    return moves_[moves_.size() - most_moves].end_s;
}

Position Motors::position_at(double now_s) const {
    for (const Move& move : moves_) {
        if (now_s < move.end_s) return machine::position_at(move.profile, move.from, move.to, now_s - move.start_s);
    }
    return interlock_.position();
}

void Motors::stop(double now_s) {
    forget_done(now_s);
    const Position here = position_at(now_s);
    if (!moves_.empty()) {
        const machine::Interlock before = moves_.front().before;
        interlock_ = before;
    }
    interlock_.stopped_at(here);
    moves_.clear();
    done_at_s_ = now_s;
}

}  // namespace pliant::twin
