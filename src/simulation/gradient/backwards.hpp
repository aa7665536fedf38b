// Goes backwards over steps that can only be taken forwards, with a few states kept: binomial checkpoints.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>

#include "base/core/error.hpp"

namespace pliant::sim {

/// How many steps can be gone back over with so many states and each step taken forward so many times at most.
[[nodiscard]] inline double reach_back(int states, int times) {
    double count = 1;
    for (int i = 1; i <= states; ++i) count = count * (times + i) / i;
    return count;
}

/// How many times each of `steps` is taken forward at most, with so many states beside the first.
[[nodiscard]] inline int times_forward(int steps, int kept) {
    int times = 1;
    while (reach_back(kept + 1, times) < steps) ++times;
    return times;
}

/// How far to go before the next state is kept, so that no step is taken more often than that. Source: Griewank and
/// Walther 2000, algorithm 799 (revolve).
[[nodiscard]] inline int next_kept(int steps, int kept) {
    const int times = times_forward(steps, kept);
    const double for_others = reach_back(kept, times), here = reach_back(kept + 1, times - 1);
    const double first = std::max(steps - for_others, std::min(here, 0.5 * steps));
    return std::clamp(static_cast<int>(first), 1, steps - 1);
}

/// Calls back(state, k) for each step k from `end` down to begin + 1, with the state before it. `state` is that after
/// step `begin`; forward(state, k) takes the state before step k to that after it. At most `kept` + 2 states exist at
/// once. An error of either ends it.
template <class State>
[[nodiscard]] Status go_back(State state, int begin, int end, int kept,
                             const std::function<Status(State&, int step)>& forward,
                             const std::function<Status(const State&, int step)>& back) {
    while (end - begin > 1 && kept > 0) {
        const int middle = begin + next_kept(end - begin, kept);
        State later = state;
        for (int k = begin + 1; k <= middle; ++k) {
            if (Status status = forward(later, k); !status) return status;
        }
        if (Status status = go_back(std::move(later), middle, end, kept - 1, forward, back); !status) return status;
        end = middle;
    }
    for (int last = end; last > begin; --last) {
        State now = state;
        for (int k = begin + 1; k < last; ++k) {
            if (Status status = forward(now, k); !status) return status;
        }
        if (Status status = back(now, last); !status) return status;
    }
    return {};
}

}  // namespace pliant::sim
