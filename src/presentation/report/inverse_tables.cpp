#include "presentation/report/inverse_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/core/csv.hpp"
#include "base/core/json.hpp"
#include "presentation/report/tables.hpp"
#include "presentation/report/units.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/result_columns.hpp"

namespace pliant::report {
namespace {

using Json = nlohmann::ordered_json;
using sim::Goal;
using sim::GoalKind;
using sim::inverse::GoalState;
using sim::inverse::Waypoint;

/// Unit of an error; and of wanted and reached values, except directions.
InputUnit unit_of_goal(const Goal& goal) {
    switch (goal.kind) {
        case GoalKind::direction:
            return {"deg", 180 / std::numbers::pi};
        case GoalKind::contact_force:
        case GoalKind::support_force:
            return {"N", 1};
        default:
            return {"mm", mm_per_m};
    }
}

double factor_of_values(const Goal& goal) {
    return goal.kind == GoalKind::direction ? 1 : unit_of_goal(goal).factor;
}

std::size_t numbers_of(const Goal& goal) {
    return goal.sum_of_sizes ? 1 : 3;
}

Json points_json(const Goal& goal, const std::vector<Vec3>& points) {
    Json list = Json::array();
    for (const Vec3& p : points) {
        Json numbers = Json::array();
        for (std::size_t c = 0; c < numbers_of(goal); ++c) numbers.push_back(factor_of_values(goal) * p[c]);
        list.push_back(std::move(numbers));
    }
    return list;
}

/// For a plane its point only; its normal has no unit.
std::vector<Vec3> wanted_points(const Goal& goal, std::size_t waypoint) {
    std::vector<Vec3> points = goal.at(waypoint);
    if (goal.kind == GoalKind::plane) points.resize(1);
    return points;
}

Json goal_json(const Goal& goal, const GoalState& state, std::size_t waypoint) {
    const InputUnit unit = unit_of_goal(goal);
    return {{"reached", state.reached},
            {"error_" + unit.name, unit.factor * state.error},
            {"wanted", points_json(goal, wanted_points(goal, waypoint))},
            {"got", points_json(goal, state.got)}};
}

Json waypoint_json(const InverseReport& r, std::size_t k) {
    const Waypoint& at = r.result.waypoints[k];
    Json out = {{"index", k + 1}, {"time", at.state.time}, {"reached", at.reached}};
    double error_m = -1;
    Json goals = Json::object(), inputs = Json::object(), limits = Json::array();
    for (std::size_t g = 0; g < r.task.goals.size(); ++g) {
        const Goal& goal = r.task.goals[g];
        if (unit_of_goal(goal).name == "mm") error_m = std::max(error_m, at.goals[g].error);
        goals[goal.name] = goal_json(goal, at.goals[g], k);
    }
    if (error_m >= 0) out["error_mm"] = mm_per_m * error_m;
    for (std::size_t i = 0; i < r.task.inputs.size(); ++i)
        inputs[r.task.inputs[i].name] = report::unit_of(r.model, r.task.inputs[i]).factor * at.values[i];
    for (const sim::inverse::Limit& limit : at.limits) {
        if (!limit.input.empty()) limits.push_back(limit.input);
    }
    out["goals"] = std::move(goals);
    out["inputs"] = std::move(inputs);
    out["limits"] = std::move(limits);
    out["reasons"] = reasons(at);
    for (const auto& cable : at.state.cables) out["tensions_N"][cable.name] = cable.tension_N;
    for (const auto& chamber : at.state.chambers) out["pressures_kPa"][chamber.name] = 1e-3 * chamber.pressure_Pa;
    for (const auto& marker : at.state.markers) {
        const Vec3& p = marker.position_m;
        out["markers"][marker.name] = {mm_per_m * p.x, mm_per_m * p.y, mm_per_m * p.z};
    }
    out["forward_solves"] = at.work.forward;
    out["linear_solves"] = at.work.solutions;
    out["wall_ms"] = 1e3 * at.wall_s;
    return out;
}

std::string with_unit(const std::string& name, const std::string& unit) {
    return csv_field(unit.empty() ? name : name + "_" + unit);
}

std::vector<std::string> waypoint_header(const InverseReport& r) {
    std::vector<std::string> cells(sim::columns::waypoint.begin(), sim::columns::waypoint.end());
    for (const Goal& goal : r.task.goals) {
        const std::string unit = goal.kind == GoalKind::direction ? "" : unit_of_goal(goal).name;
        const std::size_t points = goal.kind == GoalKind::position ? goal.markers.size() : 1;
        for (std::size_t p = 0; p < points; ++p) {
            const std::string name =
                points == 1 ? goal.name : goal.name + "_" + r.model.description().markers[goal.markers[p]].name;
            for (const char* what : {"wanted", "got"}) {
                for (std::size_t c = 0; c < numbers_of(goal); ++c) {
                    const std::string axis = numbers_of(goal) == 1 ? "" : fmt::format("_{}", "xyz"[c]);
                    cells.push_back(with_unit(fmt::format("{}_{}{}", name, what, axis), unit));
                }
            }
        }
        cells.push_back(with_unit(goal.name + "_error", unit_of_goal(goal).name));
    }
    for (const sim::Steered& input : r.task.inputs)
        cells.push_back(with_unit(input.name, report::unit_of(r.model, input).name));
    const sim::Description& d = r.model.description();
    for (const sim::Cable& cable : d.cables) cells.push_back(csv_field(cable.name + "_tension_N"));
    for (const sim::Chamber& chamber : d.chambers) cells.push_back(csv_field(chamber.name + "_pressure_kPa"));
    return cells;
}

std::vector<std::string> waypoint_row(const InverseReport& r, std::size_t k) {
    const Waypoint& at = r.result.waypoints[k];
    std::vector<std::string> cells = {fmt::format("{}", k + 1), fmt::format("{:.10g}", at.state.time),
                                      at.reached ? "1" : "0"};
    const auto number = [&](double value) { cells.push_back(fmt::format("{:.10g}", value)); };
    for (std::size_t g = 0; g < r.task.goals.size(); ++g) {
        const Goal& goal = r.task.goals[g];
        const std::vector<Vec3> wanted = wanted_points(goal, k);
        for (std::size_t p = 0; p < wanted.size(); ++p) {
            for (const Vec3& v : {wanted[p], at.goals[g].got[p]}) {
                for (std::size_t c = 0; c < numbers_of(goal); ++c) number(factor_of_values(goal) * v[c]);
            }
        }
        number(unit_of_goal(goal).factor * at.goals[g].error);
    }
    for (std::size_t i = 0; i < at.values.size(); ++i)
        number(report::unit_of(r.model, r.task.inputs[i]).factor * at.values[i]);
    for (const auto& cable : at.state.cables) number(cable.tension_N);
    for (const auto& chamber : at.state.chambers) number(1e-3 * chamber.pressure_Pa);
    return cells;
}

}  // namespace

InputUnit unit_of(const sim::Model& model, const sim::Steered& input) {
    const sim::Description& d = model.description();
    if (input.actuator < d.cables.size()) {
        switch (d.cables[input.actuator].target.kind) {
            case sim::CableTarget::Kind::length_ratio:
                return {};
            case sim::CableTarget::Kind::shortening_m:
                return {"mm", mm_per_m};
            case sim::CableTarget::Kind::tension_N:
                return {"N", 1};
        }
    }
    switch (d.chambers[input.actuator - d.cables.size()].target.kind) {
        case sim::ChamberTarget::Kind::volume_change_m3:
            return {"mm^3", 1e9};
        case sim::ChamberTarget::Kind::pressure_Pa:
            return {"kPa", 1e-3};
        default:
            return {};
    }
}

std::string inverse_json(const InverseReport& r, const std::vector<std::string>& warnings, int indent) {
    std::vector<std::string> notes = r.result.notes;
    notes.insert(notes.end(), warnings.begin(), warnings.end());
    Json out = {{"pliant", PLIANT_VERSION},      {"robot", r.robot},
                {"nodes", r.model.node_count()}, {"tets", r.model.mesh().tet_count()},
                {"order", r.model.mesh().order}, {"reached", r.result.reached},
                {"message", r.result.message},   {"notes", notes}};
    out["waypoints"] = Json::array();
    for (std::size_t k = 0; k < r.result.waypoints.size(); ++k) out["waypoints"].push_back(waypoint_json(r, k));
    return json_text(out, indent) + "\n";
}

std::string waypoints_csv(const InverseReport& r) {
    std::string text = fmt::format("{}\n", fmt::join(waypoint_header(r), ","));
    for (std::size_t k = 0; k < r.result.waypoints.size(); ++k)
        text += fmt::format("{}\n", fmt::join(waypoint_row(r, k), ","));
    return text;
}

std::string waypoint_line(const InverseReport& r, std::size_t k) {
    const Waypoint& at = r.result.waypoints[k];
    std::vector<std::string> parts;
    for (std::size_t g = 0; g < r.task.goals.size(); ++g) {
        const InputUnit unit = unit_of_goal(r.task.goals[g]);
        if (at.goals[g].reached) continue;
        parts.push_back(
            fmt::format("{} {:.3g} {} off", r.task.goals[g].name, unit.factor * at.goals[g].error, unit.name));
    }
    for (std::size_t i = 0; i < at.values.size(); ++i) {
        const InputUnit unit = report::unit_of(r.model, r.task.inputs[i]);
        parts.push_back(fmt::format("{} {:.4g}{}{}", r.task.inputs[i].name, unit.factor * at.values[i],
                                    unit.name.empty() ? "" : " ", unit.name));
    }
    return fmt::format("waypoint {} of {}: {}, {}", k + 1, r.task.waypoints(), at.reached ? "reached" : "not reached",
                       fmt::join(parts, ", "));
}

std::vector<MeasuredPath> wanted_paths(const InverseReport& r) {
    std::vector<MeasuredPath> paths;
    for (const Goal& goal : r.task.goals) {
        if (goal.kind != GoalKind::position) continue;
        for (std::size_t m = 0; m < goal.markers.size(); ++m) {
            MeasuredPath path{r.model.description().markers[goal.markers[m]].name, {}};
            for (const std::vector<Vec3>& at : goal.wanted) path.points.push_back(at[m]);
            paths.push_back(std::move(path));
        }
    }
    return paths;
}

}  // namespace pliant::report
