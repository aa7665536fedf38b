// Everything that a state is a function of, as numbers: the gradient of a measure by all of it, or a change of it.
//
//     const Equilibrium system(model);                             // state, controls: as a solver left them
//     auto at = Linearisation::create(system, state, controls);
//     const Slope tip = slope(*at, {Measure::Kind::marker, 0, {0, 0, 1}});
//     const Result<Variation> by = gradient(*at, tip, {.tets = true, .rest = true});  // one transposed solution
//     by->inputs[0];                                               // inputs(*at)[0] says what that is
//     const Variation change{...};
//     changes(*at, slopes, change);                                // one direct solution, for any number of measures
//
// docs/theory.md, "Gradients", has the equations.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/gradient/measure.hpp"
#include "simulation/gradient/number_change.hpp"
#include "simulation/linearisation/linearisation.hpp"
#include "simulation/linearisation/parameters.hpp"

namespace pliant::sim {

/// A guide point of a cable or spring, and how it is tied to the mesh: Attacher::slope().
struct GuidePoint {
    std::size_t path = 0, point = 0;
    AttachmentSlope slope{};
    bool of_spring = false;
};

/// What a gradient is wanted by.
struct By {
    bool inputs = true, parameters = true;
    bool tets = false;  ///< what each tet is made of
    bool rest = false;  ///< rest positions
    std::vector<GuidePoint> guides{};
    std::vector<NumberChange> numbers{};  ///< of the drawing, in what follows a program at rest without friction
};

/// One number for each that may change; empty where it is not wanted, or does not change.
struct Variation {
    Eigen::VectorXd inputs;      ///< (inputs(at)), at this instant
    Eigen::VectorXd parameters;  ///< (parameters(at))
    TetDerivatives tets{};       ///< of each tet, beside what `parameters` do to all of a material
    /// (3n) by rest positions. Lengths, volumes and gas that are wanted as a share of what they are at rest, and those
    /// that are wanted as a change of it, follow.
    Eigen::VectorXd rest{};
    /// (3 guides) by the rest position of each point, which the mesh then carries elsewhere; lengths that are wanted
    /// follow likewise.
    Eigen::VectorXd guides{};
    Eigen::VectorXd numbers{};  ///< (numbers)
};

/// sum += change, of the same parts.
void add(const Variation& change, Variation& sum);

/// d(measure) by everything at once, from one transposed solution. Its errors: those of Linearisation::adjoint().
[[nodiscard]] Result<Variation> gradient(Linearisation& at, const Slope& of, const By& by);
/// The same, where that solution is at hand: of `of.state`.
[[nodiscard]] Variation gradient(Linearisation& at, const Adjoint& adjoint, const Slope& of, const By& by);

/// (measures) how they change with a change of everything but guide points, from one direct solution. With gradient()
/// these are the products of the Jacobian and of its transpose that Gauss-Newton needs.
[[nodiscard]] Result<Eigen::VectorXd> changes(Linearisation& at, std::span<const Slope> of, const Variation& with);
/// How the equations change with it.
[[nodiscard]] Derivative derivative(Linearisation& at, const Variation& with);
/// The same, where the response to that derivative, or to one with more forces, is at hand.
[[nodiscard]] Eigen::VectorXd changes(Linearisation& at, std::span<const Slope> of, const Variation& with,
                                      const Derivative& by, const Change& answer);

/// (actuators) how what an input wants of each actuator changes with its measure at rest: 0 where it does not.
[[nodiscard]] Eigen::VectorXd wanted_by_rest(const Linearisation& at);

}  // namespace pliant::sim
