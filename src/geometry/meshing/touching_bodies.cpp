#include "geometry/meshing/touching_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/core/boxes.hpp"
#include "base/core/disjoint_sets.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/meshing/gmsh_kernel.hpp"

namespace pliant::mesh {
namespace {

/// Faces at most this far apart, as a fraction of the size, touch.
constexpr double touch = 0.01;
/// Deviation of triangles from a solid, as a fraction of the size.
constexpr double chord = 0.02;

/// A surface with data cached for repeated queries.
struct Shape {
    TriangleTree tree;
    Box3 box;
    explicit Shape(TriMesh surface) : tree(std::move(surface)), box(bounds(tree.surface())) {}

    [[nodiscard]] bool holds(const Vec3& p) const { return box.contains(p) && tree.winding_number(p) > 0.5; }
};

/// True if a point directly beside a face of `one`, on either side, is in `other`.
bool reaches(const Shape& one, const Shape& other, double size) {
    constexpr int most = 64;  // rows of samples on a triangle
    const TriMesh& surface = one.tree.surface();
    for (const auto& [i, j, k] : surface.triangles) {
        const auto at = [&](int n) { return surface.points[static_cast<std::size_t>(n)]; };
        const Vec3 a = at(i), u = at(j) - a, v = at(k) - a;
        const Vec3 normal = cross(u, v);
        const double area = norm(normal);
        Box3 box;
        for (const int n : {i, j, k}) box.add(at(n));
        if (!(area > 0) || !boxes_meet(box, other.box, touch * size)) continue;
        const Vec3 aside = touch * size / area * normal;
        const double longest = std::max({norm(u), norm(v), norm(u - v)});
        const int rows = static_cast<int>(std::clamp(std::ceil(longest / size), 1.0, static_cast<double>(most)));
        for (int r = 0; r < rows; ++r) {
            for (int c = 0; r + c < rows; ++c) {
                const Vec3 p = a + (r + 1.0 / 3) / rows * u + (c + 1.0 / 3) / rows * v;
                if (other.holds(p + aside) || other.holds(p - aside)) return true;
            }
        }
    }
    return false;
}

class Finder {
public:
    Finder(std::span<const BodyGeometry> bodies, double size) : bodies_(bodies), size_(size), shapes_(bodies.size()) {
        for (const BodyGeometry& body : bodies) boxes_.push_back(bounds(body));
    }

    Result<std::vector<TouchingGroup>> find() {
        if (std::none_of(bodies_.begin(), bodies_.end(), is_surface)) return std::vector<TouchingGroup>{};
        DisjointSets groups(bodies_.size());
        for (std::size_t j = 1; j < bodies_.size(); ++j) {
            for (std::size_t i = 0; i < j; ++i) {
                const int one = static_cast<int>(i), other = static_cast<int>(j);
                if (groups.find(one) == groups.find(other) || !boxes_meet(boxes_[i], boxes_[j], touch * size_))
                    continue;
                const Result<bool> joined = do_touch(i, j);
                if (!joined) return tl::unexpected(joined.error());
                if (*joined) groups.join(one, other);
            }
        }
        return collect(groups);
    }

private:
    static bool is_surface(const BodyGeometry& body) { return std::holds_alternative<TriMesh>(body.shape); }

    Result<const Shape*> shape(std::size_t body) {
        std::optional<Shape>& kept = shapes_[body];
        if (kept) return &*kept;
        if (is_surface(bodies_[body])) return &kept.emplace(std::get<TriMesh>(bodies_[body].shape));
        Result<TriMesh> surface = kernel::tessellate(std::get<Solid>(bodies_[body].shape), chord * size_);
        if (!surface) return tl::unexpected(surface.error());
        return &kept.emplace(std::move(*surface));
    }

    Result<bool> do_touch(std::size_t i, std::size_t j) {
        const Result<const Shape*> one = shape(i);
        if (!one) return tl::unexpected(one.error());
        const Result<const Shape*> other = shape(j);
        if (!other) return tl::unexpected(other.error());
        return reaches(**one, **other, size_) || reaches(**other, **one, size_);
    }

    std::vector<TouchingGroup> collect(DisjointSets& groups) {
        std::vector<TouchingGroup> found;
        for (std::size_t first = 0; first < bodies_.size(); ++first) {
            const auto is_of_group = [&](std::size_t b) {
                return groups.find(static_cast<int>(b)) == static_cast<int>(first);
            };
            if (!is_of_group(first)) continue;
            TouchingGroup group;
            for (std::size_t b = first; b < bodies_.size(); ++b) {
                if (is_of_group(b)) group.bodies.push_back(b);
            }
            const bool any = std::any_of(group.bodies.begin(), group.bodies.end(),
                                         [&](std::size_t b) { return is_surface(bodies_[b]); });
            if (group.bodies.size() < 2 || !any) continue;
            for (const std::size_t b : group.bodies) group.surfaces.push_back(shapes_[b]->tree.surface());
            found.push_back(std::move(group));
        }
        return found;
    }

    std::span<const BodyGeometry> bodies_;
    double size_;
    std::vector<Box3> boxes_;
    std::vector<std::optional<Shape>> shapes_;  ///< of the bodies that are near another
};

}  // namespace

Result<std::vector<TouchingGroup>> touching_groups(std::span<const BodyGeometry> bodies, double size) {
    return Finder(bodies, size).find();
}

}  // namespace pliant::mesh
