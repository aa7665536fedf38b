#include "robot/file/joint_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/core/letters.hpp"
#include "base/core/text.hpp"

namespace pliant::robot {
namespace {

using config::Reader;
using JointKind = JointSpec::Kind;

constexpr double radians = std::numbers::pi / 180;

bool turns(JointKind kind) {
    return kind == JointKind::hinge || kind == JointKind::motor;
}
bool has_axis(JointKind kind) {
    return turns(kind) || kind == JointKind::slider;
}

std::vector<std::string> names_to_join(const Robot& robot) {
    std::vector<std::string> names = {std::string(world_name)};
    for (const BodySpec& body : robot.bodies) names.push_back(body.name);
    for (const PlateSpec& plate : robot.plates) names.push_back(plate.name);
    for (const ObjectSpec& object : robot.objects) names.push_back(object.name);
    return names;
}

/// Both of these are known, and neither is a body: they are held as a whole.
bool are_rigid(const Robot& robot, const std::array<std::string, 2>& between) {
    const std::vector<std::string> names = names_to_join(robot);
    return std::ranges::all_of(between, [&](const std::string& name) {
        return std::ranges::count(names, name) == 1 && std::ranges::count(robot.bodies, name, &BodySpec::name) == 0;
    });
}

void read_between(Reader& reader, const Robot& robot, JointSpec& joint) {
    const std::vector<std::string> given = reader.texts("between");
    if (given.size() != 2) {
        if (reader.has("between")) reader.problem("between", "names two things, as in [\"arm\", \"world\"]");
        return;
    }
    const std::vector<std::string> names = names_to_join(robot);
    for (std::size_t k = 0; k < 2; ++k) {
        joint.between[k] = given[k];
        const auto count = std::ranges::count(names, given[k]);
        if (count == 0)
            reader.problem("between", fmt::format("there is no body, plate or object \"{}\"; there are {}", given[k],
                                                  join_names(names)));
        if (count > 1)
            reader.problem("between", fmt::format("\"{}\" names two things; give them different names", given[k]));
    }
    if (given[0] == given[1])
        reader.problem("between", fmt::format("joins \"{}\" to itself; name two things", given[0]));
}

/// angle and torque of rotating joints, position and force of sliding ones: at most one, and only for driven joints.
void read_drive(Reader& reader, JointSpec& joint) {
    const bool slides = joint.kind == JointKind::slider, is_driven = joint.kind == JointKind::motor || slides;
    const std::string_view place = slides ? "position" : "angle", force = slides ? "force" : "torque";
    for (const std::string_view key : {"angle", "torque", "position", "force"}) {
        if (!reader.has(key) || (is_driven && (key == place || key == force))) continue;
        const bool of_slider = key == "position" || key == "force";
        (void)reader.raw(key);
        reader.problem(key, slides                           ? "a slider takes position or force"
                            : joint.kind == JointKind::motor ? "a motor takes angle or torque"
                            : joint.kind == JointKind::hinge && of_slider
                                ? "is that of a slider; a driven hinge (kind = \"motor\") takes angle or torque"
                            : joint.kind == JointKind::hinge
                                ? "is that of a motor: kind = \"motor\" is a hinge that is driven"
                                : "is that of a motor or a slider");
    }
    if (!is_driven) return;
    const bool has_place = reader.has(place), has_force = reader.has(force);
    double wanted = 0;
    if (has_place) wanted = reader.quantity(place, slides ? Dimension::length : Dimension::angle);
    if (has_force) wanted = reader.quantity(force, slides ? Dimension::force : Dimension::torque);
    (void)reader.raw(place);
    (void)reader.raw(force);
    if (has_place && has_force) reader.problem("", fmt::format("takes one of {} and {}", place, force));
    if (joint.kind == JointKind::motor && !has_place && !has_force)
        reader.problem("", "a motor takes angle or torque, as in angle = \"30 deg\"");
    joint.by_force = has_force;
    if (has_place || has_force) joint.wanted = ramp(0, wanted);
}

/// Degrees, or length units.
void read_limits(Reader& reader, const Robot& robot, JointSpec& joint) {
    if (!reader.has("limits")) return (void)reader.raw("limits");
    if (!has_axis(joint.kind)) return reader.problem("limits", "are those of a hinge, motor or slider");
    const std::vector<double> given = reader.numbers("limits", 2);
    if (given.size() != 2) return;
    if (!(given[0] < given[1])) reader.problem("limits", "the lower one stands first, as in [-30, 60]");
    if (!(given[0] <= 0 && given[1] >= 0))
        reader.problem("limits", "are counted from where the joint is at rest, which is 0 and must lie between them");
    const double unit = turns(joint.kind) ? radians : robot.unit_m;
    joint.limits = {unit * given[0], unit * given[1]};
}

void read_joint(Reader& reader, Context& context, JointSpec& joint) {
    constexpr std::array<std::string_view, 5> kinds = {"glue", "hinge", "slider", "ball", "motor"};
    const std::string kind = reader.choice("kind", {kinds.begin(), kinds.end()});
    const auto found = std::ranges::find(kinds, kind);
    if (found != kinds.end()) joint.kind = static_cast<JointKind>(found - kinds.begin());
    read_between(reader, context.robot, joint);
    joint.point = reader.vector("point");
    if (reader.unreadable("kind")) return skip_keys(reader);
    if (has_axis(joint.kind)) {
        joint.axis = reader.vector("axis");
        if (reader.has("axis") && norm(joint.axis) == 0) reader.problem("axis", "must not be zero");
    } else if (reader.raw("axis") != nullptr) {
        reader.problem("axis", "is that of a hinge, motor or slider");
    }
    joint.radius = reader.quantity("radius", Dimension::length, 0) / context.robot.unit_m;
    if (reader.has("radius") && !(joint.radius > 0))
        reader.problem("radius", "must be above zero");
    else if (reader.has("radius") && are_rigid(context.robot, joint.between))
        reader.problem("radius", fmt::format("is that of the material of a body; neither \"{}\" nor \"{}\" is one",
                                             joint.between[0], joint.between[1]));
    if (turns(joint.kind))
        joint.stiffness = reader.quantity("stiffness", Dimension::torsional_stiffness, 0);
    else if (joint.kind == JointKind::slider)
        joint.stiffness = reader.quantity("stiffness", Dimension::stiffness, 0);
    else if (reader.raw("stiffness") != nullptr)
        reader.problem("stiffness", "is that of a hinge, motor or slider; a [[spring]] is elastic along its length");
    joint.damping = reader.number("damping", 0);
    if (!(joint.damping >= 0)) reader.problem("damping", "must not be negative");
    if (joint.stiffness < 0) reader.problem("stiffness", "must not be negative");
    if (joint.damping > 0 && !has_axis(joint.kind))
        reader.problem("damping", "is that of a hinge, motor or slider");
    else
        check_needs_time(reader, "damping", joint.damping > 0, context);
    read_limits(reader, context.robot, joint);
    read_drive(reader, joint);
    if (reader.has("clearance")) {
        joint.clearance = reader.quantity("clearance", Dimension::length) / context.robot.unit_m;
        if (!(*joint.clearance > 0)) reader.problem("clearance", "must be above zero");
    }
    (void)reader.raw("clearance");
}

}  // namespace

void read_joints(Reader& root, Context& context) {
    read_each(root, context, "joint", "joints", context.robot.joints, read_joint);
}

}  // namespace pliant::robot
