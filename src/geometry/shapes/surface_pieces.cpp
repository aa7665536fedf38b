#include "geometry/shapes/surface_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/core/rotation.hpp"
#include "base/core/segment.hpp"
#include "geometry/shapes/flat_faces.hpp"

namespace pliant::mesh {
namespace {

using Pieces = std::vector<SurfacePiece>;
using Loop = std::vector<Vec3>;

/// Normal of a loop by Newell's method, which also works for non-convex loops.
Vec3 loop_normal(const Loop& loop) {
    Vec3 n;
    for (std::size_t i = 0; i < loop.size(); ++i) n += cross(loop[i] - loop[0], loop[(i + 1) % loop.size()] - loop[0]);
    return unit(n);
}

/// Parity of crossings, in the two axes in which the projected plane is largest.
bool inside_loops(const std::vector<Loop>& loops, const Vec3& normal, const Vec3& p) {
    std::size_t w = 0;
    for (std::size_t a = 1; a < 3; ++a) {
        if (std::fabs(normal[a]) > std::fabs(normal[w])) w = a;
    }
    const std::size_t u = (w + 1) % 3, v = (w + 2) % 3;
    bool inside = false;
    for (const Loop& loop : loops) {
        for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
            const Vec3 &a = loop[i], &b = loop[j];
            if ((a[v] > p[v]) != (b[v] > p[v]) && p[u] < (b[u] - a[u]) * (p[v] - a[v]) / (b[v] - a[v]) + a[u])
                inside = !inside;
        }
    }
    return inside;
}

bool near_loops(const std::vector<Loop>& loops, const Vec3& p, double within) {
    for (const Loop& loop : loops) {
        for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
            if (distance_to_segment(p, loop[j], loop[i]) <= within) return true;
        }
    }
    return false;
}

SurfacePiece flat(std::vector<Loop> loops) {
    return {SurfacePiece::Kind::plane, loops.front().front(), loop_normal(loops.front()), 0, std::move(loops)};
}

/// A polygon extruded from `from` to `to` along the third of `axes`.
void add_prism(const std::vector<std::array<double, 2>>& polygon, const std::array<int, 3>& axes, double from,
               double to, Pieces& out) {
    const auto at = [&](std::size_t corner, double w) {
        Vec3 p;
        p[static_cast<std::size_t>(axes[0])] = polygon[corner][0];
        p[static_cast<std::size_t>(axes[1])] = polygon[corner][1];
        p[static_cast<std::size_t>(axes[2])] = w;
        return p;
    };
    for (const double w : {from, to}) {
        Loop cap;
        for (std::size_t c = 0; c < polygon.size(); ++c) cap.push_back(at(c, w));
        out.push_back(flat({cap}));
    }
    for (std::size_t c = 0; c < polygon.size(); ++c) {
        const std::size_t next = (c + 1) % polygon.size();
        out.push_back(flat({{at(c, from), at(next, from), at(next, to), at(c, to)}}));
    }
}

/// Transforms every point of a piece and its directions.
template <class Move, class Turn>
void move_all(Pieces& pieces, std::size_t first, const Move& move, const Turn& turn) {
    for (std::size_t k = first; k < pieces.size(); ++k) {
        SurfacePiece& piece = pieces[k];
        piece.point = move(piece.point);
        piece.direction = turn(piece.direction);
        for (Loop& loop : piece.loops) {
            for (Vec3& p : loop) p = move(p);
        }
    }
}

struct Collector {
    Pieces& out;

    void operator()(const BoxSolid& s) const {
        add_prism({{s.low.x, s.low.y}, {s.high.x, s.low.y}, {s.high.x, s.high.y}, {s.low.x, s.high.y}}, {0, 1, 2},
                  s.low.z, s.high.z, out);
    }
    void operator()(const SphereSolid& s) const { out.push_back({SurfacePiece::Kind::sphere, s.center, {}, s.radius}); }
    void operator()(const CylinderSolid& s) const {
        const Vec3 axis = s.to - s.from;
        out.push_back({SurfacePiece::Kind::cylinder, s.from, axis, s.radius});
        out.push_back({SurfacePiece::Kind::disk, s.from, unit(axis), s.radius});
        out.push_back({SurfacePiece::Kind::disk, s.to, unit(axis), s.radius});
    }
    void operator()(const PrismSolid& s) const { add_prism(s.polygon, s.axes, s.from, s.to, out); }
    void operator()(const CombinedSolid& s) const { all(s.parts); }
    void operator()(const TranslatedSolid& s) const {
        const std::size_t first = out.size();
        of(s.of);
        move_all(
            out, first, [&](const Vec3& p) { return p + s.offset; }, [](const Vec3& d) { return d; });
    }
    void operator()(const RotatedSolid& s) const {
        const std::size_t first = out.size();
        of(s.of);
        const Vec3 axis = unit(s.axis);
        move_all(
            out, first, [&](const Vec3& p) { return turned(p - s.center, axis, s.angle_rad, s.center); },
            [&](const Vec3& d) { return turned(d, axis, s.angle_rad, {}); });
    }
    void operator()(const RepeatedSolid& s) const {
        for (int k = 0; k < s.count; ++k) {
            const std::size_t first = out.size();
            of(s.of);
            move_all(
                out, first, [&](const Vec3& p) { return p + k * s.step; }, [](const Vec3& d) { return d; });
        }
    }
    void operator()(const EnclosedSolid& s) const { all(s.walls); }
    void operator()(const NotchesSolid& s) const {
        all(s.hulls);
        all(s.walls);
    }
    void operator()(const PolyhedronSolid& s) const {
        const FacetedSurface& surface = *s.faces;
        for (const auto& piece : surface.pieces) {
            for (const auto& shell : piece) {
                for (const auto& face : shell) {
                    std::vector<Loop> loops;
                    for (const FacetedSurface::Loop& corners : face) {
                        Loop& loop = loops.emplace_back();
                        for (const int corner : corners)
                            loop.push_back(surface.points[static_cast<std::size_t>(corner)]);
                    }
                    out.push_back(flat(std::move(loops)));
                }
            }
        }
    }
    void operator()(const StepSolid&) const { out.push_back({SurfacePiece::Kind::drawn, {}, {1, 2, 3}, 0}); }

    void of(const Solid& solid) const { std::visit(*this, solid->shape); }
    void all(const std::vector<Solid>& solids) const {
        for (const Solid& solid : solids) of(solid);
    }
};

/// The vector from the axis to a point.
Vec3 from_axis(const SurfacePiece& piece, const Vec3& p) {
    const Vec3 along = unit(piece.direction);
    return p - piece.point - dot(p - piece.point, along) * along;
}

}  // namespace

double SurfacePiece::distance(const Vec3& p) const {
    switch (kind) {
        case Kind::plane:
        case Kind::disk:
            return dot(p - point, direction);
        case Kind::sphere:
            return norm(p - point) - radius;
        case Kind::cylinder:
            return norm(from_axis(*this, p)) - radius;
        case Kind::drawn:
            break;
    }
    return 0;
}

Vec3 SurfacePiece::normal(const Vec3& p) const {
    if (kind == Kind::sphere) return unit(p - point);
    return kind == Kind::cylinder ? unit(from_axis(*this, p)) : direction;
}

bool SurfacePiece::holds(const Vec3& p, double within) const {
    if (kind == Kind::drawn || std::fabs(distance(p)) > within) return false;
    switch (kind) {
        case Kind::plane:
            return inside_loops(loops, direction, p) || near_loops(loops, p, within);
        case Kind::disk:
            return norm(p - point) <= radius + within;
        case Kind::cylinder: {
            const double along = dot(p - point, unit(direction));
            return along >= -within && along <= norm(direction) + within;
        }
        case Kind::sphere:
        case Kind::drawn:
            break;
    }
    return true;
}

std::vector<SurfacePiece> surface_pieces(const Solid& solid) {
    Pieces out;
    Collector{out}.of(solid);
    return out;
}

}  // namespace pliant::mesh
