// The objective of a program: a function of measures at the end of each step.
//
//     Objective objective;
//     objective.measures = along_axes({Measure::Kind::marker, 0});                  // x, y and z of the first marker
//     objective.judge = [&](int step, std::span<const double> at) { return squared_distance(at, wanted[step]); };
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "simulation/gradient/measure.hpp"

namespace pliant::sim {

/// A cost and its derivatives with respect to the measures; empty slopes stand for zero.
struct Judgement {
    double value = 0;
    std::vector<double> slopes{};
};

/// The sum of `judge` over the steps of a program, from step 1. It is called at least once per step, in any order, and
/// must be deterministic. Include weights of the steps in `judge`.
struct Objective {
    std::vector<Measure> measures;
    std::function<Judgement(int step, std::span<const double> values)> judge;
};

/// Sum of weight times squared difference; without weights each is 1. All arguments have the same size.
[[nodiscard]] Judgement squared_distance(std::span<const double> values, std::span<const double> wanted,
                                         std::span<const double> weights = {});
/// An objective that only counts the last of `steps` steps.
[[nodiscard]] Objective at_end(const Measure& measure, int steps);
/// A measure along x, y and z.
[[nodiscard]] std::vector<Measure> along_axes(Measure measure);

}  // namespace pliant::sim
