// The numbers that a state is a function of: what the controls ask for, and what the robot is made of.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// A number, by what it belongs to. Made by inputs() and parameters(), which say what there is.
struct Parameter {
    enum class Kind {
        // Of the controls.
        length,          ///< that a cable is wanted to have, m: of one with friction its true length
        tension,         ///< that a cable is given, N
        volume,          ///< that a chamber is wanted to have, m^3
        pressure,        ///< that a chamber or a load is given, Pa
        gas,             ///< sealed in a chamber: absolute pressure times volume, J
        support_share,   ///< of a support's motion
        load_share,      ///< of a load's force
        gravity_share,   ///< of gravity
        obstacle_share,  ///< of an obstacle's motion
    };
    Kind kind = Kind::length;
    std::size_t index = 0;  ///< of the actuator (first cables, then chambers, then pressure loads), support, load, ...
    std::string name;       ///< cable "left": length
    std::string unit;       ///< "" for a plain number
    double value = 0;       ///< at this state
};

/// Every number that a controller may change.
[[nodiscard]] std::vector<Parameter> inputs(const Linearisation& at);

/// How the equations change with it. The wanted length of a slack cable does nothing.
[[nodiscard]] Derivative derivative(Linearisation& at, const Parameter& by);

}  // namespace pliant::sim
