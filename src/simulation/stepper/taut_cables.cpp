#include "simulation/stepper/taut_cables.hpp"

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

bool has_length(const Controls& controls, int actuator) {
    return controls.drives[static_cast<std::size_t>(actuator)].kind == Drive::Kind::measure;
}

}  // namespace

std::vector<int> taut_cables(const Equilibrium& system, const State& state, const Controls& controls) {
    constexpr double rounding = 1e-6;  // of the length at rest
    std::vector<int> taut;
    for (int a = 0; a < static_cast<int>(system.actuators().size()); ++a) {
        const Actuator& actuator = system.actuators()[static_cast<std::size_t>(a)];
        if (!actuator.only_pulls()) continue;
        const auto slack = [&] {
            const double wanted = controls.drives[static_cast<std::size_t>(a)].value;
            return wanted - actuator.measure(linalg::view(state.x));
        };
        if (state.multiplier[a] > 0 || (has_length(controls, a) && slack() < rounding * actuator.rest_measure()))
            taut.push_back(a);
    }
    return taut;
}

std::vector<int> holding_cables(const Equilibrium& system, const State& state, const Controls& controls) {
    std::vector<int> cables = taut_cables(system, state, controls);
    std::erase_if(cables, [&](int a) { return !has_length(controls, a); });
    return cables;
}

}  // namespace pliant::sim
