// Traverses steps backwards that can only be computed forwards, with a limited number of stored states: binomial
// checkpointing.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>

#include "base/core/error.hpp"

namespace pliant::sim {

/// Number of steps that can be traversed backwards with `states` stored states if each step is computed at most `times`
/// times.
[[nodiscard]] inline double reach_back(int states, int times) {
    double count = 1;
    for (int i = 1; i <= states; ++i) count = count * (times + i) / i;
    return count;
}

/// Largest number of times that any of `steps` is computed, with `kept` stored states in addition to the first.
[[nodiscard]] inline int times_forward(int steps, int kept) {
    int times = 1;
    while (reach_back(kept + 1, times) < steps) ++times;
    return times;
}

/// Number of steps to advance before storing the next state, so that no step is computed more often than that. Source:
/// Griewank and Walther 2000, algorithm 799 (revolve).
[[nodiscard]] inline int next_kept(int steps, int kept) {
    const int times = times_forward(steps, kept);
    const double for_others = reach_back(kept, times), here = reach_back(kept + 1, times - 1);
    const double first = std::max(steps - for_others, std::min(here, 0.5 * steps));
    return std::clamp(static_cast<int>(first), 1, steps - 1);
}

/// Calls back(state, k) for each step k from `end` down to begin + 1, with the state before it. `state` is that after
/// step `begin`; forward(state, k) advances the state before step k to that after it. At most `kept` + 2 states exist
/// at once. An error of either ends it.
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
