// What goals came to: for programs, for spreadsheets, and as one line.
#pragma once

#include <string>
#include <vector>

#include "presentation/report/measured.hpp"
#include "simulation/inverse/follow.hpp"

namespace pliant::report {

/// A solved task, with what its numbers are called.
struct InverseReport {
    std::string robot;
    const sim::Model& model;
    const sim::InverseTask& task;
    const sim::inverse::InverseResult& result;
};

/// What an input is written in: "" of ratios, else mm, N, mm^3 or kPa; and the factor to it from SI.
struct InputUnit {
    std::string name;
    double factor = 1;
};
[[nodiscard]] InputUnit unit_of(const sim::Model& model, const sim::Steered& input);

/// docs/reference/results.md has the keys.
[[nodiscard]] std::string inverse_json(const InverseReport& report, int indent = 2);
/// One row a waypoint: index, time, reached; for each goal wanted, got and error; inputs; tensions and pressures of all
/// actuators.
[[nodiscard]] std::string waypoints_csv(const InverseReport& report);
/// "waypoint 3 of 20: not reached, reach 0.42 mm off, flexor 0.83": goals that are not reached, and all inputs.
[[nodiscard]] std::string waypoint_line(const InverseReport& report, std::size_t waypoint);
/// Where markers are wanted, for pictures. Empty where no goal is a place.
[[nodiscard]] std::vector<MeasuredPath> wanted_paths(const InverseReport& report);

}  // namespace pliant::report
