#include "studio/simulate/state_history.hpp"

#include <utility>
#include <vector>

namespace pliant::studio {

void StateHistory::add(const sim::Step& step) {
    constexpr std::size_t most_bytes = std::size_t{96} << 20;
    if (seen_++ % stride_ != 0) return;
    std::vector<sim::Step>& steps = states_.steps;
    steps.push_back(step);
    steps.back().index = static_cast<int>(seen_) - 1;
    if (steps.size() * step.positions.size() * sizeof(Vec3) < most_bytes) return;
    std::vector<sim::Step> kept;
    for (std::size_t k = 0; k < steps.size(); k += 2) kept.push_back(std::move(steps[k]));
    steps = std::move(kept);
    stride_ *= 2;
}

}  // namespace pliant::studio
