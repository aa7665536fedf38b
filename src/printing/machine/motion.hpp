// Duration of moves: trapezoidal speed profiles, every move from rest to rest; with jerk, from the speed that the axes
// may gain or lose instantly.
//
// The axes of a move start and end together, on a straight line. Speed and acceleration along that line are the highest
// that keep every axis within its own limits; the feed rate bounds the speed further. The machine is assumed to stop
// between moves: they are reversals or end at a fence, where a planner's look-ahead gains nothing.
#pragma once

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// A speed profile along a straight line.
struct Profile {
    double length_mm = 0;
    double speed_mm_s = 0;  ///< reached only if the line is long enough
    double acceleration_mm_s2 = 0;
    double jerk_mm_s = 0;  ///< speed at start and end

    [[nodiscard]] double seconds() const;
    /// Fraction of the path done after `t_s` seconds, 0 to 1.
    [[nodiscard]] double share_at(double t_s) const;
    /// Seconds until that fraction of the path, 0 to 1, is done.
    [[nodiscard]] double seconds_to(double share) const;
};

/// `feed_mm_s` along the path; 0: as fast as the axes can.
[[nodiscard]] Profile profile(const Printer& printer, const Position& from, const Position& to, double feed_mm_s);

[[nodiscard]] double move_seconds(const Printer& printer, const Position& from, const Position& to, double feed_mm_s);

/// Position after `t_s` seconds of a move from `from` to `to`.
[[nodiscard]] Position position_at(const Profile& profile, const Position& from, const Position& to, double t_s);

/// Homing an axis from `from_um`, at constant homing speed.
[[nodiscard]] double home_seconds(const Printer& printer, Axis axis, int from_um);

}  // namespace pliant::machine
