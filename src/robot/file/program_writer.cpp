#include "robot/file/program_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/core/error.hpp"
#include "base/core/json.hpp"

namespace pliant::robot {
namespace {

/// TOML's basic strings have the syntax of JSON strings.
std::string quoted(const std::string& text) {
    return json_text(nlohmann::json(text));
}

/// Something that a key may drive: its value over the robot's own program, and its format.
struct DrivenValue {
    std::string name;
    std::string unit;  ///< empty: dimensionless
    double rest = 0;
    std::function<double(double time)> at;
};

DrivenValue driven_value(const CableSpec& cable) {
    using Kind = CableTarget::Kind;
    const Kind kind = cable.target.kind;
    return {cable.name,
            kind == Kind::shortening_m ? "m"
            : kind == Kind::tension_N  ? "N"
                                       : "",
            kind == Kind::length_ratio ? 1.0 : 0.0, [&](double time) { return cable.target.at(time); }};
}

DrivenValue driven_value(const ChamberSpec& chamber) {
    using Kind = ChamberTarget::Kind;
    const Kind kind = chamber.target.kind;
    const bool ratio = kind == Kind::volume_ratio || kind == Kind::gas_ratio;
    return {chamber.name,
            kind == Kind::volume_change_m3 ? "m^3"
            : kind == Kind::pressure_Pa    ? "Pa"
                                           : "",
            ratio ? 1.0 : 0.0, [&](double time) { return chamber.target.at(time); }};
}

/// Precondition: it is driven.
DrivenValue driven_value(const JointSpec& joint) {
    const bool slides = joint.kind == JointSpec::Kind::slider;
    const char* unit = joint.by_force ? (slides ? "N" : "N m") : (slides ? "m" : "rad");
    return {joint.name, unit, 0, [&](double time) { return joint.wanted->at(time); }};
}

std::vector<DrivenValue> driven_values(const Robot& robot) {
    std::vector<DrivenValue> list;
    for (const CableSpec& cable : robot.cables) list.push_back(driven_value(cable));
    for (const ChamberSpec& chamber : robot.chambers) list.push_back(driven_value(chamber));
    for (const JointSpec& joint : robot.joints) {
        if (joint.wanted) list.push_back(driven_value(joint));
    }
    const auto share = [&](const std::string& name, const Curve& curve) {
        list.push_back({name, "", 0, [&](double time) { return curve.at(time); }});
    };
    for (const LoadSpec& load : robot.loads) share(load.name, load.share);
    for (const FixedSpec& fixed : robot.fixed) share(fixed.name, fixed.share);
    for (const ObstacleSpec& obstacle : robot.obstacles) share(obstacle.name, obstacle.share);
    if (!(robot.gravity_m_s2 == Vec3{})) share("gravity", robot.gravity_share);
    return list;
}

/// The values of one thing at every point.
struct Column {
    const DrivenValue* of = nullptr;
    std::vector<double> values;
};

std::vector<Column> columns_of(const std::vector<DrivenValue>& all, const std::vector<ProgramPoint>& points) {
    std::vector<Column> columns;
    for (const DrivenValue& one : all) {
        Column column{&one, {}};
        for (const ProgramPoint& point : points) {
            const auto given =
                std::ranges::find_if(point.values, [&](const auto& value) { return value.first == one.name; });
            column.values.push_back(given != point.values.end() ? given->second : one.at(point.time));
        }
        const auto is_rest = [&](double value) { return value == one.rest; };
        // Without keys the program ramps to the end value of the file itself.
        const bool needs_none = std::ranges::all_of(column.values, is_rest) && is_rest(one.at(1e300));
        if (!needs_none) columns.push_back(std::move(column));
    }
    return columns;
}

/// False for things without effect, such as a support that does not move, which need no key.
bool does_something(const Robot& robot, const std::string& name) {
    for (const FixedSpec& fixed : robot.fixed) {
        if (fixed.name == name) return fixed.rotate_deg != 0 || !(fixed.move == Vec3{});
    }
    for (const ObstacleSpec& obstacle : robot.obstacles) {
        if (obstacle.name == name) return !(obstacle.move == Vec3{});
    }
    return true;
}

/// Those that the program has keys for.
std::vector<Column> written_columns(const Robot& robot, const std::vector<DrivenValue>& all,
                                    const std::vector<ProgramPoint>& points) {
    std::vector<Column> columns = columns_of(all, points);
    std::erase_if(columns, [&](const Column& column) { return !does_something(robot, column.of->name); });
    return columns;
}

Status unlike_names(const std::filesystem::path& file, const std::vector<DrivenValue>& all,
                    const std::vector<Column>& columns) {
    for (const Column& column : columns) {
        if (std::ranges::count_if(all, [&](const DrivenValue& d) { return d.name == column.of->name; }) > 1)
            return input_error(
                "{}: two things are named \"{}\", which the program must name; give them different names",
                file.string(), column.of->name);
    }
    return {};
}

std::string relative_path(const std::filesystem::path& file, const std::filesystem::path& folder) {
    std::error_code code;
    const std::filesystem::path to = std::filesystem::weakly_canonical(std::filesystem::absolute(file), code);
    const std::filesystem::path from = std::filesystem::weakly_canonical(std::filesystem::absolute(folder), code);
    const std::filesystem::path relative = to.lexically_relative(from);
    return relative.empty() ? to.string() : relative.string();
}

}  // namespace

Status check_program_names(const Robot& robot, const std::filesystem::path& file,
                           const std::vector<std::string>& inputs, const std::vector<double>& times) {
    std::vector<ProgramPoint> points;
    for (const double time : times) {
        ProgramPoint point{time, {}};
        // Not a number is no rest value: an input that may move needs a key.
        for (const std::string& input : inputs)
            point.values.emplace_back(input, std::numeric_limits<double>::quiet_NaN());
        points.push_back(std::move(point));
    }
    const std::vector<DrivenValue> all = driven_values(robot);
    return unlike_names(file, all, written_columns(robot, all, points));
}

int steps_per_point(const Robot& robot, std::size_t points) {
    const auto rubs = [](const auto& thing) { return thing.friction > 0; };
    if (std::ranges::any_of(robot.cables, rubs) || (robot.contact && rubs(*robot.contact)) ||
        std::ranges::any_of(robot.obstacles, rubs))
        return 1;
    constexpr std::size_t fewest = 10;
    return static_cast<int>((fewest + points - 1) / points);
}

Result<ProgramEntries> program_entries(const Robot& robot, const std::filesystem::path& file,
                                       const std::vector<ProgramPoint>& points, int steps_per_point) {
    const std::vector<DrivenValue> all = driven_values(robot);
    const std::vector<Column> columns = written_columns(robot, all, points);
    if (Status status = unlike_names(file, all, columns); !status) return tl::unexpected(status.error());
    ProgramEntries program{
        points.size() * static_cast<std::size_t>(steps_per_point), fmt::format("{} s", points.size()), {}};
    for (std::size_t k = 0; k < points.size(); ++k) {
        program.keys += fmt::format("{}[[program.key]]\ntime = \"{} s\"\n", k > 0 ? "\n" : "", k + 1);
        for (const Column& column : columns) {
            const std::string& unit = column.of->unit;
            program.keys += fmt::format("{} = ", quoted(column.of->name));
            program.keys += unit.empty() ? fmt::format("{}\n", column.values[k])
                                         : fmt::format("\"{} {}\"\n", column.values[k], unit);
        }
    }
    return program;
}

Result<std::string> program_text(const Robot& robot, const std::filesystem::path& file,
                                 const std::vector<std::string>& assignments, const std::filesystem::path& folder,
                                 const std::vector<ProgramPoint>& points, int steps_per_point, double tolerance) {
    const Result<ProgramEntries> program = program_entries(robot, file, points, steps_per_point);
    if (!program) return tl::unexpected(program.error());
    std::string text = fmt::format("robot = {}\n", quoted(relative_path(file, folder)));
    if (!assignments.empty()) {
        text += "set = [";
        for (std::size_t k = 0; k < assignments.size(); ++k) text += (k > 0 ? ", " : "") + quoted(assignments[k]);
        text += "]\n";
    }
    return text + fmt::format("\n[program]\nsteps = {}\nduration = {}\ntolerance = {}\n\n{}", program->steps,
                              quoted(program->duration), tolerance, program->keys);
}

}  // namespace pliant::robot
