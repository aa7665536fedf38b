#include "geometry/meshing/build_solid.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <variant>
#include <vector>

#include "base/core/boxes.hpp"
#include "geometry/shapes/flat_faces.hpp"

namespace pliant::mesh::kernel {
namespace {

namespace occ = gmsh::model::occ;
using gmsh::Entities;

/// Converts an expression to Open CASCADE volumes.
struct BuildSolid {
    Entities operator()(const BoxSolid& s) const {
        const Vec3 d = s.high - s.low;
        return {{3, occ::add_box(s.low.x, s.low.y, s.low.z, d.x, d.y, d.z)}};
    }
    Entities operator()(const SphereSolid& s) const {
        return {{3, occ::add_sphere(s.center.x, s.center.y, s.center.z, s.radius)}};
    }
    Entities operator()(const CylinderSolid& s) const {
        const Vec3 d = s.to - s.from;
        return {{3, occ::add_cylinder(s.from.x, s.from.y, s.from.z, d.x, d.y, d.z, s.radius)}};
    }
    Entities operator()(const PrismSolid& s) const {
        const auto axis = [&](std::size_t k) { return static_cast<std::size_t>(s.axes[k]); };
        std::vector<int> points;
        for (const auto& [u, v] : s.polygon) {
            Vec3 p;
            p[axis(0)] = u;
            p[axis(1)] = v;
            p[axis(2)] = s.from;
            points.push_back(occ::add_point(p.x, p.y, p.z));
        }
        std::vector<int> lines;
        for (std::size_t i = 0; i < points.size(); ++i)
            lines.push_back(occ::add_line(points[i], points[(i + 1) % points.size()]));
        const int face = occ::add_plane_surface({occ::add_curve_loop(lines)});
        Vec3 along;
        along[axis(2)] = s.to - s.from;
        Entities out = occ::extrude({{2, face}}, along.x, along.y, along.z);
        std::erase_if(out, [](const auto& entity) { return entity.first != 3; });
        return out;
    }
    Entities operator()(const CombinedSolid& s) const {
        Entities first = build(s.parts.front());
        Entities others;
        for (std::size_t i = 1; i < s.parts.size(); ++i) {
            Entities part = build(s.parts[i]);
            if (s.operation == CombinedSolid::Operation::intersect)
                first = intersect(first, part);
            else
                others.insert(others.end(), part.begin(), part.end());
        }
        if (first.empty() || others.empty())
            return first.empty() && s.operation == CombinedSolid::Operation::unite ? others : first;
        return (s.operation == CombinedSolid::Operation::unite ? occ::fuse(first, others) : occ::cut(first, others))
            .entities;
    }
    Entities operator()(const TranslatedSolid& s) const {
        Entities part = build(s.of);
        if (!part.empty()) occ::translate(part, s.offset.x, s.offset.y, s.offset.z);
        return part;
    }
    Entities operator()(const RotatedSolid& s) const {
        Entities part = build(s.of);
        if (!part.empty())
            occ::rotate(part, s.center.x, s.center.y, s.center.z, s.axis.x, s.axis.y, s.axis.z, s.angle_rad);
        return part;
    }
    Entities operator()(const RepeatedSolid& s) const {
        const Entities first = build(s.of);
        Entities copies;
        for (int k = 1; k < s.count && !first.empty(); ++k) {
            const Entities copy = occ::copy(first);
            occ::translate(copy, k * s.step.x, k * s.step.y, k * s.step.z);
            copies.insert(copies.end(), copy.begin(), copy.end());
        }
        if (copies.empty() || stands_apart(s)) {
            copies.insert(copies.begin(), first.begin(), first.end());
            return copies;
        }
        return occ::fuse(first, copies).entities;
    }

    /// True if the copies certainly do not touch: uniting many takes minutes for 1000.
    static bool stands_apart(const RepeatedSolid& s) {
        const Box3 box = bounds(s.of);
        const double gap = 1e-6 * box.diagonal();
        return !boxes_meet(box, {box.low + s.step, box.high + s.step}, gap);
    }

    /// The empty space between the walls consists of pieces; takes the one that contains the point, unless it is the
    /// outermost.
    Entities operator()(const EnclosedSolid& s) const {
        const Entities walls = build_all(s.walls);
        Box3 box;
        for (const Solid& wall : s.walls) {
            const Box3 around = bounds(wall);
            box.add(around.low);
            box.add(around.high);
        }
        const double margin = 0.1 * box.diagonal();
        const Vec3 low = box.low - Vec3{margin, margin, margin};
        const Vec3 size = box.size() + 2 * Vec3{margin, margin, margin};
        const Entities pieces =
            occ::cut({{3, occ::add_box(low.x, low.y, low.z, size.x, size.y, size.z)}}, walls).entities;
        Entities kept;
        for (const auto& piece : pieces) {
            if (kept.empty() && !reaches(piece, low) && holds(piece, s.point, 1e-6 * margin))
                kept.push_back(piece);
            else
                occ::remove({piece}, true);
        }
        return kept;
    }

    Entities operator()(const NotchesSolid& s) const {
        const Entities hulls = build_all(s.hulls);
        const Entities walls = build_all(s.walls);
        Entities kept;
        const double radius = 1e-7 * bounds(s.hulls.front()).diagonal();
        for (const auto& piece : occ::cut(hulls, walls).entities) {
            const auto inside = [&](const Vec3& point) { return holds(piece, point, radius); };
            if (std::any_of(s.points.begin(), s.points.end(), inside))
                kept.push_back(piece);
            else
                occ::remove({piece}, true);
        }
        return kept;
    }

    Entities operator()(const PolyhedronSolid& s) const {
        std::vector<int> points;
        for (const Vec3& p : s.faces->points) points.push_back(occ::add_point(p.x, p.y, p.z));
        std::map<std::pair<int, int>, int> lines;
        const auto line = [&](int a, int b) {
            const auto [entry, fresh] = lines.try_emplace(std::minmax(a, b), 0);
            if (fresh)
                entry->second = occ::add_line(points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)]);
            return entry->second;
        };
        Entities volumes;
        for (const FacetedSurface::Piece& piece : s.faces->pieces) {
            Entities shells;
            for (const FacetedSurface::Shell& shell : piece) {
                std::vector<int> faces;
                for (const FacetedSurface::Face& face : shell) {
                    std::vector<int> loops;
                    for (const FacetedSurface::Loop& loop : face) {
                        std::vector<int> curves;
                        for (std::size_t i = 0; i < loop.size(); ++i)
                            curves.push_back(line(loop[i], loop[(i + 1) % loop.size()]));
                        loops.push_back(occ::add_curve_loop(curves));
                    }
                    faces.push_back(occ::add_plane_surface(loops));
                }
                shells.emplace_back(3, occ::add_volume({occ::add_surface_loop(faces)}));
            }
            const Entities outer = {shells.front()};
            const Entities whole =
                shells.size() == 1 ? outer : occ::cut(outer, {shells.begin() + 1, shells.end()}).entities;
            volumes.insert(volumes.end(), whole.begin(), whole.end());
        }
        return volumes;
    }
    Entities operator()(const StepSolid& s) const {
        const Entities all = import_solids(s.file, s.scale);
        Entities kept;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (std::find(s.numbers.begin(), s.numbers.end(), static_cast<int>(i)) != s.numbers.end())
                kept.push_back(all[i]);
            else
                occ::remove({all[i]}, true);
        }
        return kept;
    }

    static bool reaches(const std::pair<int, int>& piece, const Vec3& low) {
        const auto [a, b] = occ::get_bounding_box(piece.first, piece.second);
        return a[0] < low.x + 1e-3 * (b[0] - a[0]);
    }

    static bool holds(const std::pair<int, int>& piece, const Vec3& point, double radius) {
        const auto [low, high] = occ::get_bounding_box(piece.first, piece.second);
        for (std::size_t k = 0; k < 3; ++k) {
            if (point[k] < low[k] || point[k] > high[k]) return false;
        }
        const int probe =
            occ::add_box(point.x - radius, point.y - radius, point.z - radius, 2 * radius, 2 * radius, 2 * radius);
        const Entities common = intersect(occ::copy({piece}), {{3, probe}});
        if (!common.empty()) occ::remove(common, true);
        return !common.empty();
    }

    static Entities build_all(const std::vector<Solid>& solids) {
        Entities all;
        for (const Solid& solid : solids) {
            const Entities one = build(solid);
            all.insert(all.end(), one.begin(), one.end());
        }
        return all;
    }

    static Entities intersect(const Entities& a, const Entities& b) {
        return a.empty() || b.empty() ? Entities{} : occ::intersect(a, b).entities;
    }
};

}  // namespace

Entities build(const Solid& solid) {
    return std::visit(BuildSolid{}, solid->shape);
}

Entities import_solids(const std::string& file, double scale) {
    Entities solids = occ::import_shapes(file);
    std::erase_if(solids, [](const auto& entity) { return entity.first != 3; });
    if (scale != 1 && !solids.empty()) occ::dilate(solids, scale);
    return solids;
}

double volume_of(const Entities& volumes) {
    double sum = 0;
    for (const auto& [dimension, tag] : volumes) {
        if (dimension == 3) sum += occ::get_mass(dimension, tag);
    }
    return sum;
}

double common_volume(const Entities& one, const Entities& other) {
    const Entities common = BuildSolid::intersect(occ::copy(one), occ::copy(other));
    const double volume = volume_of(common);
    if (!common.empty()) occ::remove(common, true);
    return volume;
}

double boundary_area(const Entities& volumes) {
    double sum = 0;
    for (const auto& [dimension, tag] : gmsh::model::get_boundary(volumes, false)) sum += occ::get_mass(dimension, tag);
    return sum;
}

}  // namespace pliant::mesh::kernel
