#include "robot/file/goal_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "base/core/counted.hpp"
#include "base/core/csv.hpp"
#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "base/core/text.hpp"

namespace pliant::robot {
namespace {

using config::Reader;
using GoalKind = GoalSpec::Kind;

constexpr std::size_t most_waypoints = 100000;

template <class Spec>
void check_name(Reader& reader, std::string_view key, std::string_view kind, const std::string& name,
                const std::vector<Spec>& known) {
    if (std::ranges::any_of(known, [&](const Spec& spec) { return spec.name == name; })) return;
    std::vector<std::string> names;
    for (const Spec& spec : known) names.push_back(fmt::format("\"{}\"", spec.name));
    reader.problem(key, names.empty()
                            ? fmt::format("there is no {} \"{}\"; add a [[{}]]", kind, name, kind)
                            : fmt::format("there is no {} \"{}\"; there is {}", kind, name, join_names(names)));
}

/// marker = "tip", or markers = ["a", "b"].
std::vector<std::string> read_marker_names(Reader& reader, const Context& context) {
    std::vector<std::string> names;
    if (reader.has("marker") && reader.has("markers")) reader.problem("markers", "give either marker or markers");
    if (reader.has("marker")) names = {reader.text("marker")};
    if (reader.has("markers")) names = reader.texts("markers");
    for (const char* key : {"marker", "markers"}) {
        if (reader.raw(key) == nullptr) continue;
        for (const std::string& name : names) check_name(reader, key, "marker", name, context.robot.markers);
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
            names.begin() + static_cast<std::ptrdiff_t>(i))
            reader.problem("markers", fmt::format("names \"{}\" twice", names[i]));
    }
    return names;
}

/// The name of a column, without a unit in brackets.
std::string bare_name(std::string_view column) {
    return std::string(trimmed(without_csv_unit(column)));
}

/// What the columns of a path may be called: those of this goal, and those of other markers, which one table may hold.
std::vector<std::string> path_columns(const Context& context, const GoalSpec& goal) {
    std::vector<std::string> names = {"time"};
    if (goal.markers.size() == 1) names.insert(names.end(), {"x", "y", "z"});
    for (const auto& marker : context.robot.markers) {
        for (const char* axis : {"_x", "_y", "_z"}) names.push_back(marker.name + axis);
    }
    return names;
}

/// "x (mm)" for "x_mm", as other tables name their columns; "" if it is nothing like that.
std::string with_unit_in_brackets(const std::string& name, const std::vector<std::string>& known) {
    const std::size_t bar = name.rfind('_');
    if (bar == std::string::npos || !unit_factor(name.substr(bar + 1), Dimension::length)) return "";
    const std::string bare = name.substr(0, bar);
    return std::ranges::count(known, bare) > 0 ? fmt::format("{} ({})", bare, name.substr(bar + 1)) : "";
}

/// Each name once, and none that nothing would read.
Status check_columns(const CsvTable& table, const std::vector<std::string>& known) {
    std::vector<std::string> names;
    for (const std::string& column : table.columns) {
        const std::string name = bare_name(column);
        if (std::ranges::count(names, name) > 0)
            return input_error_at(table.file, table.header_line, "there are two columns \"{}\"", name);
        names.push_back(name);
        const auto is_known = [&](std::string_view some) { return std::ranges::count(known, some) > 0; };
        const std::string before_bracket(trimmed(std::string_view(column).substr(0, column.find_last_of("(["))));
        if ((name != column && csv_unit(column).empty()) || (!is_known(name) && is_known(before_bracket)))
            return input_error_at(table.file, table.header_line, "column \"{}\": its brackets hold no unit", column);
        if (is_known(name)) continue;
        if (const std::string bracketed = with_unit_in_brackets(name, known); !bracketed.empty())
            return input_error_at(table.file, table.header_line,
                                  "column \"{}\" has no meaning in a path; did you mean \"{}\"?", column, bracketed);
        const std::string nearest = nearest_name(name, known);
        if (nearest.empty())
            return input_error_at(table.file, table.header_line,
                                  "column \"{}\" has no meaning in a path; possible are {}", column, join_names(known));
        return input_error_at(table.file, table.header_line,
                              "column \"{}\" has no meaning in a path; did you mean \"{}\"?", column, nearest);
    }
    return {};
}

/// A column in units of `unit_si`, or in the unit given in brackets in its name.
Result<std::vector<double>> read_column(const CsvTable& table, std::size_t column, Dimension dimension,
                                        double unit_si) {
    double factor = 1;
    if (const std::string_view unit = csv_unit(table.columns[column]); !unit.empty()) {
        const Result<double> si = unit_factor(unit, dimension);
        if (!si)
            return input_error_at(table.file, table.header_line, "column \"{}\": {}", table.columns[column],
                                  si.error().message);
        factor = *si / unit_si;
    }
    std::vector<double> values;
    for (const CsvRow& row : table.rows) {
        const Result<double> value = table.number(row, column, table.columns[column]);
        if (!value) return tl::unexpected(value.error());
        values.push_back(factor * *value);
    }
    return values;
}

/// The column of this name, with or without a unit in brackets.
std::optional<std::size_t> find_column(const CsvTable& table, std::string_view name) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        if (bare_name(table.columns[c]) == name) return c;
    }
    return std::nullopt;
}

/// Columns x, y, z; for several markers tip_x, tip_y and so on. A column `time` gives the times.
Status read_path_table(const CsvTable& table, double unit_m, GoalSpec& goal) {
    const std::size_t count = goal.markers.size();
    goal.wanted.assign(table.rows.size(), std::vector<Vec3>(count));
    for (std::size_t m = 0; m < count; ++m) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::string axis_name(1, "xyz"[axis]);
            const std::string name = count == 1 ? axis_name : goal.markers[m] + "_" + axis_name;
            const std::optional<std::size_t> column = find_column(table, name);
            if (!column)
                return input_error_at(table.file, table.header_line, "there is no column \"{}\"; a path needs {}", name,
                                      count == 1 ? "x, y and z" : "MARKER_x, MARKER_y and MARKER_z of every marker");
            const Result<std::vector<double>> values = read_column(table, *column, Dimension::length, unit_m);
            if (!values) return tl::unexpected(values.error());
            for (std::size_t w = 0; w < values->size(); ++w) goal.wanted[w][m][axis] = (*values)[w];
        }
    }
    const std::optional<std::size_t> time = find_column(table, "time");
    if (!time) return {};
    Result<std::vector<double>> times = read_column(table, *time, Dimension::time, 1);
    if (!times) return tl::unexpected(times.error());
    goal.times = std::move(*times);
    return {};
}

void read_path_file(Reader& reader, const Context& context, const std::string& file, GoalSpec& goal) {
    const std::filesystem::path path = need_file(reader, "path", file, context);
    const Result<std::string> text = read_file(path);
    if (!text) return;  // already reported
    const Result<CsvTable> table = parse_csv(*text, path.string(), "x,y,z");
    Status read = table ? check_columns(*table, path_columns(context, goal)) : Status(tl::unexpected(table.error()));
    if (read) read = read_path_table(*table, context.robot.unit_m, goal);
    if (!read) reader.problem("path", read.error().message);
}

/// point = [..], points = [[..], ..] for several markers, path = [[..], ..] or path = "FILE.csv".
void read_position(Reader& reader, const Context& context, GoalSpec& goal) {
    if (goal.markers.empty()) reader.problem("", "names no marker; add marker = \"NAME\"");
    const config::Value* path = reader.raw("path");
    if (reader.has("point")) goal.wanted = {{reader.vector("point")}};
    if (reader.has("points")) goal.wanted = {reader.vectors("points")};
    if (path != nullptr && std::holds_alternative<std::string>(path->data)) {
        read_path_file(reader, context, reader.text("path"), goal);
        return;
    }
    if (path != nullptr) {
        for (const Vec3& point : reader.vectors("path")) goal.wanted.push_back({point});
        if (goal.wanted.empty()) reader.problem("path", "holds no point");
    }
    for (const auto& points : goal.wanted) {
        if (points.size() == goal.markers.size() || goal.markers.empty()) continue;
        reader.problem(
            reader.has("points")  ? "points"
            : reader.has("point") ? "point"
                                  : "path",
            fmt::format("gives {} for {}; several markers take points = [[x, y, z], ...] or a CSV",
                        points.size() == 1 ? "one point" : fmt::format("{} points", points.size()),
                        goal.markers.size() == 1 ? "one marker" : fmt::format("{} markers", goal.markers.size())));
        break;
    }
}

/// Where the file says that two markers are: at the same point, or in the same box.
bool at_one_place(const MarkerSpec& a, const MarkerSpec& b) {
    const auto* point_a = std::get_if<Vec3>(&a.place);
    const auto* point_b = std::get_if<Vec3>(&b.place);
    if (point_a != nullptr && point_b != nullptr) return *point_a == *point_b;
    const auto* box_a = std::get_if<BoxSelector>(&a.place);
    const auto* box_b = std::get_if<BoxSelector>(&b.place);
    return box_a != nullptr && box_b != nullptr && box_a->low == box_b->low && box_a->high == box_b->high;
}

/// Precondition: the places of all markers could be read.
void check_markers_apart(Reader& reader, const Robot& robot, const GoalSpec& goal) {
    if (goal.kind != GoalKind::direction || goal.markers.size() != 2 || goal.markers[0] == goal.markers[1]) return;
    const auto first = std::ranges::find(robot.markers, goal.markers[0], &MarkerSpec::name);
    const auto second = std::ranges::find(robot.markers, goal.markers[1], &MarkerSpec::name);
    if (first == robot.markers.end() || second == robot.markers.end()) return;  // already reported
    if (at_one_place(*first, *second))
        reader.problem("markers", fmt::format("\"{}\" and \"{}\" are at one point, which has no direction",
                                              goal.markers[0], goal.markers[1]));
}

void read_direction(Reader& reader, GoalSpec& goal) {
    goal.kind = GoalKind::direction;
    const config::Value* value = reader.raw("direction");
    const auto* list = std::get_if<config::Array>(&value->data);
    const bool several = list != nullptr && !list->empty() && std::holds_alternative<config::Array>(list->front().data);
    const std::vector<Vec3> directions =
        several ? reader.vectors("direction") : std::vector<Vec3>{reader.vector("direction")};
    for (const Vec3& direction : directions) {
        if (direction == Vec3{}) {
            goal.wanted.clear();
            return reader.problem("direction", "must not be zero");
        }
        goal.wanted.push_back({direction_along(direction)});
    }
    if (goal.markers.size() != 2)
        reader.problem("markers", "a direction is that from one marker to another: markers = [\"a\", \"b\"]");
}

/// force = "2 N", or a list of three; on `obstacle` or `support`.
void read_force(Reader& reader, const Context& context, GoalSpec& goal) {
    const bool contact = reader.has("obstacle");
    goal.kind = contact ? GoalKind::contact_force : GoalKind::support_force;
    if (contact == reader.has("support")) reader.problem("", "a force is that of one obstacle or one support");
    if (contact)
        check_name(reader, "obstacle", "obstacle", goal.on = reader.text("obstacle"), context.robot.obstacles);
    else if (reader.has("support"))
        check_name(reader, "support", "fixed", goal.on = reader.text("support"), context.robot.fixed);
    for (const char* key : {"obstacle", "support"}) (void)reader.raw(key);
    const config::Value* value = reader.raw("force");
    goal.sum_of_sizes = !std::holds_alternative<config::Array>(value->data);
    if (!goal.sum_of_sizes) {
        const std::vector<double> force = reader.quantities("force", Dimension::force, 3);
        goal.wanted = {{Vec3{force[0], force[1], force[2]}}};
        return;
    }
    goal.wanted = {{Vec3{reader.quantity("force", Dimension::force), 0, 0}}};
    if (!contact) reader.problem("force", "of a support has three components: [\"0 N\", \"0 N\", \"2 N\"]");
    if (goal.wanted[0][0].x < 0) reader.problem("force", "is the total contact force of the obstacle: not below zero");
}

double read_tolerance(Reader& reader, GoalSpec& goal, double unit_m) {
    double tolerance = 0;
    if (goal.kind == GoalKind::direction)
        tolerance = reader.quantity("tolerance", Dimension::angle, std::numbers::pi / 180);
    if (goal.kind == GoalKind::position || goal.kind == GoalKind::plane) {
        tolerance = reader.quantity("tolerance", Dimension::length, 0.1 * unit_m);
        goal.default_tolerance = !reader.has("tolerance");
    }
    if (goal.kind == GoalKind::contact_force || goal.kind == GoalKind::support_force)
        tolerance = reader.quantity("tolerance", Dimension::force);
    if (!(tolerance > 0) && (goal.kind == GoalKind::position || reader.has("tolerance")))
        reader.problem("tolerance", "must be above zero");
    return tolerance;
}

void read_goal_times(Reader& reader, GoalSpec& goal) {
    if (reader.has("times")) {
        if (!goal.times.empty()) reader.problem("times", "stand in the CSV already");
        goal.times = reader.numbers("times");
    }
    (void)reader.raw("times");
    if (!goal.times.empty() && goal.wanted.size() == 1) goal.wanted.resize(goal.times.size(), goal.wanted.front());
    // Where no waypoint could be read, that has been reported.
    if (!goal.times.empty() && !goal.wanted.empty() && goal.times.size() != goal.wanted.size())
        reader.problem("times", fmt::format("gives {} for {}", counted(goal.times.size(), "time"),
                                            counted(goal.wanted.size(), "waypoint")));
    for (std::size_t k = 0; k < goal.times.size(); ++k) {
        if (goal.times[k] >= 0 && (k == 0 || goal.times[k] >= goal.times[k - 1])) continue;
        reader.problem("times", "are seconds of the program: not below zero, and in their order");
        break;
    }
}

void read_goal(Reader& reader, Context& context, GoalSpec& goal) {
    constexpr std::array<std::string_view, 6> wants = {"point", "points", "path", "plane", "direction", "force"};
    std::vector<std::string> given;
    for (const std::string_view key : wants) {
        if (reader.has(key)) given.emplace_back(key);
    }
    goal.markers = read_marker_names(reader, context);
    if (given.size() != 1) {
        reader.problem("", given.empty()
                               ? std::string("has no target; add point, points, path, plane, direction or force")
                               : "takes only one of " + join_names(given));
    } else if (given[0] == "plane") {
        goal.kind = GoalKind::plane;
        const PlaneSelector plane = read_plane(reader);
        if (plane.normal != Vec3{}) goal.wanted = {{plane.point, direction_along(plane.normal)}};
        if (goal.markers.size() != 1) reader.problem("marker", "a plane is for one marker");
    } else if (given[0] == "direction") {
        read_direction(reader, goal);
    } else if (given[0] == "force") {
        read_force(reader, context, goal);
    } else {
        read_position(reader, context, goal);
    }
    for (const std::string_view key : wants) (void)reader.raw(key);
    if (goal.kind != GoalKind::contact_force && goal.kind != GoalKind::support_force) {
        for (const char* key : {"obstacle", "support"}) {
            if (reader.raw(key) != nullptr) reader.problem(key, "is for a goal with a force");
        }
    } else if (!goal.markers.empty()) {
        reader.problem("markers", "have no meaning beside force");
    }
    goal.tolerance = read_tolerance(reader, goal, context.robot.unit_m);
    goal.weight = reader.number("weight", 1);
    if (!(goal.weight > 0 && goal.weight <= 1e6)) reader.problem("weight", "is above zero, at most 1000000");
    read_goal_times(reader, goal);
    if (goal.wanted.size() > most_waypoints)
        reader.problem("path", fmt::format("has {} waypoints; {} are possible", goal.wanted.size(), most_waypoints));
}

/// Goals with one waypoint apply to all of them.
void check_together(Reader& root, Robot& robot) {
    std::size_t waypoints = 1;
    std::vector<double> times;
    for (const GoalSpec& goal : robot.goals) {
        waypoints = std::max(waypoints, goal.wanted.size());
        if (times.empty()) times = goal.times;
    }
    for (const GoalSpec& goal : robot.goals) {
        if (goal.wanted.size() > 1 && goal.wanted.size() != waypoints)
            root.problem("goal", fmt::format("\"{}\" has {} waypoints, another goal has {}; they are reached together",
                                             goal.name, goal.wanted.size(), waypoints));
        if (!goal.times.empty() && goal.times != times)
            root.problem("goal", fmt::format("\"{}\" has other times than those of another goal", goal.name));
    }
    const auto steered = [](const auto& actuator) { return actuator.steering.has_value(); };
    if (!robot.goals.empty() && std::ranges::none_of(robot.cables, steered) &&
        std::ranges::none_of(robot.chambers, steered))
        root.problem("goal",
                     "no actuator may move for it; give a cable or chamber a range, such as range = [0.7, 1.0]");
}

}  // namespace

void check_goal_times(Reader& root, const Robot& robot) {
    if (root.unreadable("program")) return;
    for (const GoalSpec& goal : robot.goals) {
        if (const std::string late = late_time(goal, robot.program.duration); !late.empty())
            root.problem("goal", fmt::format("\"{}\" {}; give program.duration", goal.name, late));
    }
}

void read_goals(Reader& root, Context& context) {
    const bool markers_known = !root.unreadable("marker");
    const auto read = [&](Reader& reader, Context& of_robot, GoalSpec& goal) {
        read_goal(reader, of_robot, goal);
        if (markers_known) check_markers_apart(reader, of_robot.robot, goal);
    };
    read_each(root, context, "goal", "goals", context.robot.goals, read);
    check_together(root, context.robot);
}

}  // namespace pliant::robot
