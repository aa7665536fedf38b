#include "simulation/gradient/number_change.hpp"

namespace pliant::sim {
namespace {

/// The same unknowns in another robot: what it holds and what it is given is its own.
struct There {
    State state;
    Controls controls;
};

There there(const Equilibrium& system, const State& state, const Controls& controls) {
    There at{state, system.controls(controls.time)};
    at.controls.met = controls.met;
    system.place_supports(at.controls, at.state.x);
    for (std::size_t a = 0; a < at.controls.drives.size(); ++a) {
        if (at.controls.drives[a].kind == Drive::Kind::multiplier)
            at.state.multiplier[static_cast<Eigen::Index>(a)] = at.controls.drives[a].value;
    }
    return at;
}

double value(const Equilibrium& system, const State& state, const Controls& controls, const Measure& measure) {
    const There at = there(system, state, controls);
    return slope(system, at.state, at.controls, measure).value;
}

Eigen::VectorXd equations(const Linearisation& of, const Equilibrium& system) {
    const There at = there(system, of.state(), of.controls());
    return of.equations(system, at.state, at.controls);
}

}  // namespace

Eigen::VectorXd measure_by_numbers(std::span<const NumberChange> numbers, const State& state, const Controls& controls,
                                   const Measure& measure) {
    Eigen::VectorXd by(static_cast<Eigen::Index>(numbers.size()));
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const NumberChange& n = numbers[k];
        by[static_cast<Eigen::Index>(k)] =
            (value(*n.more, state, controls, measure) - value(*n.less, state, controls, measure)) / n.step;
    }
    return by;
}

Eigen::VectorXd worth_of_numbers(const Linearisation& at, const Adjoint& adjoint,
                                 std::span<const NumberChange> numbers) {
    Eigen::VectorXd worth(static_cast<Eigen::Index>(numbers.size()));
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const NumberChange& n = numbers[k];
        worth[static_cast<Eigen::Index>(k)] =
            -adjoint.weights.dot(equations(at, *n.more) - equations(at, *n.less)) / n.step;
    }
    return worth;
}

}  // namespace pliant::sim
