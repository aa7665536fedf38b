#include "geometry/meshing/notches.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "base/core/boxes.hpp"
#include "geometry/mesh/triangle_corners.hpp"
#include "geometry/mesh/triangle_tree.hpp"

namespace pliant::mesh {
namespace {

struct Crossing {
    Vec3 from, to;
};

/// Where the path crosses empty space from material to material.
std::vector<Crossing> crossings(const TriangleTree& tree, const std::vector<Vec3>& path) {
    constexpr double step = 1e-9;  // past a hit, as a fraction of the segment
    std::vector<Vec3> marks;
    for (std::size_t i = 1; i < path.size(); ++i) {
        const Vec3 along = path[i] - path[i - 1];
        marks.push_back(path[i - 1]);
        double last = 0;
        while (const auto hit = tree.first_hit(path[i - 1], along, last + step)) {
            if (hit->distance >= 1 - step) break;
            last = hit->distance;
            marks.push_back(path[i - 1] + last * along);
        }
    }
    if (!path.empty()) marks.push_back(path.back());
    std::vector<Crossing> found;
    std::optional<Vec3> left;
    bool was_inside = false;
    for (std::size_t i = 1; i < marks.size(); ++i) {
        if (marks[i] == marks[i - 1]) continue;
        const bool inside = tree.winding_number(0.5 * (marks[i - 1] + marks[i])) > 0.5;
        if (inside && left) found.push_back({*left, marks[i - 1]});
        if (inside) left.reset();
        if (!inside && was_inside) left = marks[i - 1];
        was_inside = inside;
    }
    return found;
}

/// Approximate distance of a point from a triangle: exact along its plane's normal, and zero over the triangle.
double distance_to(const Corners& t, const Vec3& p) {
    const Vec3 n = area_normal(t);
    const Vec3 unit = n / norm(n);
    double outside = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = t[(k + 1) % 3] - t[k];
        const Vec3 outward = cross(edge, unit);
        outside = std::max(outside, dot(p - t[k], outward) / norm(outward));
    }
    return std::hypot(outside, dot(p - t[0], unit));
}

using EdgeTriangles = std::map<std::pair<int, int>, std::vector<std::size_t>>;

EdgeTriangles triangles_of_edges(const TriMesh& surface) {
    EdgeTriangles triangles;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k)
            triangles[std::minmax(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3])].push_back(t);
    }
    return triangles;
}

/// A face of the surface: its position, and its projected size along the path.
struct NotchFace {
    std::vector<Vec3> points;
    double seen_area = 0;
};

/// The face connected to the triangle at `p` whose triangles look along `direction`.
NotchFace face_at(const TriMesh& surface, const EdgeTriangles& edges, const Vec3& p, const Vec3& direction) {
    constexpr double looks_along = 0.1;  // cosine; a face that the path only grazes is not a flank
    const auto facing = [&](std::size_t t) {
        const Vec3 n = area_normal(corners(surface, t));
        return norm(n) > 0 && dot(n, direction) > looks_along * norm(n);
    };
    std::size_t seed = surface.triangles.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (!facing(t)) continue;
        const double away = distance_to(corners(surface, t), p);
        if (away < least) {
            least = away;
            seed = t;
        }
    }
    NotchFace face;
    if (seed == surface.triangles.size()) return face;
    std::vector<bool> seen(surface.triangles.size(), false);
    std::vector<std::size_t> open = {seed};
    seen[seed] = true;
    while (!open.empty()) {
        const std::size_t t = open.back();
        open.pop_back();
        const Corners c = corners(surface, t);
        face.points.insert(face.points.end(), c.begin(), c.end());
        face.seen_area += dot(area_normal(c), direction);
        for (std::size_t k = 0; k < 3; ++k) {
            for (const std::size_t other :
                 edges.at(std::minmax(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]))) {
                if (seen[other] || !facing(other)) continue;
                seen[other] = true;
                open.push_back(other);
            }
        }
    }
    return face;
}

struct Plane {
    Vec3 normal;  ///< outward unit normal
    double offset;
    std::vector<Corners> triangles;
    bool material = false;  ///< directly outside of it
};

/// The planes of the convex hull, with the triangles on each; empty where all points lie in one plane.
std::vector<Plane> hull_planes(const std::vector<Vec3>& points, double size) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    std::vector<Kernel::Point_3> in;
    in.reserve(points.size());
    for (const Vec3& p : points) in.emplace_back(p.x, p.y, p.z);
    CGAL::Surface_mesh<Kernel::Point_3> hull;
    CGAL::convex_hull_3(in.begin(), in.end(), hull);
    std::vector<Plane> planes;
    if (hull.number_of_faces() < 4) return planes;
    for (const auto face : hull.faces()) {
        std::vector<Vec3> ring;
        for (const auto vertex : hull.vertices_around_face(hull.halfedge(face))) {
            const auto& p = hull.point(vertex);
            ring.push_back({p.x(), p.y(), p.z()});
        }
        for (std::size_t k = 2; k < ring.size(); ++k) {
            const Corners t = {ring[0], ring[k - 1], ring[k]};
            const Vec3 n = area_normal(t);
            if (norm(n) < 1e-10 * size * size) continue;
            const Vec3 unit = n / norm(n);
            const double offset = dot(unit, t[0]);
            const auto same = std::find_if(planes.begin(), planes.end(), [&](const Plane& plane) {
                return norm(plane.normal - unit) < 1e-5 && std::fabs(plane.offset - offset) < 1e-6 * size;
            });
            if (same == planes.end())
                planes.push_back({unit, offset, {t}});
            else
                same->triangles.push_back(t);
        }
    }
    return planes;
}

/// Whether most of what is `away` outside a plane's triangles is material.
bool material_behind(const TriangleTree& tree, const Plane& plane, double away) {
    double material = 0;
    double all = 0;
    for (const Corners& t : plane.triangles) {
        for (const auto& [u, v] :
             {std::pair(1. / 3, 1. / 3), std::pair(0.7, 0.15), std::pair(0.15, 0.7), std::pair(0.15, 0.15)}) {
            const Vec3 p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) + away * plane.normal;
            const double weight = norm(area_normal(t));
            all += weight;
            material += tree.winding_number(p) > 0.5 ? weight : 0;
        }
    }
    return 2 * material > all;
}

/// Planes on a round wall are chords of it: the true wall is a little farther out, and bounds the notch by itself.
std::vector<Plane> without_chords(std::vector<Plane> planes) {
    constexpr double smooth_deg = 30;
    const double smooth = std::cos(smooth_deg * std::numbers::pi / 180);
    std::vector<Plane> kept;
    for (const Plane& plane : planes) {
        const bool chord = plane.material && std::any_of(planes.begin(), planes.end(), [&](const Plane& other) {
                               return &other != &plane && other.material && dot(other.normal, plane.normal) > smooth;
                           });
        if (!chord) kept.push_back(plane);
    }
    return kept;
}

/// The sides of the prism along `direction` around points.
std::vector<Plane> prism_sides(const std::vector<Vec3>& points, const Vec3& direction, double size) {
    std::vector<Vec3> both = points;
    for (const Vec3& p : points) both.push_back(p + size * direction);
    std::vector<Plane> planes = hull_planes(both, size);
    std::erase_if(planes, [&](const Plane& plane) { return std::fabs(dot(plane.normal, direction)) > 1e-4; });
    return planes;
}

Solid solid(decltype(SolidNode::shape) shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

/// Everything on the inner side of a plane, within `reach` of the projection of `near` onto it.
Solid half_space(const Plane& plane, const Vec3& near, double reach) {
    const Solid below = solid(BoxSolid{{-reach, -reach, -2 * reach}, {reach, reach, 0}});
    const Vec3 up{0, 0, 1};
    const Vec3 axis = cross(up, plane.normal);
    const double angle = std::atan2(norm(axis), plane.normal.z);
    const Vec3 about = norm(axis) > 1e-12 ? axis : Vec3{1, 0, 0};
    const Vec3 foot = near - (dot(near, plane.normal) - plane.offset) * plane.normal;
    return solid(TranslatedSolid{solid(RotatedSolid{below, {}, about, angle}), foot});
}

std::optional<Notch> notch_at(const TriangleTree& tree, const EdgeTriangles& edges, const Crossing& crossing) {
    const TriMesh& surface = tree.surface();
    const Vec3 along = crossing.to - crossing.from;
    const double width = norm(along);
    const NotchFace left = face_at(surface, edges, crossing.from, along / width);
    const NotchFace entered = face_at(surface, edges, crossing.to, -1 * along / width);
    if (left.points.empty() || entered.points.empty()) return std::nullopt;
    std::vector<Vec3> points = left.points;
    points.insert(points.end(), entered.points.begin(), entered.points.end());
    const Box3 box = bounds_of(points);
    const double size = box.diagonal();
    const double away = 0.05 * width;  // more than the distance of a round wall from its chords
    std::vector<Plane> planes = hull_planes(points, size);
    if (planes.empty()) return std::nullopt;
    for (Plane& plane : planes) plane.material = material_behind(tree, plane, away);
    planes = without_chords(std::move(planes));
    const NotchFace& smaller = left.seen_area < entered.seen_area ? left : entered;
    if (std::max(left.seen_area, entered.seen_area) > 1.5 * smaller.seen_area) {
        const std::vector<Plane> sides = prism_sides(smaller.points, along / width, size);
        planes.insert(planes.end(), sides.begin(), sides.end());
    }
    const Vec3 margin = 2 * away * Vec3{1, 1, 1};
    CombinedSolid hull{CombinedSolid::Operation::intersect, {solid(BoxSolid{box.low - margin, box.high + margin})}};
    const Vec3 middle = 0.5 * (crossing.from + crossing.to);
    for (const Plane& plane : planes) hull.parts.push_back(half_space(plane, middle, 2 * size));
    return Notch{solid(std::move(hull)), middle, crossing.from, crossing.to};
}

}  // namespace

namespace kernel {

std::vector<Notch> crossed_notches(const TriMesh& surface, const std::vector<Vec3>& path) {
    const TriangleTree tree(surface);
    const EdgeTriangles edges = triangles_of_edges(surface);
    std::vector<Notch> notches;
    for (const Crossing& crossing : crossings(tree, path)) {
        if (auto notch = notch_at(tree, edges, crossing)) notches.push_back(std::move(*notch));
    }
    return notches;
}

}  // namespace kernel

}  // namespace pliant::mesh
