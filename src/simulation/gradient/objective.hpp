// What a program is judged by: a function of measures at the end of each step.
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

/// A number, and how it changes with each measure; no slopes: it does not.
struct Judgement {
    double value = 0;
    std::vector<double> slopes{};
};

/// The sum over the steps of a program, from 1, of what `judge` says. It is called once or more for a step, in any
/// order, and must say the same each time. A weighted sum over steps has its weights in here.
struct Objective {
    std::vector<Measure> measures;
    std::function<Judgement(int step, std::span<const double> values)> judge;
};

/// Sum of weight times squared difference; without weights each is 1. As many of all.
[[nodiscard]] Judgement squared_distance(std::span<const double> values, std::span<const double> wanted,
                                         std::span<const double> weights = {});
/// Only the last of `steps` steps counts.
[[nodiscard]] Objective at_end(const Measure& measure, int steps);
/// A measure with a direction, three times: along x, y and z.
[[nodiscard]] std::vector<Measure> along_axes(Measure measure);

}  // namespace pliant::sim
