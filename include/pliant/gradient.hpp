/// @file
/// Gradients of what is measured on a robot, at one state or over its whole program, with respect to everything that it
/// depends on.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/linearisation.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// A cost and its derivatives with respect to the measures; empty slopes stand for zero.
struct Judgement {
    double value = 0;              ///< the cost
    std::vector<double> slopes{};  ///< (measures) its derivatives
};

/// An objective of a program: the sum of `judge` over its steps, from step 1.
struct Objective {
    std::vector<Measure> measures;  ///< the values passed to `judge`
    /// Called at least once per step, in any order, on the thread that called gradient(); must be deterministic.
    /// `values`: (measures), SI.
    std::function<Judgement(int step, std::span<const double> values)> judge;
};

/// What to differentiate with respect to, in addition to inputs and parameters.
struct GradientOptions {
    bool rest_positions = false;  ///< node positions at rest
    bool guide_points = false;    ///< of cables and springs
    bool tets = false;            ///< material properties of each tetrahedron
    /// Names of [parameters] of the robot file that are numbers, not formulas of others. Everything that follows from
    /// one is included: the shape, whose mesh moves along with unchanged topology, positions, constants, targets. Only
    /// for quasi-static programs without friction and objects, in which supports hold every body.
    std::vector<std::string> numbers{};
    /// Number of states kept if steps depend on earlier ones, at least 1. The others are solved again, so that memory
    /// does not grow with the number of steps.
    int kept = 8;
};

/// Derivative with respect to a property of each tetrahedron, as if each had its own material.
struct TetGradient {
    std::string name;            ///< youngs_modulus, c10, density...
    std::string unit;            ///< SI; "" if dimensionless
    std::vector<double> values;  ///< (tets); 0 if a tetrahedron has no such property
};

/// Value and gradient of an objective. An objective that does not depend on its measures has a gradient of zeros.
struct ProgramGradient {
    double value = 0;                         ///< the objective
    std::vector<std::vector<double>> values;  ///< (steps, measures) SI
    std::vector<Parameter> parameters;        ///< of the robot and its surroundings
    std::vector<double> by_parameters;        ///< (parameters)
    /// (nodes), if requested. Prescribed lengths, volumes and amounts of gas change with the rest length or volume: by
    /// the same amount where the target in the robot file is `shortening` or `volume_change`, otherwise in proportion.
    std::vector<Point> by_rest_positions;
    std::vector<GuidePoint> guide_points;  ///< of cables, then of springs; if requested
    /// (guide_points) with respect to the rest position of each guide point: it is re-attached to the mesh as it moves,
    /// and prescribed lengths change with the rest length as for by_rest_positions. Gap elements that a cable acts
    /// through are unchanged.
    std::vector<Point> by_guide_points;
    std::vector<TetGradient> by_tets;  ///< if requested
    std::vector<double> by_numbers;    ///< (GradientOptions::numbers) in the units of the robot file
    /// An equilibrium that was solved for: the end of each step and, if a step was halved, the states in between.
    struct Instant {
        int step = 0;                   ///< of the program, from 1
        double time = 0;                ///< of the program
        std::vector<double> by_inputs;  ///< (inputs); empty: the objective does not depend on them
    };
    std::vector<Parameter> inputs;  ///< inputs of the robot; their values are those at rest
    std::vector<Instant> instants;  ///< in chronological order
};

/// Runs the robot's program and differentiates it backwards, with the adjoint of each step; also for a motion in time.
/// Lagged quantities of friction are held constant, as in a Linearisation: with friction, the gradient may differ from
/// differences of two programs.
/// @throws Failure if a measure or number does not exist, `kept` is below 1, `judge` is empty or returns the wrong
/// number of slopes or a number that is not finite, the mesh cannot follow a number, a guide point is not attached to a
/// tetrahedron, or a step does not converge or has no derivative; or when cancelled. Exceptions of `judge` are passed
/// on.
[[nodiscard]] PLIANT_API ProgramGradient gradient(const Model& model, const Objective& objective,
                                                  const GradientOptions& options = {}, const Watch& watch = {});

}  // namespace pliant
