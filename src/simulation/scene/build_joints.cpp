#include "simulation/scene/build_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "simulation/actuators/attach.hpp"
#include "simulation/scene/object_points.hpp"

namespace pliant::robot {
namespace {

/// Stiffness of a joint: this many times that of the stiffest material in a cube as large as the joint's arm, and at
/// least so stiff that the weight of all objects displaces it by no more than this share of the arm.
constexpr double joint_stiffness = 100, sag = 1e-4, g_m_s2 = 9.81;
constexpr double beside_a_plate = 0.01;  // weight of nodes next to a flat plate, which determine its normal
constexpr double soft_clearance = 2;     // in units of the patch, between soft bodies
constexpr double world_arm = std::numeric_limits<double>::infinity();

/// One of the two things.
struct End {
    sim::AffinePatch patch;
    double arm_m = world_arm;
    int object = -2;             ///< as in sim::Joint
    std::optional<Vec3> normal;  ///< of a flat plate
    double clear_m = 0;          ///< how far it extends from the joint, where it may touch the other
};

template <class Specs>
std::optional<std::size_t> index_of(const Specs& specs, const std::string& name) {
    const auto found = std::ranges::find(specs, name, [](const auto& spec) { return spec.name; });
    if (found == specs.end()) return std::nullopt;
    return static_cast<std::size_t>(found - specs.begin());
}

End end_of_object(const ModelDraft& draft, std::size_t object, const Vec3& point) {
    End end;
    end.patch = patch_of_object(draft.description, object, point);
    end.arm_m = end.patch.reach;
    end.object = static_cast<int>(object);
    for (const Vec3& p : draft.description.objects[object].surface.points)
        end.clear_m = std::max(end.clear_m, norm(p - point));
    return end;
}

/// The tets of one body only.
mesh::TetMesh body_alone(const ModelDraft& draft, std::size_t body) {
    const mesh::TetMesh& all = draft.bodies;
    mesh::TetMesh one{all.order, all.points, {}, {}, all.region_names, {}};
    for (std::size_t t = 0; t < all.tet_count(); ++t) {
        if (all.region[t] != static_cast<int>(body)) continue;
        one.region.push_back(all.region[t]);
        one.nodes.insert(one.nodes.end(), all.tet(t).begin(), all.tet(t).end());
    }
    return one;
}

std::optional<End> end_of_body(ModelDraft& draft, std::size_t body, const JointSpec& spec, const Vec3& point) {
    const mesh::TetMesh alone = body_alone(draft, body);
    const sim::Attacher attacher(alone, draft.kept);
    const double radius = spec.radius > 0 ? draft.robot.unit_m * spec.radius : mean_edge(alone);
    Result<sim::AffinePatch> patch = attacher.patch(point, radius, std::max(draft.point_reach, radius));
    if (!patch) {
        const double apart = attacher.distance_outside(point);
        draft.problem(spec.line, "joint", spec.name,
                      apart > std::max(draft.point_reach, radius)
                          ? fmt::format("the point {} lies outside body \"{}\", by {:.3g} mm", draft.show(point),
                                        draft.robot.bodies[body].name, 1e3 * apart)
                          : fmt::format("holds nodes of body \"{}\" that lie in one plane; give a larger radius",
                                        draft.robot.bodies[body].name));
        return std::nullopt;
    }
    End end;
    end.arm_m = patch->reach;
    end.clear_m = soft_clearance * patch->reach;
    end.patch = *std::move(patch);
    end.object = -1;
    return end;
}

/// The direction in which points spread least, and that spread relative to the total.
std::pair<Vec3, double> thinnest(const std::vector<int>& nodes, const std::vector<Vec3>& points) {
    Vec3 mean;
    for (const int node : nodes) mean += points[static_cast<std::size_t>(node)] / static_cast<double>(nodes.size());
    const auto off_mean = [&](int node) { return points[static_cast<std::size_t>(node)] - mean; };
    const auto longest = [&](const auto& vector_of) {
        Vec3 found;
        for (const int node : nodes) {
            const Vec3 v = vector_of(node);
            if (norm(v) > norm(found)) found = v;
        }
        return found;
    };
    const Vec3 farthest = longest(off_mean);
    const Vec3 across = longest([&](int node) { return cross(farthest, off_mean(node)); });
    const double size = norm(farthest);
    const Vec3 normal = norm(across) > 0 ? across / norm(across) : Vec3{0, 0, 1};
    double thick = 0;
    for (const int node : nodes) thick = std::max(thick, std::fabs(dot(normal, off_mean(node))));
    return {normal, size > 0 ? thick / size : 0};
}

/// A flat plate does not determine the motion of points off its plane: the adjacent material does, with a small weight.
std::optional<End> end_of_plate(ModelDraft& draft, std::size_t plate, const JointSpec& spec, const Vec3& point) {
    constexpr double flat = 1e-3;
    const std::vector<Vec3>& points = draft.description.mesh.points;
    const sim::RigidPlate& given = draft.description.plates[plate];
    std::vector<int> nodes = given.nodes;
    const auto [normal, thickness] = thinnest(nodes, points);
    End end;
    double size = 0, nearest = std::numeric_limits<double>::infinity();
    for (const int node : nodes) {
        size =
            std::max(size, norm(points[static_cast<std::size_t>(node)] - points[static_cast<std::size_t>(nodes[0])]));
        nearest = std::min(nearest, norm(points[static_cast<std::size_t>(node)] - point));
    }
    if (nearest > size) {
        draft.problem(spec.line, "joint", spec.name,
                      fmt::format("the point {} is {:.3g} mm from plate \"{}\", which is {:.3g} mm wide",
                                  draft.show(point), 1e3 * nearest, given.name, 1e3 * size));
        return std::nullopt;
    }
    std::vector<bool> on(points.size(), false);
    for (const int node : nodes) on[static_cast<std::size_t>(node)] = true;
    if (thickness < flat) {
        end.normal = normal;
        std::vector<bool> beside(points.size(), false);
        for (std::size_t t = 0; t < draft.bodies.tet_count(); ++t) {
            const auto tet = draft.bodies.tet(t);
            if (std::ranges::none_of(tet, [&](int node) { return on[static_cast<std::size_t>(node)]; })) continue;
            for (const int node : tet) beside[static_cast<std::size_t>(node)] = !on[static_cast<std::size_t>(node)];
        }
        for (std::size_t n = 0; n < beside.size(); ++n)
            if (beside[n]) nodes.push_back(static_cast<int>(n));
    }
    std::vector<double> importance;
    for (const int node : nodes) importance.push_back(on[static_cast<std::size_t>(node)] ? 1 : beside_a_plate);
    std::optional<sim::AffinePatch> patch = sim::fitted_patch(std::move(nodes), importance, points, point);
    if (!patch) {
        draft.problem(spec.line, "joint", spec.name, fmt::format("plate \"{}\" lies on one line", given.name));
        return std::nullopt;
    }
    end.arm_m = 0.5 * size;
    end.clear_m = size;
    end.patch = *std::move(patch);
    end.object = -1;
    return end;
}

std::optional<End> find_end(ModelDraft& draft, const JointSpec& spec, const std::string& name, const Vec3& point) {
    if (name == world_name) {
        End world;
        world.patch.center = point;
        return world;
    }
    if (const auto object = index_of(draft.robot.objects, name)) return end_of_object(draft, *object, point);
    if (const auto plate = index_of(draft.description.plates, name)) return end_of_plate(draft, *plate, spec, point);
    if (const auto body = index_of(draft.robot.bodies, name)) return end_of_body(draft, *body, spec, point);
    return std::nullopt;  // the plate selects no nodes, which has already been reported
}

Vec3 any_normal(const Vec3& axis) {
    const Vec3 other = std::fabs(axis.x) < 0.6 * norm(axis) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    return unit(cross(axis, other));
}

/// True for a flat plate in which a direction normal to the axis can be chosen.
bool has_direction(const End& end, const Vec3& axis) {
    constexpr double along_normal = 1e-3;
    return end.normal && norm(cross(*end.normal, axis)) > along_normal;
}

/// The arms, the joint's axis first. On a flat plate the second lies in the plate, and for glue the first, too.
std::array<Vec3, 3> arms(const JointSpec& spec, const std::array<End, 2>& ends) {
    Vec3 first = unit(spec.axis);
    if (spec.kind == JointSpec::Kind::glue) {
        for (const End& end : ends)
            if (end.normal) first = any_normal(*end.normal);
    }
    Vec3 second = any_normal(first);
    for (const End& end : ends)
        if (has_direction(end, first)) second = unit(cross(*end.normal, first));
    return {first, second, cross(first, second)};
}

/// On a flat plate, which alone is rigid, the third arm is off the plate, where only the soft material beside it would
/// resist a torque. A hinge takes its angle there from the direction in the plate alone; glue and sliders do without
/// that arm.
void leave_out_arm_off_plate(const std::array<End, 2>& ends, const Vec3& axis, sim::Joint& joint) {
    const bool first = has_direction(ends[0], axis), second = has_direction(ends[1], axis);
    const bool at_both = joint.kind != sim::Joint::Kind::hinge;  // distances need the arm on both things
    if (!at_both && first == second) return;
    if (first || (at_both && second)) joint.first[3] = joint.first[0];
    if (second || (at_both && first)) joint.second[3] = joint.second[0];
}

double stiffness(const sim::Description& d, double arm_m) {
    double stiffest = 0, mass = 0;
    for (const sim::Material& material : d.materials)
        stiffest = std::max(stiffest, material::stiffness_bound(material.law));
    for (const sim::FreeObject& object : d.objects) mass += object.mass_kg;
    return std::max(joint_stiffness * stiffest * arm_m, mass * g_m_s2 / (sag * arm_m));
}

sim::JointLaw law_of(const JointSpec& spec) {
    sim::JointLaw law{spec.stiffness, 0, spec.damping};
    if (spec.limits) law.low = (*spec.limits)[0], law.high = (*spec.limits)[1];
    if (!spec.wanted) return law;
    law.drive = spec.by_force ? sim::JointLaw::Drive::force : sim::JointLaw::Drive::place;
    law.wanted = *spec.wanted;
    return law;
}

sim::Joint::Kind kind_of(JointSpec::Kind kind) {
    switch (kind) {
        case JointSpec::Kind::glue:
            return sim::Joint::Kind::glue;
        case JointSpec::Kind::slider:
            return sim::Joint::Kind::slider;
        case JointSpec::Kind::ball:
            return sim::Joint::Kind::ball;
        case JointSpec::Kind::hinge:
        case JointSpec::Kind::motor:
            break;
    }
    return sim::Joint::Kind::hinge;
}

/// Between rigid parts no contact at all, otherwise none near the joint, where they would obstruct each other.
double clearance(const Robot& robot, const JointSpec& spec, const std::array<End, 2>& ends) {
    if (spec.clearance) return robot.unit_m * *spec.clearance;
    if (ends[0].object >= 0 && ends[1].object >= 0) return std::numeric_limits<double>::infinity();
    return std::max(ends[0].clear_m, ends[1].clear_m);
}

/// A motor that is told to go beyond its own stops would only be half obeyed.
void check_target(ModelDraft& draft, const JointSpec& spec) {
    if (!spec.limits || !spec.wanted || spec.by_force) return;
    const auto [lowest, highest] = std::ranges::minmax(spec.wanted->value);
    const auto [low, high] = *spec.limits;
    const double rounding = 1e-9 * (high - low);
    if (lowest >= low - rounding && highest <= high + rounding) return;
    const bool turns = kind_of(spec.kind) == sim::Joint::Kind::hinge;
    const double unit = turns ? std::numbers::pi / 180 : draft.robot.unit_m;
    draft.problem(
        spec.line, "joint", spec.name,
        fmt::format("its target of {:.6g} lies outside its limits, [{:.6g}, {:.6g}]{}",
                    (lowest < low ? lowest : highest) / unit, low / unit, high / unit, turns ? " degrees" : ""));
}

void add_joint(ModelDraft& draft, const JointSpec& spec) {
    check_target(draft, spec);
    const Vec3 point = draft.robot.unit_m * spec.point;
    std::array<End, 2> ends;
    for (std::size_t k = 0; k < 2; ++k) {
        std::optional<End> end = find_end(draft, spec, spec.between[k], point);
        if (!end) return;
        ends[k] = *std::move(end);
    }
    sim::Joint joint;
    joint.name = spec.name;
    joint.kind = kind_of(spec.kind);
    joint.arm_m = std::min(ends[0].arm_m, ends[1].arm_m);
    const std::array<Vec3, 3> directions = arms(spec, ends);
    for (std::size_t p = 0; p < 4; ++p) {
        const Vec3 place = p == 0 ? point : point + joint.arm_m * directions[p - 1];
        joint.first[p] = ends[0].patch.at(place);
        joint.second[p] = ends[1].patch.at(place);
    }
    leave_out_arm_off_plate(ends, directions[0], joint);
    joint.stiffness_N_m = stiffness(draft.description, joint.arm_m);
    joint.law = law_of(spec);
    joint.objects = {ends[0].object, ends[1].object};
    joint.clear_m = clearance(draft.robot, spec, ends);
    draft.description.joints.push_back(std::move(joint));
}

}  // namespace

void add_joints(ModelDraft& draft) {
    for (const JointSpec& joint : draft.robot.joints) add_joint(draft, joint);
}

}  // namespace pliant::robot
