// All numbers that a state depends on: the gradient of a measure with respect to them, or a change of them.
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

/// A guide point of a cable or spring, and the derivative of its attachment to the mesh: Attacher::slope().
struct GuidePoint {
    std::size_t path = 0, point = 0;
    AttachmentSlope slope{};
    bool of_spring = false;
};

/// What to differentiate with respect to.
struct By {
    bool inputs = true, parameters = true;
    bool tets = false;  ///< material properties of each tet
    bool rest = false;  ///< rest positions
    std::vector<GuidePoint> guides{};
    std::vector<NumberChange> numbers{};  ///< numbers of the drawing, with their effect on a quasi-static program
                                          ///< without friction
};

/// One entry for each number; a part is empty if it is not requested, or does not change.
struct Variation {
    Eigen::VectorXd inputs;      ///< (inputs(at)), at this instant
    Eigen::VectorXd parameters;  ///< (parameters(at))
    TetDerivatives tets{};       ///< of each tet, in addition to `parameters`, which change all tets of a material
    /// (3n) with respect to rest positions. Prescribed lengths, volumes and gas that are given relative to their rest
    /// values (as a ratio or a difference) follow.
    Eigen::VectorXd rest{};
    /// (3 guides) with respect to the rest position of each point, which is then re-attached to the mesh; prescribed
    /// lengths follow likewise.
    Eigen::VectorXd guides{};
    Eigen::VectorXd numbers{};  ///< (numbers)
};

/// sum += change, part by part.
void add(const Variation& change, Variation& sum);

/// The gradient of a measure with respect to everything at once, by one transposed solve. Errors: those of
/// Linearisation::adjoint().
[[nodiscard]] Result<Variation> gradient(Linearisation& at, const Slope& of, const By& by);
/// The same from an adjoint already at hand: that of `of.state`.
[[nodiscard]] Variation gradient(Linearisation& at, const Adjoint& adjoint, const Slope& of, const By& by);

/// (measures) their change for a change of everything except guide points, by one direct solve. Together with
/// gradient() these are the products of the Jacobian and of its transpose that Gauss-Newton needs.
[[nodiscard]] Result<Eigen::VectorXd> changes(Linearisation& at, std::span<const Slope> of, const Variation& with);
/// Derivative of the equations along this variation.
[[nodiscard]] Derivative derivative(Linearisation& at, const Variation& with);
/// The same from a response already at hand, to that derivative or to one with more forces.
[[nodiscard]] Eigen::VectorXd changes(Linearisation& at, std::span<const Slope> of, const Variation& with,
                                      const Derivative& by, const Change& answer);

/// (actuators) derivative of the value that an input prescribes for each actuator with respect to its measure at rest;
/// 0 if it does not depend on it.
[[nodiscard]] Eigen::VectorXd wanted_by_rest(const Linearisation& at);

}  // namespace pliant::sim
