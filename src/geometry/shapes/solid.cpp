#include "geometry/shapes/solid.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/rotation.hpp"
#include "geometry/mesh/triangle_tree.hpp"

namespace pliant::mesh {
namespace {

Vec3 rotated(const Vec3& p, const RotatedSolid& r, double angle) {
    return turned(p - r.center, unit(r.axis), angle, r.center);
}

bool polygon_contains(const std::vector<std::array<double, 2>>& polygon, double u, double v) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const auto& [ui, vi] = polygon[i];
        const auto& [uj, vj] = polygon[j];
        if ((vi > v) != (vj > v) && u < (uj - ui) * (v - vi) / (vj - vi) + ui) inside = !inside;
    }
    return inside;
}

struct Contains {
    Vec3 p;

    bool operator()(const BoxSolid& s) const { return Box3{s.low, s.high}.contains(p); }
    bool operator()(const SphereSolid& s) const { return norm(p - s.center) <= s.radius; }
    bool operator()(const CylinderSolid& s) const {
        const Vec3 axis = s.to - s.from;
        const double along = dot(p - s.from, axis) / dot(axis, axis);
        return along >= 0 && along <= 1 && norm(p - s.from - along * axis) <= s.radius;
    }
    bool operator()(const PrismSolid& s) const {
        const double w = p[static_cast<std::size_t>(s.axes[2])];
        return w >= s.from && w <= s.to &&
               polygon_contains(s.polygon, p[static_cast<std::size_t>(s.axes[0])],
                                p[static_cast<std::size_t>(s.axes[1])]);
    }
    bool operator()(const CombinedSolid& s) const {
        using Operation = CombinedSolid::Operation;
        const auto inside = [&](const Solid& part) { return contains(part, p); };
        if (s.operation == Operation::unite) return std::any_of(s.parts.begin(), s.parts.end(), inside);
        if (s.operation == Operation::intersect) return std::all_of(s.parts.begin(), s.parts.end(), inside);
        return inside(s.parts.front()) && std::none_of(s.parts.begin() + 1, s.parts.end(), inside);
    }
    bool operator()(const TranslatedSolid& s) const { return contains(s.of, p - s.offset); }
    bool operator()(const RotatedSolid& s) const { return contains(s.of, rotated(p, s, -s.angle_rad)); }
    bool operator()(const RepeatedSolid& s) const {
        for (int k = 0; k < s.count; ++k) {
            if (contains(s.of, p - k * s.step)) return true;
        }
        return false;
    }
    bool operator()(const EnclosedSolid& s) const {
        Box3 box;
        for (const Solid& wall : s.walls) {
            if (contains(wall, p)) return false;
            box.add(bounds(wall).low);
            box.add(bounds(wall).high);
        }
        return box.contains(p);
    }
    bool operator()(const NotchesSolid& s) const {
        const auto inside = [&](const Solid& part) { return contains(part, p); };
        return std::any_of(s.hulls.begin(), s.hulls.end(), inside) &&
               std::none_of(s.walls.begin(), s.walls.end(), inside);
    }
    bool operator()(const PolyhedronSolid& s) const { return s.surface->winding_number(p) > 0.5; }
    bool operator()(const StepSolid& s) const { return s.surface->winding_number(p) > 0.5; }
};

Box3 united(Box3 a, const Box3& b) {
    if (b.empty()) return a;
    a.add(b.low);
    a.add(b.high);
    return a;
}

struct Bounds {
    Box3 operator()(const BoxSolid& s) const { return {s.low, s.high}; }
    Box3 operator()(const SphereSolid& s) const {
        const Vec3 r{s.radius, s.radius, s.radius};
        return {s.center - r, s.center + r};
    }
    Box3 operator()(const CylinderSolid& s) const {
        const Vec3 r{s.radius, s.radius, s.radius};
        return united({s.from - r, s.from + r}, {s.to - r, s.to + r});
    }
    Box3 operator()(const PrismSolid& s) const {
        Box3 box;
        for (const auto& [u, v] : s.polygon) {
            for (const double w : {s.from, s.to}) {
                Vec3 p;
                p[static_cast<std::size_t>(s.axes[0])] = u;
                p[static_cast<std::size_t>(s.axes[1])] = v;
                p[static_cast<std::size_t>(s.axes[2])] = w;
                box.add(p);
            }
        }
        return box;
    }
    Box3 operator()(const CombinedSolid& s) const {
        Box3 box = bounds(s.parts.front());
        for (std::size_t i = 1; i < s.parts.size(); ++i) {
            const Box3 other = bounds(s.parts[i]);
            if (s.operation == CombinedSolid::Operation::unite) box = united(box, other);
            if (s.operation != CombinedSolid::Operation::intersect) continue;
            for (std::size_t a = 0; a < 3; ++a) {
                box.low[a] = std::max(box.low[a], other.low[a]);
                box.high[a] = std::min(box.high[a], other.high[a]);
            }
        }
        return box;
    }
    Box3 operator()(const TranslatedSolid& s) const {
        const Box3 box = bounds(s.of);
        return {box.low + s.offset, box.high + s.offset};
    }
    Box3 operator()(const RotatedSolid& s) const {
        const Box3 box = bounds(s.of);
        Box3 result;
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 p{(corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                         (corner & 4) != 0 ? box.high.z : box.low.z};
            result.add(rotated(p, s, s.angle_rad));
        }
        return result;
    }
    Box3 operator()(const RepeatedSolid& s) const {
        const Box3 box = bounds(s.of);
        const Vec3 last = (s.count - 1) * s.step;
        return united(box, {box.low + last, box.high + last});
    }
    Box3 operator()(const EnclosedSolid& s) const {
        Box3 box = bounds(s.walls.front());
        for (const Solid& wall : s.walls) box = united(box, bounds(wall));
        return box;
    }
    Box3 operator()(const NotchesSolid& s) const {
        Box3 box = bounds(s.hulls.front());
        for (const Solid& hull : s.hulls) box = united(box, bounds(hull));
        return box;
    }
    Box3 operator()(const PolyhedronSolid& s) const { return bounds(s.surface->surface()); }
    Box3 operator()(const StepSolid& s) const { return bounds(s.surface->surface()); }
};

}  // namespace

bool contains(const Solid& solid, const Vec3& point) {
    return std::visit(Contains{point}, solid->shape);
}

Box3 bounds(const Solid& solid) {
    return std::visit(Bounds{}, solid->shape);
}

}  // namespace pliant::mesh
