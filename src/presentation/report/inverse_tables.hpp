// Results of an inverse task: as JSON, as tables, and as one line.
#pragma once

#include <string>
#include <vector>

#include "presentation/report/measured.hpp"
#include "simulation/inverse/follow.hpp"

namespace pliant::report {

/// A solved task, with the names for its numbers.
struct InverseReport {
    std::string robot;
    const sim::Model& model;
    const sim::InverseTask& task;
    const sim::inverse::InverseResult& result;
};

/// Display unit of an input: "" for ratios, else mm, N, mm^3 or kPa; and the factor from SI.
struct InputUnit {
    std::string name;
    double factor = 1;
};
[[nodiscard]] InputUnit unit_of(const sim::Model& model, const sim::Steered& input);

/// docs/reference/results.md describes the keys. `warnings` of the program that was written are further notes.
[[nodiscard]] std::string inverse_json(const InverseReport& report, const std::vector<std::string>& warnings = {},
                                       int indent = 2);
/// One row per waypoint: index, time, reached; for each goal wanted, got and error; inputs; tensions and pressures of
/// all actuators.
[[nodiscard]] std::string waypoints_csv(const InverseReport& report);
/// "waypoint 3 of 20: not reached, reach 0.42 mm off, flexor 0.83": the goals that were not reached, and all inputs.
[[nodiscard]] std::string waypoint_line(const InverseReport& report, std::size_t waypoint);
/// Wanted positions of markers, for pictures. Empty if no goal is a position.
[[nodiscard]] std::vector<MeasuredPath> wanted_paths(const InverseReport& report);

}  // namespace pliant::report
