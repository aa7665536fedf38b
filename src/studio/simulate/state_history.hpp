// The states that a robot has passed through, thinned out where there are too many.
#pragma once

#include <cstddef>

#include "simulation/run/trajectory.hpp"

namespace pliant::studio {

class StateHistory {
public:
    /// The first one is kept in any case.
    void add(const sim::Step& step);
    [[nodiscard]] const sim::Trajectory& states() const { return states_; }

private:
    sim::Trajectory states_;
    std::size_t stride_ = 1, seen_ = 0;
};

}  // namespace pliant::studio
