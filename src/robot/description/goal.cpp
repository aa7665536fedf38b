#include "robot/description/goal.hpp"

#include <fmt/format.h>

namespace pliant::robot {

std::string late_time(const GoalSpec& goal, double duration) {
    if (goal.times.empty() || goal.times.back() <= duration * (1 + 1e-9)) return {};
    return fmt::format("has a time of {:g} s, and the program ends at {:g} s", goal.times.back(), duration);
}

}  // namespace pliant::robot
