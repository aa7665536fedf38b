#include "robot/file/program_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/core/text.hpp"
#include "robot/description/cable_length.hpp"
#include "robot/file/robot_document.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

/// Something that keys can drive: its unit, initial value, and the destination of its curve.
struct Driven {
    std::string name;
    std::optional<Dimension> dimension;  ///< of the value; empty: dimensionless
    double rest = 0;
    double end = 1;       ///< final value without keys
    double low = -1e300;  ///< values outside are refused
    double high = 1e300;
    std::function<void(Curve)> drive;
    int* start_line = nullptr;    ///< receives the line of its key at time 0, if any; may be null
    bool judged = true;           ///< false: what its values mean could not be read
    std::string_view lacks = {};  ///< what is wrong with a key for it, where nothing of it moves; empty: nothing
};

Driven driven(CableSpec& cable) {
    using Kind = CableTarget::Kind;
    const TargetLimits limits = target_limits(cable.target.kind, cable.gap_elements);
    Driven d{cable.name,
             {},
             0,
             cable.target.value,
             limits.low,
             limits.high,
             [&](Curve c) {
                 cable.target.keys = std::move(c); }};
    if (cable.target.kind == Kind::length_ratio) d.rest = 1;
    if (cable.target.kind == Kind::shortening_m) d.dimension = Dimension::length;
    if (cable.target.kind == Kind::tension_N) d.dimension = Dimension::force;
    return d;
}

Driven driven(ChamberSpec& chamber) {
    using Kind = ChamberTarget::Kind;
    Driven d;
    d.name = chamber.name;
    d.end = chamber.target.value;
    d.drive = [&](Curve c) { chamber.target.keys = std::move(c); };
    if (chamber.target.kind == Kind::volume_change_m3) d.dimension = Dimension::volume;
    if (chamber.target.kind == Kind::pressure_Pa) d.dimension = Dimension::pressure;
    if (!d.dimension) d.rest = 1, d.low = 1e-6;
    return d;
}

Driven driven(JointSpec& joint) {
    Driven d{
        joint.name, {}, 0, joint.wanted->value.back(), -1e300, 1e300, [&](Curve c) { joint.wanted = std::move(c); }};
    const bool slides = joint.kind == JointSpec::Kind::slider;
    if (!joint.by_force) d.dimension = slides ? Dimension::length : Dimension::angle;
    if (joint.by_force) d.dimension = slides ? Dimension::force : Dimension::torque;
    return d;
}

/// The entry of a list of the file says how it moves, be it by nothing, as a design may set it.
bool says_motion(const config::Value* list, std::size_t index) {
    const auto* entries = list != nullptr ? std::get_if<config::Array>(&list->data) : nullptr;
    if (entries == nullptr || index >= entries->size()) return false;
    return entry_of((*entries)[index], "move") != nullptr || entry_of((*entries)[index], "rotate") != nullptr;
}

std::vector<Driven> everything_driven(Reader& root, Reader& program, Context& context) {
    Robot& robot = context.robot;
    std::vector<Driven> list;
    const auto add_actuator = [&](auto& actuator) {
        list.push_back(driven(actuator));
        list.back().judged = !context.unclear_targets.contains(actuator.name);
    };
    for (CableSpec& cable : robot.cables) add_actuator(cable);
    for (ChamberSpec& chamber : robot.chambers) add_actuator(chamber);
    for (JointSpec& joint : robot.joints) {
        if (joint.wanted) list.push_back(driven(joint));
    }
    const auto share = [&](const std::string& name, Curve& curve) {
        Driven d;
        d.name = name;
        d.drive = [&](Curve c) { curve = std::move(c); };
        list.push_back(std::move(d));
    };
    for (LoadSpec& load : robot.loads) share(load.name, load.share);
    for (std::size_t k = 0; k < robot.fixed.size(); ++k) {
        share(robot.fixed[k].name, robot.fixed[k].share);
        if (!says_motion(root.raw("fixed"), k))
            list.back().lacks = "this [[fixed]] has neither move nor rotate; add one of them";
    }
    for (std::size_t k = 0; k < robot.obstacles.size(); ++k) {
        ObstacleSpec& obstacle = robot.obstacles[k];
        share(obstacle.name, obstacle.share);
        list.back().start_line = &obstacle.start_line;
        if (!says_motion(root.raw("obstacle"), k)) list.back().lacks = "this [[obstacle]] has no move; add it";
    }
    share("gravity", robot.gravity_share);
    if (robot.program.dynamics) list.back().rest = 1;
    if (!program.has("gravity")) list.back().lacks = "the robot has no program.gravity; add it";
    return list;
}

double read_value(Reader& key, const Driven& d) {
    const double value = d.dimension ? key.quantity(d.name, *d.dimension) : key.number(d.name);
    if (value < d.low || value > d.high) {
        const std::string limit = d.high < 1e300 ? fmt::format(": above 0, at most {:g}", d.high)
                                  : d.low > 0    ? "; it must be above zero"
                                                 : "; it must not be below zero";
        key.problem(d.name, fmt::format("{} is not possible{}", value, limit));
    }
    return value;
}

/// The times of the keys, which must be ascending, or the motion between them would be ambiguous.
std::vector<double> read_times(std::vector<Reader>& keys) {
    std::vector<double> times;
    for (Reader& key : keys) {
        const double time = key.quantity("time", Dimension::time);
        if (time < 0 || (!times.empty() && time <= times.back()))
            key.problem("time", "times must increase from key to key, none below zero");
        times.push_back(time);
    }
    return times;
}

/// The curve through the keys that name `d`; from rest at time 0, and without keys a ramp to its end.
Curve read_curve(std::vector<Reader>& keys, const std::vector<double>& times, const Driven& d, double duration) {
    Curve curve{{0}, {d.rest}};
    if (!d.judged) {
        for (Reader& key : keys) (void)key.raw(d.name);
        return Curve{{0, duration}, {d.rest, d.end}};
    }
    bool named = false;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        (void)keys[k].raw(d.name);  // marks the key as read, so that only misspelt names are reported
        if (!keys[k].has(d.name)) continue;
        named = true;
        const double value = read_value(keys[k], d);
        if (times[k] <= 0) {
            curve.value[0] = value;
            if (d.start_line != nullptr) *d.start_line = keys[k].line_of(d.name);
            continue;
        }
        if (times[k] <= curve.time.back()) continue;  // out of order: already reported
        curve.time.push_back(times[k]);
        curve.value.push_back(value);
    }
    return named ? curve : Curve{{0, duration}, {d.rest, d.end}};
}

/// What is named as the key that says when a key holds cannot be told from it.
void refuse_name_of_time(std::vector<Reader>& keys, const std::vector<Driven>& list) {
    const bool clashes = std::ranges::any_of(list, [](const Driven& d) { return d.name == "time"; });
    if (clashes && !keys.empty())
        keys.front().problem("time",
                             "says when the key holds, and is the name of a cable, load or other thing that keys may "
                             "drive; give that another name");
}

/// A key for what does not move would change nothing. Told at the first one.
void refuse_what_is_still(std::vector<Reader>& keys, const std::vector<Driven>& list) {
    for (const Driven& d : list) {
        if (d.lacks.empty() || d.name == "time" || std::ranges::count(list, d.name, &Driven::name) > 1) continue;
        const auto first = std::ranges::find_if(keys, [&](const Reader& key) { return key.has(d.name); });
        if (first != keys.end()) first->problem(d.name, d.lacks);
    }
}

void read_keys(Reader& root, Reader& program, Context& context) {
    Robot& robot = context.robot;
    std::vector<Reader> keys = program.tables("key");
    double duration = program.quantity("duration", Dimension::time, 1);
    if (!(duration > 0)) program.problem("duration", "must be above zero");
    const std::vector<double> times = read_times(keys);
    if (!times.empty() && times.back() > 0) {
        if (program.has("duration") && duration < times.back()) program.problem("duration", "ends before the last key");
        if (!program.has("duration")) duration = times.back();
    }
    robot.program.duration = duration > 0 ? duration : 1;
    if (keys.empty() && duration == 1 && !robot.program.dynamics) return;
    std::vector<Driven> list = everything_driven(root, program, context);
    refuse_name_of_time(keys, list);
    refuse_what_is_still(keys, list);
    for (std::size_t i = 0; i < list.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (list[i].name != list[j].name) continue;
            for (Reader& key : keys) {
                if (key.has(list[i].name) && list[i].name != "time")
                    key.problem(list[i].name, "names two things; give them different names");
            }
        }
        if (list[i].name == "time" && !keys.empty()) continue;  // refused
        list[i].drive(read_curve(keys, times, list[i], robot.program.duration));
    }
    for (Reader& key : keys) key.finish();
}

/// Prescribed motion does work on the robot that is not part of its energy.
void check_conserving(Reader& program, const Context& context) {
    const auto is_clear = [&](const auto& actuator) { return !context.unclear_targets.contains(actuator.name); };
    for (const CableSpec& cable : context.robot.cables) {
        if (is_clear(cable) && cable.target.kind != CableTarget::Kind::tension_N)
            program.problem("integrator",
                            fmt::format("cable \"{}\" is driven by its length, and energy-conserving steps "
                                        "know only tensions; drive it by tension, or use \"bdf2\"",
                                        cable.name));
    }
    for (const ChamberSpec& chamber : context.robot.chambers) {
        using Kind = ChamberTarget::Kind;
        if (!is_clear(chamber)) continue;
        if (chamber.target.kind == Kind::volume_ratio || chamber.target.kind == Kind::volume_change_m3)
            program.problem("integrator", fmt::format("chamber \"{}\" is driven by its volume, and energy-conserving "
                                                      "steps know only pressures and sealed gas; drive it so, or use "
                                                      "\"bdf2\"",
                                                      chamber.name));
    }
}

/// With a time step, mass and damping take part. Gravity then acts from the beginning.
void read_dynamics(Reader& program, Context& context) {
    Robot& robot = context.robot;
    const bool moving = program.has("time_step");
    if (moving) robot.program.dynamics = Dynamics{};
    const double mass = program.number("mass_damping", 0);
    const double stiffness = program.number("stiffness_damping", 0);
    if (mass < 0) program.problem("mass_damping", "must not be negative (1/s)");
    if (stiffness < 0) program.problem("stiffness_damping", "must not be negative (s)");
    if (!moving && (mass > 0 || stiffness > 0)) program.problem("", "damping has no meaning without time_step");
    const bool conserving = program.choice("integrator", {"bdf2", "energy-conserving"}, "bdf2") == "energy-conserving";
    const double tolerance = program.quantity("time_tolerance", Dimension::length, 0);
    for (const char* key : {"integrator", "time_tolerance"}) {
        if (!moving && program.has(key)) program.problem(key, "has no meaning without time_step");
    }
    if (program.has("time_tolerance") && !(tolerance > 0)) program.problem("time_tolerance", "must be above zero");
    if (conserving) check_conserving(program, context);
    if (moving)
        robot.program.dynamics = Dynamics{{mass, stiffness},
                                          conserving ? Integrator::energy_conserving : Integrator::bdf2,
                                          tolerance > 0 ? tolerance : 0};
}

/// Divides the duration into steps of `time_step`, or of the length next to it that fits a whole number of times.
void spread_steps(Reader& program, Robot& robot) {
    constexpr double most_steps = 1e6, rounding = 1e-9;
    const double step = program.quantity("time_step", Dimension::time);
    if (program.has("steps")) program.problem("steps", "follows from time_step and duration; give one of them");
    for (const char* key : {"duration", "time_step", "key"}) {
        if (program.unreadable(key)) return;
    }
    const double duration = robot.program.duration, fits = step > 0 ? duration / step : 0;
    if (!(step > 0)) return program.problem("time_step", "must be above zero");
    if (fits < 1 - rounding)
        return program.problem("time_step", fmt::format("is longer than the duration, {:.6g} s", duration));
    if (fits > most_steps)
        return program.problem("time_step", fmt::format("makes {:.3g} steps in {:.6g} s; at most {:.0f} are possible",
                                                        fits, duration, most_steps));
    const double steps = std::round(fits);
    robot.program.steps = static_cast<int>(steps);
    robot.program.dynamics->time_step_s = step;
    if (std::fabs(fits - steps) > rounding * steps)
        robot.notes.push_back(
            fmt::format("program.time_step is {:.6g} s instead of {:.6g} s, so that {:.0f} steps fill "
                        "the duration of {:.6g} s",
                        duration / steps, step, steps, duration));
}

}  // namespace

void read_program(config::Reader& root, Context& context) {
    Robot& robot = context.robot;
    config::Reader reader = root.table("program", false);
    Program& program = robot.program;
    program.steps = static_cast<int>(std::clamp<std::int64_t>(reader.integer("steps", 30), -1, 1000000));
    if (program.steps < 1 || program.steps > 100000) {
        reader.problem("steps", "must be between 1 and 100000");
        program.steps = 1;
    }
    program.tolerance = reader.number("tolerance", 1e-4);
    if (!(program.tolerance >= 1e-10 && program.tolerance <= 0.1))
        reader.problem("tolerance", "must be between 1e-10 and 0.1");
    robot.gravity_m_s2 = reader.vector("gravity", Vec3{});
    constexpr double strong_m_s2 = 100;  // ten times that of the earth
    if (norm(robot.gravity_m_s2) > strong_m_s2)
        robot.notes.push_back(
            fmt::format("program.gravity is {:.6g} m/s^2, {:.0f} times that of the earth; it is in m/s^2, "
                        "whatever length_unit is",
                        norm(robot.gravity_m_s2), norm(robot.gravity_m_s2) / 9.81));
    if (robot.fluid && robot.fluid->level && robot.gravity_m_s2 == Vec3{} && !reader.unreadable("gravity"))
        root.problem("fluid", "has a level, and nothing says where up is; give program.gravity");
    const std::string solver =
        reader.choice("solver", {"auto", "newton", "quasi-newton", "anderson", "local-global"}, "auto");
    program.solver = solver_named(solver).value_or(Solver::automatic);
    program.iteration_limit =
        static_cast<int>(std::clamp<std::int64_t>(reader.integer("max_iterations", 0), -1, 100000000));
    if (program.iteration_limit < 0)
        reader.problem("max_iterations", "must be above zero, or 0 for the solver's own limit");
    program.imperfection_m = reader.quantity("imperfection", Dimension::length, 0);
    if (!(program.imperfection_m >= 0)) reader.problem("imperfection", "must not be below zero; 0 only warns");
    robot.ambient_pressure_Pa = reader.quantity("ambient_pressure", Dimension::pressure, 101325);
    if (!(robot.ambient_pressure_Pa > 0)) reader.problem("ambient_pressure", "is an absolute pressure: above zero");
    read_dynamics(reader, context);
    read_keys(root, reader, context);
    if (robot.program.dynamics) spread_steps(reader, robot);
    reader.finish();
}

}  // namespace pliant::robot
