#include "simulation/scene/build_cables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robot/bodies/passage.hpp"
#include "simulation/scene/build_places.hpp"
#include "simulation/scene/object_points.hpp"
#include "simulation/scene/symmetry_planes.hpp"
#include "simulation/scene/target_values.hpp"

namespace pliant::robot {
namespace {

/// Intersections of the straight line from a to b with the outer surface, in order, without its ends.
std::vector<Vec3> crossings(const ModelDraft& draft, const Vec3& a, const Vec3& b) {
    std::vector<double> hits;
    const auto& p = draft.description.mesh.points;
    const Vec3 d = b - a;
    for (const mesh::Face& face : mesh::boundary_faces(draft.bodies)) {
        // Moeller and Trumbore 1997; edges are included, so that no hit falls between two triangles.
        const Vec3 e1 = p[face.nodes[1]] - p[face.nodes[0]];
        const Vec3 e2 = p[face.nodes[2]] - p[face.nodes[0]];
        const Vec3 h = cross(d, e2);
        const double determinant = dot(e1, h);
        if (std::fabs(determinant) < 1e-12 * norm(d) * norm(e1) * norm(e2)) continue;
        const Vec3 s = a - p[face.nodes[0]];
        const double u = dot(s, h) / determinant;
        const Vec3 q = cross(s, e1);
        const double v = dot(d, q) / determinant;
        const double t = dot(e2, q) / determinant;
        if (u > -1e-9 && v > -1e-9 && u + v < 1 + 1e-9) hits.push_back(t);
    }
    std::sort(hits.begin(), hits.end());
    const double near = draft.tolerance / norm(d);
    std::vector<Vec3> points;
    double last = 0;
    for (const double t : hits) {
        if (t < near || t > 1 - near || t < last + near) continue;
        points.push_back(a + t * d);
        last = t;
    }
    return points;
}

/// The guide points of a cable, metres: as given, plus the requested ones at crossings.
std::vector<Vec3> guide_points(const ModelDraft& draft, const CableSpec& spec) {
    std::vector<Vec3> points;
    for (const Vec3& given : spec.points) {
        const Vec3 point = draft.robot.unit_m * given;
        if (spec.guides_at_crossings && !points.empty()) {
            const auto between = crossings(draft, points.back(), point);
            points.insert(points.end(), between.begin(), between.end());
        }
        points.push_back(point);
    }
    return points;
}

/// T3.5: every gap that the cable passes shrinks along it.
void drive_by_gaps(ModelDraft& draft, const CableSpec& spec, const std::vector<Vec3>& points) {
    const std::size_t before = draft.description.growths.size();
    for (const GapSpec& gap : draft.robot.gaps) {
        for (const int region : draft.regions_of_gap(gap)) {
            const Passage passage = passage_through(draft.description.mesh, region, points);
            const auto actuator = static_cast<int>(draft.description.cables.size());
            const int material = draft.description.material_of_region[static_cast<std::size_t>(region)];
            if (!(passage.length > 0)) continue;
            const double weight_Pa = gap.weight.value_or(spec.weight) * softest_Pa(draft.robot);
            draft.description.growths.push_back(
                {material, passage.direction, actuator, weight_Pa, passage.length, passage.center});
        }
    }
    if (draft.description.growths.size() == before)
        draft.problem(spec.line, "cable", spec.name, "passes no [[gap]], which model = \"gap-elements\" needs");
}

/// What remains of a cable of this length; empty if its tension is given.
std::optional<double> length_at(const sim::CableTarget& target, double value, double rest_m) {
    if (target.kind == sim::CableTarget::Kind::tension_N) return std::nullopt;
    const bool ratio = target.kind == sim::CableTarget::Kind::length_ratio;
    return (ratio ? value * rest_m : rest_m - value) + target.offset;
}

/// No cable becomes shorter than nothing.
void check_shortening(ModelDraft& draft, const CableSpec& spec, const std::vector<Vec3>& points) {
    double rest_m = 0;
    for (std::size_t k = 1; k < points.size(); ++k) rest_m += norm(points[k] - points[k - 1]);
    for (const TargetValue& wanted : target_values(spec)) {
        const std::optional<double> length_m = length_at(spec.target, wanted.value, rest_m);
        if (!length_m || *length_m > 0) continue;
        return draft.problem(spec.line, "cable", spec.name,
                             fmt::format("{}cannot be shortened by {:.6g} mm{}, it is {:.6g} mm long", wanted.where,
                                         1e3 * (rest_m - *length_m), with_offset(spec.target.offset), 1e3 * rest_m));
    }
}

/// Attachments of the points of a path; `kind`, `point` and the fields of the spec are for messages.
template <class Spec>
std::vector<sim::Attachment> attach_path(ModelDraft& draft, const sim::Attacher& attacher, const Spec& spec,
                                         const std::vector<Vec3>& points, std::string_view kind,
                                         std::string_view point) {
    const std::vector<sim::SymmetryPlane> planes = planes_of_path(draft.description, points);
    std::vector<sim::Attachment> attached;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const bool anchored =
            (k == 0 && spec.anchor == Anchor::first) || (k + 1 == points.size() && spec.anchor == Anchor::last);
        if (anchored) {
            attached.push_back({{}, {}, points[k]});
            continue;
        }
        if (auto on_object = carried_by_object(draft, attacher, points[k])) {
            attached.push_back(*std::move(on_object));
            continue;
        }
        Result<sim::Attachment> attachment =
            attacher.spread(points[k], draft.robot.unit_m * spec.eyelet_radius, draft.point_reach, planes);
        if (!attachment) {
            const bool end = k == 0 || k + 1 == points.size();
            draft.problem(spec.line, kind, spec.name,
                          fmt::format("{} {} at {} lies outside every body, by {:.3g} mm{}", point, k + 1,
                                      draft.show(points[k]), 1e3 * attacher.distance_outside(points[k]),
                                      end ? "; anchor = \"first\" or \"last\" fixes an end in space" : ""));
            continue;
        }
        draft.count_point("guide points", attacher.distance_outside(points[k]));
        attached.push_back(std::move(*attachment));
    }
    return attached;
}

void add_spring(ModelDraft& draft, const sim::Attacher& attacher, const SpringSpec& spec) {
    std::vector<Vec3> points;
    for (const Vec3& point : spec.points) points.push_back(draft.robot.unit_m * point);
    sim::Spring spring{spec.name, attach_path(draft, attacher, spec, points, "spring", "point"), spec.stiffness_N_m};
    if (spec.free_length) spring.free_length_m = draft.robot.unit_m * *spec.free_length;
    spring.only_pulls = spec.only_pulls;
    draft.description.springs.push_back(std::move(spring));
}

void add_cable(ModelDraft& draft, const sim::Attacher& attacher, const CableSpec& spec) {
    const auto points = guide_points(draft, spec);
    sim::Cable cable{
        spec.name,
        attach_path(draft, attacher, spec, points, "cable", spec.guides_at_crossings ? "guide point" : "point"),
        spec.target, spec.friction, spec.anchor != Anchor::last};
    check_shortening(draft, spec, points);
    const bool complete = cable.points.size() == points.size();  // otherwise the error is told already
    if (complete && cable.target.kind != sim::CableTarget::Kind::tension_N && are_held(draft.description, cable.points))
        draft.problem(spec.line, "cable", spec.name,
                      "cannot change its length: all of its points are fixed in space or in a [[fixed]]");
    if (spec.gap_elements) drive_by_gaps(draft, spec, points);
    draft.description.cables.push_back(std::move(cable));
}

}  // namespace

void add_cables(ModelDraft& draft, const sim::Attacher& attacher) {
    for (const CableSpec& cable : draft.robot.cables) add_cable(draft, attacher, cable);
}

void add_springs(ModelDraft& draft, const sim::Attacher& attacher) {
    for (const SpringSpec& spring : draft.robot.springs) add_spring(draft, attacher, spring);
}

}  // namespace pliant::robot
