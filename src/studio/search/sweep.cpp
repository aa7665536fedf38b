#include "studio/search/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "base/core/config.hpp"
#include "base/core/part_of_work.hpp"
#include "presentation/report/units.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_document.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_model.hpp"
#include "studio/base/dumped.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// All results of a state, and their names.
struct Row {
    std::vector<SweepColumn> columns;
    std::vector<double> values;
    std::string warning;  ///< see SweepRun::warning
    void add(const std::string& name, const char* what, const char* label, const char* unit, double value) {
        columns.push_back({name.empty() ? what : name + "_" + what, name.empty() ? label : name + ": " + label, unit});
        values.push_back(value);
    }
};

Row row_of(const sim::Step& rest, const sim::Step& end) {
    Row row;
    for (std::size_t k = 0; k < end.cables.size(); ++k) {
        const sim::CableState& c = end.cables[k];
        row.add(c.name, "tension_N", "tension", "N", c.tension_N);
        row.add(c.name, "shortening_mm", "shortening", "mm", report::mm_per_m * (rest.cables[k].length_m - c.length_m));
        row.add(c.name, "length_ratio", "length ratio", "", c.length_ratio);
    }
    for (std::size_t k = 0; k < end.chambers.size(); ++k) {
        const sim::ChamberState& c = end.chambers[k];
        row.add(c.name, "pressure_kPa", "pressure", "kPa", 1e-3 * c.pressure_Pa);
        row.add(c.name, "volume_change_mm3", "volume change", "mm³", 1e9 * (c.volume_m3 - rest.chambers[k].volume_m3));
        row.add(c.name, "volume_ratio", "volume ratio", "", c.volume_ratio);
    }
    for (std::size_t k = 0; k < end.markers.size(); ++k) {
        const sim::MarkerState& m = end.markers[k];
        row.add(m.name, "displacement_mm", "displacement", "mm",
                report::mm_per_m * norm(m.position_m - rest.markers[k].position_m));
        row.add(m.name, "x_mm", "x", "mm", report::mm_per_m * m.position_m.x);
        row.add(m.name, "y_mm", "y", "mm", report::mm_per_m * m.position_m.y);
        row.add(m.name, "z_mm", "z", "mm", report::mm_per_m * m.position_m.z);
    }
    for (const sim::SupportState& s : end.supports) row.add(s.name, "force_N", "reaction", "N", norm(s.force_N));
    row.add("", "energy_mJ", "energy", "mJ", 1e3 * end.energy_J);
    return row;
}

/// Notes on the robot at rest are shown with it, and would be those of every run.
std::string warning_of(const sim::Model& model, const sim::Trajectory& trajectory) {
    const std::vector<std::string>& notes = model.description().notes;
    std::string all;
    for (const std::string& warning : trajectory.warnings) {
        if (std::ranges::find(notes, warning) == notes.end()) all += (all.empty() ? "" : "; ") + warning;
    }
    return all;
}

std::string assignment(const SweepAxis& axis, double value) {
    if (axis.unit.empty()) return fmt::format("{}={:.12g}", axis.key, value);
    return fmt::format("{}=\"{:.12g} {}\"", axis.key, value, axis.unit);
}

/// Every combination; the last axis changes first.
std::vector<std::vector<double>> combinations(const SweepOrder& order) {
    std::vector<std::vector<double>> all = {{}};
    for (const SweepAxis& axis : order.axes) {
        std::vector<std::vector<double>> longer;
        for (const auto& one : all) {
            for (const double value : axis.values) {
                longer.push_back(one);
                longer.back().push_back(value);
            }
        }
        all = std::move(longer);
    }
    return all;
}

Result<Row> end_of(const RobotText& source, const std::vector<std::string>& assignments,
                   std::optional<mesh::TetMesh>& kept, bool keep, Progress& progress) {
    Result<robot::Robot> robot = robot::parse_robot(source.text, source.file, assignments);
    if (!robot) return tl::unexpected(robot.error());
    if (!kept || !keep) {
        Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, progress);
        if (!mesh) return tl::unexpected(mesh.error());
        kept = std::move(*mesh);
    }
    const Result<sim::Model> model = robot::build_model(*robot, *kept);
    if (!model) return tl::unexpected(model.error());
    const sim::Trajectory trajectory = sim::run(*model, robot->program, progress);
    if (progress.cancelled()) return tl::unexpected(cancelled());
    if (!trajectory.converged) return failure("{}", trajectory.message);
    Row row = row_of(trajectory.steps.front(), trajectory.steps.back());
    row.warning = warning_of(*model, trajectory);
    return row;
}

}  // namespace

bool changes_mesh(const std::string& key) {
    const std::size_t dot = key.find('.');
    const std::string list = key.substr(0, dot), last = key.substr(key.rfind('.') + 1);
    for (const char* plain : {"material", "program", "contact", "load", "mass"})
        if (list == plain) return false;
    const bool actuator = list == "cable" || list == "chamber" || list == "spring";
    return !actuator || (key.find(".target.") == std::string::npos && last != "friction" && last != "stiffness");
}

Status check_axes(const RobotText& source, const SweepOrder& order) {
    auto own = config::parse(source.text, source.file);
    if (!own) return tl::unexpected(own.error());
    const auto based = robot::on_base(std::move(*own));
    if (!based) return tl::unexpected(based.error());
    const config::Document& document = based->document;
    std::map<config::Place, std::string> places;
    for (const SweepAxis& axis : order.axes) {
        const auto [other, is_new] = places.emplace(config::place_of(document, axis.key), axis.key);
        if (!is_new) return input_error("sweep: {} sets what {} sets; only one of them may", axis.key, other->second);
        if (const std::string why = robot::why_idle(document, axis.key); !why.empty())
            return input_error("sweep: {}", why);
    }
    return {};
}

Result<Sweep> run_sweep(const RobotText& source, const SweepOrder& order, Progress& progress) {
    const std::vector<std::vector<double>> all = combinations(order);
    bool keep = true;
    for (const SweepAxis& axis : order.axes) keep = keep && !changes_mesh(axis.key);
    std::optional<mesh::TetMesh> mesh;
    std::optional<Error> first;
    Sweep sweep;
    for (std::size_t k = 0; k < all.size(); ++k) {
        auto part = equal_part(progress, fmt::format("{} of {}", k + 1, all.size()), k, all.size());
        part.advance("", 0);
        std::vector<std::string> assignments;
        if (source.accuracy == Accuracy::preview) assignments.emplace_back("mesh.order=1");
        for (std::size_t a = 0; a < order.axes.size(); ++a) assignments.push_back(assignment(order.axes[a], all[k][a]));
        Result<Row> row = end_of(source, assignments, mesh, keep, part);
        if (!row && row.error().cause == Cause::cancelled) return tl::unexpected(row.error());
        if (!row && !first) first = row.error();
        if (row && sweep.columns.empty()) sweep.columns = row->columns;
        // A key may add or remove results, such as a repeat count: a plot needs the same ones everywhere.
        const bool same = row && row->columns.size() == sweep.columns.size();
        sweep.runs.push_back({all[k], same ? std::move(row->values) : std::vector<double>(),
                              row ? (same ? "" : "its results are not those of the first run") : row.error().message,
                              same ? std::move(row->warning) : ""});
    }
    if (sweep.columns.empty()) return tl::unexpected(*first);
    return sweep;
}

std::string sweep_json(const SweepOrder& order, const Sweep& sweep) {
    Json axes = Json::array(), columns = Json::array(), runs = Json::array();
    for (const SweepAxis& axis : order.axes)
        axes.push_back({{"key", axis.key}, {"unit", axis.unit}, {"values", axis.values}});
    for (const SweepColumn& column : sweep.columns)
        columns.push_back({{"key", column.key}, {"label", column.label}, {"unit", column.unit}});
    for (const SweepRun& run : sweep.runs)
        runs.push_back({{"inputs", run.inputs}, {"results", run.results}, {"why", run.why}, {"warning", run.warning}});
    return dumped({{"axes", axes}, {"columns", columns}, {"runs", runs}});
}

}  // namespace pliant::studio
