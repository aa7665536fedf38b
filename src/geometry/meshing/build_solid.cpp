#include "geometry/meshing/build_solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <map>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/core/boxes.hpp"
#include "geometry/meshing/sampled_volume.hpp"
#include "geometry/shapes/flat_faces.hpp"
#include "geometry/shapes/shape_names.hpp"

namespace pliant::mesh::kernel {
namespace {

namespace occ = gmsh::model::occ;
using gmsh::Entities;

/// Where round shapes have their seams, and how Boolean operations are done.
struct Way {
    double ball_about_z, ball_about_x, cylinder;  ///< radians, odd ones: no drawing has them
    double tolerance = 0;     ///< how far apart faces may be that are taken for one, as a share of the solid's size
    bool one_by_one = false;  ///< many shapes are united or subtracted one after the other
    [[nodiscard]] bool is_turned() const { return cylinder != 0; }
};
constexpr std::array<Way, all_ways> ways = {{{0, 0, 0},
                                             {0.3, 1, 0.7},
                                             {2.1, 2.3, 0.4},
                                             {4.3, 0.55, 1.9},
                                             {0, 0, 0, 0, true},
                                             {0.3, 1, 0.7, 0, true},
                                             {0, 0, 0, 1e-7},
                                             {2.1, 2.3, 0.4, 1e-7, true}}};

/// A Boolean operation gave what its expression is not, in one way.
struct WrongVolume : std::exception {};
/// ... in every way.
struct CannotBuild : std::exception {
    Error error;
    explicit CannotBuild(Error why) : error(std::move(why)) {}
};

void set_tolerance(double tolerance) {
    gmsh::option::set_number("Geometry.ToleranceBoolean", tolerance);
}

/// Converts an expression to Open CASCADE volumes.
struct BuildSolid {
    int way = 0;

    Entities operator()(const BoxSolid& s) const {
        const Vec3 d = s.high - s.low;
        return {{3, occ::add_box(s.low.x, s.low.y, s.low.z, d.x, d.y, d.z)}};
    }
    Entities operator()(const SphereSolid& s) const {
        const Vec3& c = s.center;
        const Entities ball = {{3, occ::add_sphere(c.x, c.y, c.z, s.radius)}};
        if (turns().is_turned()) {
            const double own = own_turn(c, s.radius);
            occ::rotate(ball, c.x, c.y, c.z, 0, 0, 1, turns().ball_about_z + own);
            occ::rotate(ball, c.x, c.y, c.z, 1, 0, 0, turns().ball_about_x + own);
        }
        return ball;
    }
    Entities operator()(const CylinderSolid& s) const {
        const Vec3 d = s.to - s.from;
        const Entities rod = {{3, occ::add_cylinder(s.from.x, s.from.y, s.from.z, d.x, d.y, d.z, s.radius)}};
        if (turns().is_turned())
            occ::rotate(rod, s.from.x, s.from.y, s.from.z, d.x, d.y, d.z,
                        turns().cylinder + own_turn(s.from, s.radius));
        return rod;
    }
    /// Shapes in a row get different turns, or their seams would lie alike again.
    static double own_turn(const Vec3& at, double radius) {
        constexpr double share = 0.05;
        return std::sin(share * (at.x + 2 * at.y + 3 * at.z) / radius);
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
        switch (s.operation) {
            case CombinedSolid::Operation::unite:
                return united_or_beside(s.parts, "union", [&](const BuildSolid& in) { return in.unite(s.parts); });
            case CombinedSolid::Operation::intersect:
                return in_any_way(s.parts, "intersection", [&](const BuildSolid& in) { return in.intersect(s.parts); });
            default:
                return in_any_way(s.parts, "difference", [&](const BuildSolid& in) { return in.subtract(s.parts); });
        }
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
        std::vector<Solid> copies;
        for (int k = 0; k < s.count; ++k)
            copies.push_back(std::make_shared<const SolidNode>(SolidNode{TranslatedSolid{s.of, k * s.step}}));
        return united_or_beside(copies, "union of copies", [&](const BuildSolid& in) { return in.repeat(s, copies); });
    }

    Entities repeat(const RepeatedSolid& s, const std::vector<Solid>& solids) const {
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
        return united(first, copies, solids);
    }

    /// True if the copies certainly do not touch: uniting many takes minutes for 1000.
    static bool stands_apart(const RepeatedSolid& s) {
        const Box3 box = bounds(s.of);
        const double gap = 1e-6 * box.diagonal();
        return !boxes_meet(box, {box.low + s.step, box.high + s.step}, gap);
    }

    Entities operator()(const EnclosedSolid& s) const {
        return in_any_way(s.walls, "space between walls", [&](const BuildSolid& in) { return in.enclose(s); });
    }
    Entities operator()(const NotchesSolid& s) const {
        return in_any_way(s.walls, "space between walls", [&](const BuildSolid& in) { return in.notch(s); });
    }

    /// The empty space between the walls consists of pieces; takes the one that contains the point, unless it is the
    /// outermost.
    Entities enclose(const EnclosedSolid& s) const {
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
        const Solid around = std::make_shared<const SolidNode>(SolidNode{BoxSolid{low, low + size}});
        const Entities pieces =
            cut({{3, occ::add_box(low.x, low.y, low.z, size.x, size.y, size.z)}}, walls, {around}, s.walls);
        Entities kept;
        for (const auto& piece : pieces) {
            if (kept.empty() && !reaches(piece, low) && holds(piece, s.point, 1e-6 * margin))
                kept.push_back(piece);
            else
                occ::remove({piece}, true);
        }
        return kept;
    }

    Entities notch(const NotchesSolid& s) const {
        const Entities hulls = build_all(s.hulls);
        const Entities walls = build_all(s.walls);
        Entities kept;
        const double radius = 1e-7 * bounds(s.hulls.front()).diagonal();
        for (const auto& piece : cut(hulls, walls, s.hulls, s.walls)) {
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
        const Entities common = common_part(occ::copy({piece}), {{3, probe}});
        if (!common.empty()) occ::remove(common, true);
        return !common.empty();
    }

    [[nodiscard]] const Way& turns() const { return ways[static_cast<std::size_t>(way)]; }

    [[nodiscard]] Entities build(const Solid& solid) const { return std::visit(*this, solid->shape); }

    [[nodiscard]] Entities build_all(const std::vector<Solid>& solids) const {
        Entities all;
        for (const Solid& solid : solids) {
            const Entities one = build(solid);
            all.insert(all.end(), one.begin(), one.end());
        }
        return all;
    }

    /// What `work` makes in this way or, where that fails, in another one. What a failed attempt leaves is removed.
    template <class Work>
    Entities in_any_way(const std::vector<Solid>& parts, const char* what, const Work& work) const {
        const Entities before = occ::get_entities(3);
        for (int k = 0; k < all_ways; ++k) {
            try {
                return work(BuildSolid{(way + k) % all_ways});
            } catch (const std::bad_alloc&) {
                throw;
            } catch (const CannotBuild&) {  // of a part
                throw;
            } catch (...) {  // Open CASCADE throws what is no std::exception
                Entities left = occ::get_entities(3);
                std::erase_if(left,
                              [&](const auto& entity) { return std::ranges::find(before, entity) != before.end(); });
                if (!left.empty()) occ::remove(left, true);
            }
        }
        throw CannotBuild({Cause::input, fmt::format("Open CASCADE gets the {} of {} wrong; {}", what, shapes_of(parts),
                                                     advice_on_contact)});
    }

    /// As in_any_way(), for unions: parts that only touch, which Open CASCADE counts twice or turns inside out at
    /// times, may also stay beside each other.
    template <class Work>
    Entities united_or_beside(const std::vector<Solid>& parts, const char* what, const Work& work) const {
        constexpr int points = 40000;
        try {
            return in_any_way(parts, what, work);
        } catch (const CannotBuild&) {
            if (!can_be_sampled(parts) || repeated_volume(parts, points).volume > 0) throw;
            return build_all(parts);
        }
    }

    /// As in_any_way() wants it: throws if the volume does not fit.
    static void check(double volume, double of, const std::function<SampledVolume(int)>& sampled) {
        if (!fits(volume, volume_slack(of), sampled)) throw WrongVolume();
    }

    /// A Boolean operation with all tools at once, or with one after the other.
    [[nodiscard]] Entities in_steps(Entities objects, const Entities& tools,
                                    gmsh::model::occ::Outcome (*operation)(const Entities&, const Entities&)) const {
        if (!turns().one_by_one) return operation(objects, tools).entities;
        for (const auto& tool : tools) {
            if (objects.empty())
                occ::remove({tool}, true);
            else
                objects = operation(objects, {tool}).entities;
        }
        return objects;
    }

    void use_tolerance(const Solid& solid) const { set_tolerance(turns().tolerance * bounds(solid).diagonal()); }

    [[nodiscard]] Entities unite(const std::vector<Solid>& parts) const {
        Entities first = build(parts.front());
        const Entities others = build_all({parts.begin() + 1, parts.end()});
        if (first.empty()) return others;
        return others.empty() ? first : united(first, others, parts);
    }

    [[nodiscard]] Entities united(const Entities& first, const Entities& others,
                                  const std::vector<Solid>& parts) const {
        const double sum = volume_of(first) + volume_of(others);
        use_tolerance(parts.front());
        Entities whole = in_steps(first, others, occ::fuse);
        if (can_be_sampled(parts))
            check(sum - volume_of(whole), sum, [&](int points) { return repeated_volume(parts, points); });
        return whole;
    }

    [[nodiscard]] Entities subtract(const std::vector<Solid>& parts) const {
        Entities first = build(parts.front());
        const std::vector<Solid> others(parts.begin() + 1, parts.end());
        const Entities tools = build_all(others);
        return first.empty() || tools.empty() ? first : cut(first, tools, {parts.front()}, others);
    }

    [[nodiscard]] Entities cut(const Entities& objects, const Entities& tools, const std::vector<Solid>& solids,
                               const std::vector<Solid>& others) const {
        const double whole = volume_of(objects);
        use_tolerance(solids.front());
        Entities rest = in_steps(objects, tools, occ::cut);
        // Of several objects that overlap, what is cut off counts once or more often.
        if (solids.size() > 1 || !can_be_sampled(solids.front()) || !can_be_sampled(others)) return rest;
        check(whole - volume_of(rest), whole,
              [&](int points) { return covered_volume(solids.front(), others, points); });
        return rest;
    }

    [[nodiscard]] Entities intersect(const std::vector<Solid>& parts) const {
        Entities common = build(parts.front());
        std::vector<Solid> before = {parts.front()};
        for (std::size_t i = 1; i < parts.size(); ++i) {
            const Entities part = build(parts[i]);
            const double whole = volume_of(common);
            use_tolerance(parts.front());
            common = common_part(common, part);
            const Solid others = std::make_shared<const SolidNode>(
                SolidNode{CombinedSolid{CombinedSolid::Operation::intersect, before}});
            if (can_be_sampled(others) && can_be_sampled(parts[i]))
                check(volume_of(common), whole,
                      [&](int points) { return covered_volume(others, std::span(&parts[i], 1), points); });
            before.push_back(parts[i]);
        }
        return common;
    }

    static Entities common_part(const Entities& a, const Entities& b) {
        return a.empty() || b.empty() ? Entities{} : occ::intersect(a, b).entities;
    }
};

}  // namespace

Result<Entities> build(const Solid& solid, int way) {
    try {
        return BuildSolid{way % all_ways}.build(solid);
    } catch (const CannotBuild& wrong) {
        return tl::unexpected(wrong.error);
    }
}

double volume_slack(double volume) {
    return 2e-4 * volume;
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
    set_tolerance(0);
    const Entities common = BuildSolid::common_part(occ::copy(one), occ::copy(other));
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
