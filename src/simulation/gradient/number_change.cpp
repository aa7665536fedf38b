#include "simulation/gradient/number_change.hpp"

namespace pliant::sim {
namespace {

/// The same unknowns in another robot, with its own supports and inputs.
struct There {
    State state;
    Controls controls;
};

There there(const Equilibrium& system, const State& state, const Controls& controls) {
    There at{state, system.controls(controls.time)};
    at.controls.met = controls.met;
    at.controls.joint_start = controls.joint_start;
    system.place_supports(at.controls, at.state.x);
    for (std::size_t a = 0; a < at.controls.drives.size(); ++a) {
        if (at.controls.drives[a].kind == Drive::Kind::multiplier)
            at.state.multiplier[static_cast<Eigen::Index>(a)] = at.controls.drives[a].value;
    }
    return at;
}

Eigen::VectorXd values(const Equilibrium& system, const State& state, const Controls& controls,
                       std::span<const Measure> measures) {
    const There at = there(system, state, controls);
    Eigen::VectorXd all(static_cast<Eigen::Index>(measures.size()));
    for (std::size_t m = 0; m < measures.size(); ++m)
        all[static_cast<Eigen::Index>(m)] = slope(system, at.state, at.controls, measures[m]).value;
    return all;
}

Eigen::VectorXd equations(const Linearisation& of, const Equilibrium& system) {
    const There at = there(system, of.state(), of.controls());
    return of.equations(system, at.state, at.controls);
}

}  // namespace

Eigen::MatrixXd measures_by_numbers(std::span<const NumberChange> numbers, const State& state, const Controls& controls,
                                    std::span<const Measure> measures) {
    Eigen::MatrixXd by(static_cast<Eigen::Index>(measures.size()), static_cast<Eigen::Index>(numbers.size()));
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const NumberChange& n = numbers[k];
        by.col(static_cast<Eigen::Index>(k)) =
            (values(*n.more, state, controls, measures) - values(*n.less, state, controls, measures)) / n.step;
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
