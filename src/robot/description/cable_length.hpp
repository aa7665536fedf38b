// What a cable can be asked for: the limits of its targets, and whether one pays it out.
#pragma once

#include <string_view>

#include "robot/description/drive.hpp"

namespace pliant::robot {

/// Limits of a target, in its own unit, and in words.
struct TargetLimits {
    double low, high;
    std::string_view words;
};

/// Gap elements close gaps and cannot pay a cable out.
[[nodiscard]] constexpr TargetLimits target_limits(CableTarget::Kind kind, bool gap_elements) {
    constexpr double any = 1e300;
    switch (kind) {
        case CableTarget::Kind::length_ratio:
            return gap_elements ? TargetLimits{1e-6, 1, "above 0, at most 1"}
                                : TargetLimits{1e-6, 10, "above 0, at most 10"};
        case CableTarget::Kind::shortening_m:
            return gap_elements ? TargetLimits{0, any, "not below zero"} : TargetLimits{-any, any, "lengths"};
        case CableTarget::Kind::tension_N:
            break;
    }
    return {0, any, "not below zero: a cable can only pull"};
}

/// True for a length beyond that at rest: with it, a cable is slack until others pull the robot so far.
[[nodiscard]] constexpr bool is_paid_out(const CableTarget& target) {
    return target.kind == CableTarget::Kind::length_ratio
               ? target.value > 1
               : target.kind == CableTarget::Kind::shortening_m && target.value < 0;
}

}  // namespace pliant::robot
