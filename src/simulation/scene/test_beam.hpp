// The numbers of the beam that several tests write as a robot.
#pragma once

namespace pliant::robot::testing {

inline constexpr double beam_length = 0.1, beam_edge = 0.01;  ///< m
inline constexpr double beam_modulus = 1e6;                   ///< Pa

}  // namespace pliant::robot::testing
