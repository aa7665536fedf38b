// Numbers of a robot that can be found from measurements, by the keys of the robot file that `--set` names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "robot/description/robot.hpp"

namespace pliant::sim::identify {

/// The coordinate u in which the search takes its steps; the value is
enum class Scale {
    linear,   ///< size * u: offsets, loads
    log,      ///< exp(u): what is above zero
    poisson,  ///< (1 - exp(-u)) / 2: Poisson's ratio; exp(u) is proportional to the bulk modulus at a given E
};

struct Unknown {
    std::string key;   ///< as `--set` takes it
    std::string unit;  ///< SI, as the robot file writes it; "" of a plain number
    double value = 0;  ///< where the search begins, in that unit
    double low = 0, high = 0;
    Scale scale = Scale::log;
    double size = 1;  ///< in that unit: of Scale::linear, how much a change of 1 in u is; of others 1

    [[nodiscard]] double coordinate(double of_value) const;
    [[nodiscard]] double value_at(double u) const;
    /// d(value)/du.
    [[nodiscard]] double rate(double of_value) const;
    /// "KEY=VALUE" with all digits.
    [[nodiscard]] std::string assignment(double of_value) const;
    /// For people: "0.2638 MPa".
    [[nodiscard]] std::string shown(double of_value) const;
};

/// Every number of the robot that could be one: of its materials, actuators, springs, loads, contact and damping.
[[nodiscard]] std::vector<Unknown> possible_unknowns(const robot::Robot& robot);

/// From "KEY" or "KEY=LOW..HIGH", with units where the key has one. A robot whose number lies outside begins in the
/// middle of the bounds. Errors: no such number in this robot; bounds that are none; a number that is 0 and can only be
/// found from above 0.
[[nodiscard]] Result<Unknown> find_unknown(const robot::Robot& robot, std::string_view text);

/// All of them, or the first error.
[[nodiscard]] Result<std::vector<Unknown>> find_unknowns(const robot::Robot& robot,
                                                         const std::vector<std::string>& texts);

}  // namespace pliant::sim::identify
