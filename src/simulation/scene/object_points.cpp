#include "simulation/scene/object_points.hpp"

#include <vector>

#include "base/linalg/vectors.hpp"
#include "geometry/repair/surface_shells.hpp"
#include "simulation/elements/affine_body.hpp"

namespace pliant::robot {
namespace {

/// True if a point is inside; one on the surface is inside after a small shift towards the middle.
bool holds(const sim::FreeObject& object, const Vec3& middle, const Vec3& point, double tolerance) {
    const Vec3 way = middle - point;
    const double length = norm(way);
    const Vec3 nearer = length > tolerance ? point + tolerance / length * way : middle;
    return mesh::winding_number(object.surface, nearer) > 0.5 || mesh::winding_number(object.surface, point) > 0.5;
}

std::vector<double> numbers_of(const std::vector<Vec3>& points) {
    std::vector<double> numbers;
    for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    return numbers;
}

}  // namespace

sim::AffinePatch patch_of_object(const sim::Description& description, std::size_t object, const Vec3& center) {
    const std::vector<double> rest = numbers_of(description.mesh.points);
    const std::array<int, 4>& nodes = description.objects[object].nodes;
    const sim::AffineBody body(nodes, 1, rest);
    const linalg::Vector3 at = linalg::vector(center), middle = body.centre(rest);
    const auto shares = body.shares(at);
    sim::AffinePatch patch{{nodes.begin(), nodes.end()}, {shares.begin(), shares.end()}, {}, center, 0};
    for (const linalg::Vector3& slope : body.share_slopes()) patch.slopes.push_back({slope[0], slope[1], slope[2]});
    for (const int node : nodes) patch.reach += 0.25 * (linalg::view(rest, node) - middle).norm();
    return patch;
}

std::optional<sim::Attachment> carried_by_object(const ModelDraft& draft, const sim::Attacher& attacher,
                                                 const Vec3& point) {
    const sim::Description& d = draft.description;
    if (d.objects.empty() || !(attacher.distance_outside(point) > 0)) return std::nullopt;
    for (std::size_t k = 0; k < d.objects.size(); ++k) {
        Vec3 middle;
        Box3 box;
        for (const int node : d.objects[k].nodes) middle += 0.25 * d.mesh.points[static_cast<std::size_t>(node)];
        for (const Vec3& p : d.objects[k].surface.points) box.add(p);
        const double tolerance = 1e-3 * box.diagonal();
        if (holds(d.objects[k], middle, point, tolerance)) return patch_of_object(d, k, point).at(point);
    }
    return std::nullopt;
}

}  // namespace pliant::robot
