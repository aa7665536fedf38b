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

/// A turn about the origin.
class SolidTurn {
public:
    SolidTurn() = default;
    explicit SolidTurn(const RotatedSolid& s) : any_(true) {
        const Vec3 axis = unit(s.axis);
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3 side;
            side[k] = 1;
            sides_[k] = turned(side, axis, s.angle_rad);
        }
    }
    [[nodiscard]] SolidTurn after(const SolidTurn& first) const {
        SolidTurn both = first;
        for (Vec3& side : both.sides_) side = of(side);
        return both;
    }
    [[nodiscard]] bool any() const { return any_; }
    [[nodiscard]] Vec3 of(const Vec3& p) const {
        return any_ ? p.x * sides_[0] + p.y * sides_[1] + p.z * sides_[2] : p;
    }

private:
    bool any_ = false;           ///< false: coordinates keep their digits
    std::array<Vec3, 3> sides_;  ///< where the axes point afterwards
};

Box3 shifted(const Box3& box, const Vec3& by) {
    return {box.low + by, box.high + by};
}

/// The box of a solid that is turned. Turns go down to the simple shapes: the box of a turned box is too large.
struct Bounds {
    SolidTurn turn;

    [[nodiscard]] Box3 of(const Solid& solid) const { return std::visit(*this, solid->shape); }
    [[nodiscard]] Box3 of(const std::vector<Solid>& solids) const {
        Box3 box = of(solids.front());
        for (std::size_t i = 1; i < solids.size(); ++i) box = united(box, of(solids[i]));
        return box;
    }
    [[nodiscard]] Box3 of(const TriMesh& surface) const {
        if (!turn.any()) return bounds(surface);
        Box3 box;
        for (const Vec3& p : surface.points) box.add(turn.of(p));
        return box;
    }
    [[nodiscard]] Box3 of(const Box3& own) const {
        if (!turn.any()) return own;
        Box3 box;
        for (unsigned corner = 0; corner < 8; ++corner) {
            box.add(turn.of({(corner & 1U) != 0 ? own.high.x : own.low.x, (corner & 2U) != 0 ? own.high.y : own.low.y,
                             (corner & 4U) != 0 ? own.high.z : own.low.z}));
        }
        return box;
    }

    Box3 operator()(const BoxSolid& s) const { return of(Box3{s.low, s.high}); }
    Box3 operator()(const SphereSolid& s) const {
        const Vec3 r{s.radius, s.radius, s.radius};
        const Vec3 center = turn.of(s.center);
        return {center - r, center + r};
    }
    /// A disc reaches along an axis by its radius times the sine of the angle between that axis and its normal.
    Box3 operator()(const CylinderSolid& s) const {
        const Vec3 from = turn.of(s.from), to = turn.of(s.to), along = unit(to - from);
        Vec3 reach;
        for (std::size_t k = 0; k < 3; ++k) reach[k] = s.radius * std::hypot(along[(k + 1) % 3], along[(k + 2) % 3]);
        return united({from - reach, from + reach}, {to - reach, to + reach});
    }
    Box3 operator()(const PrismSolid& s) const {
        Box3 box;
        for (const auto& [u, v] : s.polygon) {
            for (const double w : {s.from, s.to}) {
                Vec3 p;
                p[static_cast<std::size_t>(s.axes[0])] = u;
                p[static_cast<std::size_t>(s.axes[1])] = v;
                p[static_cast<std::size_t>(s.axes[2])] = w;
                box.add(turn.of(p));
            }
        }
        return box;
    }
    Box3 operator()(const CombinedSolid& s) const {
        using Operation = CombinedSolid::Operation;
        if (s.operation == Operation::unite) return of(s.parts);
        if (s.operation == Operation::subtract) return of(s.parts.front());
        if (turn.any()) return of(Bounds{}(s));  // large shapes may have a small part in common
        Box3 box = of(s.parts.front());
        for (std::size_t i = 1; i < s.parts.size(); ++i) {
            const Box3 other = of(s.parts[i]);
            for (std::size_t a = 0; a < 3; ++a) {
                box.low[a] = std::max(box.low[a], other.low[a]);
                box.high[a] = std::min(box.high[a], other.high[a]);
            }
        }
        return box;
    }
    Box3 operator()(const TranslatedSolid& s) const { return shifted(of(s.of), turn.of(s.offset)); }
    Box3 operator()(const RotatedSolid& s) const {
        const SolidTurn own(s);
        return shifted(Bounds{turn.after(own)}.of(s.of), turn.of(s.center - own.of(s.center)));
    }
    Box3 operator()(const RepeatedSolid& s) const {
        const Box3 box = of(s.of);
        return united(box, shifted(box, turn.of((s.count - 1) * s.step)));
    }
    Box3 operator()(const EnclosedSolid& s) const { return of(s.walls); }
    Box3 operator()(const NotchesSolid& s) const { return of(s.hulls); }
    Box3 operator()(const PolyhedronSolid& s) const { return of(s.surface->surface()); }
    Box3 operator()(const StepSolid& s) const { return of(s.surface->surface()); }
};

}  // namespace

bool contains(const Solid& solid, const Vec3& point) {
    return std::visit(Contains{point}, solid->shape);
}

Box3 bounds(const Solid& solid) {
    return Bounds{}.of(solid);
}

}  // namespace pliant::mesh
