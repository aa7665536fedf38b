/// @file
/// Gradients: how what is measured on a robot, at one state or over its whole program, changes with everything that it
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

/// A number, and how it changes with each measure; no slopes: it does not.
struct Judgement {
    double value = 0;              ///< the number
    std::vector<double> slopes{};  ///< (measures) its derivatives
};

/// What a program is judged by: the sum over its steps, from 1, of what `judge` says.
struct Objective {
    std::vector<Measure> measures;  ///< what `judge` is told
    /// Called once or more for a step, in any order; must say the same each time. `values`: (measures), SI.
    std::function<Judgement(int step, std::span<const double> values)> judge;
};

/// What a gradient is wanted by, beside inputs and parameters.
struct GradientOptions {
    bool rest_positions = false;  ///< of the nodes
    bool guide_points = false;    ///< of cables and springs
    bool tets = false;            ///< what each tetrahedron is made of
    /// Names of [parameters] of the robot file that are numbers, not formulas of others. Whatever follows from one
    /// counts: the shape, whose mesh moves along and keeps its topology, places, constants, targets. For programs at
    /// rest without friction.
    std::vector<std::string> numbers{};
    /// States that are kept on the way where steps depend on those before. Others are solved again, so that memory does
    /// not grow with the number of steps.
    int kept = 8;
};

/// Of a number that each tetrahedron has, as if each had a material of its own.
struct TetGradient {
    std::string name;            ///< youngs_modulus, c10, density...
    std::string unit;            ///< SI; "" of a plain number
    std::vector<double> values;  ///< (tets); 0 where a tetrahedron has no such number
};

/// The derivative of an objective.
struct ProgramGradient {
    double value = 0;                         ///< of the objective
    std::vector<std::vector<double>> values;  ///< (steps, measures) SI
    std::vector<Parameter> parameters;        ///< what the robot is made of and stands in
    std::vector<double> by_parameters;        ///< (parameters)
    /// (nodes), where wanted. Lengths and volumes that are wanted as a share of what they are at rest follow.
    std::vector<Point> by_rest_positions;
    std::vector<GuidePoint> guide_points;  ///< of cables, then of springs; where wanted
    /// (guide_points) by where each is at rest: the mesh then carries it elsewhere, and lengths that are wanted as a
    /// share of what they are at rest follow. Gap elements that a cable acts through stay as they are.
    std::vector<Point> by_guide_points;
    std::vector<TetGradient> by_tets;  ///< where wanted
    std::vector<double> by_numbers;    ///< (GradientOptions::numbers) in the units of the robot file
    /// Where an equilibrium was found: the end of each step, and where a step was halved what lies between.
    struct Instant {
        int step = 0;                   ///< of the program, from 1
        double time = 0;                ///< of the program
        std::vector<double> by_inputs;  ///< (inputs); empty: nothing depends on them
    };
    std::vector<Parameter> inputs;  ///< what drives the robot; values are those at rest
    std::vector<Instant> instants;  ///< in the order of time
};

/// Runs the robot's program and goes back over it with the adjoint of each step; also of a motion in time. What
/// friction lags stays as it was found.
/// @throws Failure of a measure or a number that is not there, of a number that no motion of the mesh follows; where a
/// step does not converge or has no derivative; cancelled. What `judge` throws is passed on.
[[nodiscard]] PLIANT_API ProgramGradient gradient(const Model& model, const Objective& objective,
                                                  const GradientOptions& options = {}, const Watch& watch = {});

}  // namespace pliant
