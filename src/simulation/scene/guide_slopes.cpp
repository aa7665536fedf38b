#include "simulation/scene/guide_slopes.hpp"

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "simulation/scene/model_draft.hpp"
#include "simulation/scene/object_points.hpp"
#include "simulation/scene/symmetry_planes.hpp"

namespace pliant::robot {
namespace {

constexpr double anywhere = std::numeric_limits<double>::infinity();  // the model was built before: no distance is too
                                                                      // large

/// The object that a point is attached to, if any.
std::optional<std::size_t> object_of(const sim::Description& d, const sim::Attachment& point) {
    for (std::size_t k = 0; k < d.objects.size(); ++k) {
        if (!point.nodes.empty() && point.nodes[0] == d.objects[k].nodes[0]) return k;
    }
    return std::nullopt;
}

/// Adds the guide points of one cable or spring, which `from` identifies.
Status add_path(const sim::Description& d, const sim::Attacher& attacher, std::span<const double> rest,
                std::span<const sim::Attachment> points, double radius_m, const GuideSlope& from,
                std::vector<GuideSlope>& sum) {
    std::vector<Vec3> at_rest;
    for (const sim::Attachment& point : points) at_rest.push_back(position(point, rest));
    const std::vector<sim::SymmetryPlane> planes = planes_of_path(d, at_rest);
    for (std::size_t k = 0; k < points.size(); ++k) {
        GuideSlope guide = from;
        guide.name = fmt::format("{}: point {}", from.name, k + 1);
        guide.point = k;
        guide.rest_m = at_rest[k];
        if (const auto object = object_of(d, points[k])) {
            sim::AffinePatch patch = patch_of_object(d, *object, guide.rest_m);
            guide.slope = {std::move(patch.nodes), std::move(patch.slopes)};
        } else if (!points[k].nodes.empty()) {
            Result<sim::AttachmentSlope> slope = attacher.slope(guide.rest_m, radius_m, anywhere, planes);
            if (!slope) return tl::unexpected(slope.error());
            guide.slope = std::move(*slope);
        }
        sum.push_back(std::move(guide));
    }
    return {};
}

}  // namespace

Result<std::vector<GuideSlope>> guide_slopes(const Robot& robot, const sim::Model& model) {
    const sim::Description& d = model.description();
    const mesh::TetMesh bodies = tets_of_bodies(robot, d.mesh);
    const sim::Attacher attacher(bodies);
    std::vector<double> rest;
    for (const Vec3& p : d.mesh.points) rest.insert(rest.end(), {p.x, p.y, p.z});
    std::vector<GuideSlope> all;
    for (std::size_t c = 0; c < d.cables.size(); ++c) {
        const GuideSlope from{fmt::format("cable \"{}\"", d.cables[c].name), false, c, 0, {}, {}};
        const double radius_m = robot.unit_m * robot.cables[c].eyelet_radius;
        if (Status added = add_path(d, attacher, rest, d.cables[c].points, radius_m, from, all); !added)
            return tl::unexpected(added.error());
    }
    for (std::size_t s = 0; s < d.springs.size(); ++s) {
        const GuideSlope from{fmt::format("spring \"{}\"", d.springs[s].name), true, s, 0, {}, {}};
        const double radius_m = robot.unit_m * robot.springs[s].eyelet_radius;
        if (Status added = add_path(d, attacher, rest, d.springs[s].points, radius_m, from, all); !added)
            return tl::unexpected(added.error());
    }
    return all;
}

}  // namespace pliant::robot
