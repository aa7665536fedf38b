#include "simulation/solver/pressure_limit.hpp"

namespace pliant::sim {
namespace {

constexpr int most_steps = 40;
constexpr double volume_step = 0.01;  // of the current volume
constexpr double clear_fall = 1e-3;   // of the largest pressure: clearly above the solver's tolerance

double volume(const Actuator& actuator, const State& state) {
    return actuator.measure({state.x.data(), static_cast<std::size_t>(state.x.size())});
}

bool is_asked_for_more(const Drive& now, const Drive& wanted) {
    return now.kind == Drive::Kind::multiplier && wanted.kind == Drive::Kind::multiplier && now.value < 0 &&
           wanted.value < now.value;  // multipliers are minus pressures
}

}  // namespace

std::optional<PressureLimit> find_pressure_limit(const Equilibrium& system, SolverChain& solvers,
                                                 const Controls& controls, const Controls& wanted,
                                                 const StepSettings& settings, const State& state,
                                                 const Progress& progress) {
    const std::size_t chambers = system.model().description().chambers.size();
    for (std::size_t chamber = 0; chamber < chambers; ++chamber) {
        const std::size_t a = system.cable_count() + chamber;
        if (!is_asked_for_more(controls.drives[a], wanted.drives[a])) continue;
        const Actuator& actuator = system.actuators()[a];
        const double reached = -controls.drives[a].value;
        PressureLimit limit{chamber, reached, reached, volume(actuator, state) / actuator.rest_measure()};
        State walking = state;
        Controls driven = controls;
        for (int k = 0; k < most_steps; ++k) {
            driven.drives[a] = {Drive::Kind::measure, (1 + volume_step) * volume(actuator, walking)};
            solvers.restart();
            if (!solvers.solve(system, driven, settings, walking, progress).converged) break;
            const double pressure = -walking.multiplier[static_cast<Eigen::Index>(a)];
            if (pressure >= -wanted.drives[a].value) break;
            if (pressure < (1 - clear_fall) * limit.largest_Pa) return limit;
            if (pressure > limit.largest_Pa) {
                limit.largest_Pa = pressure;
                limit.volume_ratio = volume(actuator, walking) / actuator.rest_measure();
            }
        }
    }
    return std::nullopt;
}

}  // namespace pliant::sim
