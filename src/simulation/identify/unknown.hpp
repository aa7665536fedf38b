// Numbers of a robot that can be identified from measurements, named by the keys of the robot file, as for `--set`.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"

namespace pliant::sim::identify {

/// The coordinate u in which the search steps, and the value as a function of it.
enum class Scale {
    linear,     ///< size * u: for offsets, loads
    log,        ///< exp(u): for positive values
    from_zero,  ///< size * sinh(u): for values that may be 0; linear there, and logarithmic far above `size`
    poisson,    ///< (1 - exp(-u)) / 2: Poisson's ratio; exp(u) is proportional to the bulk modulus at a given E
};

struct Unknown {
    std::string key;   ///< as `--set` takes it
    std::string unit;  ///< SI, as the robot file writes it; "" if dimensionless
    double value = 0;  ///< initial value of the search, in that unit
    double low = 0, high = 0;
    Scale scale = Scale::log;
    double size = 1;  ///< change of the value for a change of 1 in u, for Scale::linear, and for Scale::from_zero at 0,
                      ///< in that unit; otherwise 1

    [[nodiscard]] double coordinate(double of_value) const;
    /// For Scale::from_zero at least a billionth of the size: a robot with a friction of 0 has none, and no derivative.
    [[nodiscard]] double value_at(double u) const;
    /// The nearest value within the bounds.
    [[nodiscard]] double clamped(double of_value) const { return std::clamp(of_value, low, high); }
    /// d(value)/du at this value.
    [[nodiscard]] double rate(double of_value) const;
    /// "KEY=VALUE" with full precision.
    [[nodiscard]] std::string assignment(double of_value) const;
    /// Value with unit for people: "0.2638 MPa".
    [[nodiscard]] std::string shown(double of_value) const;
};

/// All numbers of the robot that can be identified: of its materials, actuators, springs, loads, contact and damping.
[[nodiscard]] std::vector<Unknown> possible_unknowns(const robot::Robot& robot);

/// From "KEY" or "KEY=LOW..HIGH", with units if the key has one. If the robot's value lies outside the bounds, the
/// search starts in the middle. Errors: no such number in this robot; invalid bounds; a number that is 0 and must be
/// positive to be identified.
[[nodiscard]] Result<Unknown> find_unknown(const robot::Robot& robot, std::string_view text);

/// All of them, or the first error.
[[nodiscard]] Result<std::vector<Unknown>> find_unknowns(const robot::Robot& robot,
                                                         const std::vector<std::string>& texts);

}  // namespace pliant::sim::identify
