#include "geometry/meshing/mesh_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/core/boxes.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesh/tet_locator.hpp"
#include "geometry/mesh/triangle_corners.hpp"
#include "geometry/meshing/gmsh_kernel.hpp"
#include "geometry/meshing/size_field.hpp"
#include "geometry/meshing/touching_bodies.hpp"
#include "geometry/meshing/walls.hpp"
#include "geometry/meshing/winding_mesher.hpp"
#include "geometry/repair/narrow_gaps.hpp"
#include "geometry/repair/surface_check.hpp"
#include "geometry/repair/surface_crossings.hpp"
#include "geometry/repair/surface_seams.hpp"
#include "geometry/repair/surface_shells.hpp"
#include "geometry/repair/surface_slivers.hpp"
#include "geometry/shapes/flat_faces.hpp"

namespace pliant::mesh::kernel {
namespace {

/// What is meshed at once: all solids together, a group of touching bodies, or one piece of a surface.
struct Part {
    TetMesh mesh;  ///< regions are bodies
};

/// True if a node of `one` is in `other` or within `margin` of it; `body` is then the region there.
bool reaches_into(const TetMesh& one, const TetMesh& other, double margin, int& body) {
    const TetLocator locator(other);
    const Box3 box = bounds_of(other.points);
    for (const Vec3& p : one.points) {
        if (!box.contains(p, margin)) continue;
        const auto found = locator.locate(p);
        if (found.distance > margin) continue;
        body = other.region[static_cast<std::size_t>(found.tet)];
        return true;
    }
    return false;
}

/// Bodies not detected as touching must be apart: otherwise their meshes would overlap unnoticed.
Status check_apart(const Part& fresh, const Part& before, std::span<const BodyGeometry> bodies, double margin) {
    const int own = fresh.mesh.region.front();
    int other = own;
    if (!reaches_into(fresh.mesh, before.mesh, margin, other)) {
        if (!reaches_into(before.mesh, fresh.mesh, margin, other)) return {};
        other = before.mesh.region.front();
    }
    const std::string& name = bodies[static_cast<std::size_t>(own)].name;
    if (other == own)
        return about(name,
                     {Cause::input, fmt::format("body \"{}\": two shells of its surface touch or overlap", name)});
    const std::string& neighbour = bodies[static_cast<std::size_t>(other)].name;
    return about(neighbour, {Cause::input, fmt::format("body \"{}\" comes within a hundredth of the mesh size of body "
                                                       "\"{}\" or overlaps it, less than a mesh of that size can tell; "
                                                       "take a smaller size, or draw them to touch",
                                                       name, neighbour)});
}

/// Sizes for the kernel, whose solids are some of the bodies; empty if one size holds everywhere.
SizeAt sizes_of(const SizeField& field, std::vector<std::size_t> body_of_solid) {
    if (field.uniform()) return {};
    return [&field, bodies = std::move(body_of_solid)](std::size_t solid, const Vec3& p) {
        return field.at(bodies[solid], p);
    };
}

/// True if the solid comes from 32-bit coordinates.
bool is_rounded(const Solid& solid) {
    if (std::holds_alternative<PolyhedronSolid>(solid->shape)) return true;
    const auto* combined = std::get_if<CombinedSolid>(&solid->shape);
    return combined != nullptr && std::any_of(combined->parts.begin(), combined->parts.end(), is_rounded);
}

/// Maximum distance of faces that were drawn to touch.
double rounding(std::span<const BodyGeometry> bodies) {
    constexpr double share = 2e-6;  // of the size of all bodies: 32-bit floats have an error of 6e-8, and several
                                    // errors add up
    const bool rounded = std::ranges::any_of(bodies, [](const BodyGeometry& body) {
        const auto* solid = std::get_if<Solid>(&body.shape);
        return solid != nullptr && is_rounded(*solid);
    });
    return rounded ? share * bounds(bodies).diagonal() : 0;
}

Result<Part> mesh_drawn_solids(std::span<const BodyGeometry> bodies, const MeshSettings& settings,
                               const SizeField& field, double join_within, const std::vector<bool>& left_out, int way) {
    std::vector<NamedSolid> solids;
    std::vector<int> body_of_solid;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const auto* solid = std::get_if<Solid>(&bodies[b].shape);
        if (solid == nullptr || left_out[b]) continue;
        solids.push_back({bodies[b].name, *solid});
        body_of_solid.push_back(static_cast<int>(b));
    }
    if (solids.empty()) return Part{};
    const SizeAt size_at = sizes_of(field, {body_of_solid.begin(), body_of_solid.end()});
    Result<TetMesh> mesh =
        mesh_solids(solids, settings.size, settings.order, size_at, std::max(join_within, rounding(bodies)), way);
    if (!mesh) return tl::unexpected(mesh.error());
    for (int& region : mesh->region) region = body_of_solid[static_cast<std::size_t>(region)];
    return Part{std::move(*mesh)};
}

/// A body whose surface is closed and simple: one mesh per solid piece.
Result<std::vector<TetMesh>> mesh_pieces(const TriMesh& surface, const MeshSettings& settings, const SizeAt& size_at) {
    if (Status status = check_closed(surface); !status) return tl::unexpected(status.error());
    // On finer detail than this, Gmsh's boundary recovery may crash instead of failing.
    constexpr double finest = 5e-6;
    if (cuts_itself(surface)) return input_error("the surface cuts through itself or touches itself");
    if (finest_detail(surface) < finest)
        return input_error("the surface has triangles lower than {:.0e} of its size", finest);
    const Result<std::vector<TriMesh>> pieces = solid_pieces(surface);
    if (!pieces) return tl::unexpected(pieces.error());
    std::vector<TetMesh> meshes;
    for (const TriMesh& piece : *pieces) {
        Result<TetMesh> mesh = mesh_surface(piece, settings.size, settings.angle_deg, size_at);
        if (!mesh) return tl::unexpected(mesh.error());
        int region = 0;
        for (const TetMesh& before : meshes) {
            if (reaches_into(*mesh, before, 0.01 * settings.size, region) ||
                reaches_into(before, *mesh, 0.01 * settings.size, region))
                return input_error("two shells of its surface touch or overlap");
        }
        meshes.push_back(std::move(*mesh));
    }
    return meshes;
}

/// If Gmsh had to keep the drawn triangles, and they are too slender: uses a mesh from the winding number instead, if
/// that is better.
void replace_slivers(std::vector<TetMesh>& meshes, const TriMesh& surface, const MeshSettings& settings,
                     Progress& progress) {
    double angle = sliver_deg;
    bool as_drawn = false;
    for (const TetMesh& mesh : meshes) {
        as_drawn = as_drawn || !mesh.notes.empty();
        angle = std::min(angle, smallest_dihedral_deg(mesh));
    }
    if (!as_drawn || angle >= sliver_deg) return;
    Result<TetMesh> mesh = mesh_by_winding(surface, settings.size, settings.angle_deg, progress);
    if (!mesh || smallest_dihedral_deg(*mesh) <= angle) return;
    mesh->notes.front() = fmt::format(
        "the surface could not be divided anew by Gmsh and was "
        "meshed from its winding number; check its volume: {:.6g}",
        volume(*mesh));
    meshes = {std::move(*mesh)};
}

/// Wall samples of a body in a mesh.
std::vector<WallSample> walls_of(const TetMesh& mesh, std::size_t body) {
    return wall_samples(region_surface(mesh, static_cast<int>(body)));
}

/// Tets between faces much closer than the edge length are flat; shorter edges there improve them.
void follow_thin_walls(std::vector<TetMesh>& meshes, const TriMesh& surface, std::size_t b,
                       const MeshSettings& settings, SizeField field) {
    constexpr double elements = 0.2;  // through the thinnest wall
    double angle = sliver_deg;
    std::size_t thin = 0;
    for (const TetMesh& mesh : meshes) {
        std::vector<WallSample> walls = walls_of(mesh, 0);
        std::erase_if(walls, [](const WallSample& w) { return w.thickness > elements * w.edge; });
        field.add_walls(walls, elements);
        thin += walls.size();
        angle = std::min(angle, smallest_dihedral_deg(mesh));
    }
    if (angle >= sliver_deg || thin == 0) return;
    Result<std::vector<TetMesh>> finer = mesh_pieces(surface, settings, sizes_of(field, {b}));
    if (!finer) return;
    double its = sliver_deg;
    for (const TetMesh& mesh : *finer) its = std::min(its, smallest_dihedral_deg(mesh));
    if (its <= angle) return;
    meshes = std::move(*finer);
    meshes.front().notes.emplace_back(
        "edges are shorter than the mesh size beside walls that are much thinner than it");
}

/// A note where a remeshed surface lost a part of its volume: chords of curves lie inside them.
void judge_volume(std::vector<TetMesh>& meshes, const TriMesh& surface) {
    constexpr double told = 2e-3;
    double meshed = 0;
    for (const TetMesh& mesh : meshes) meshed += volume(mesh);
    const double drawn = signed_volume(surface);
    const double share = drawn > 0 ? meshed / drawn - 1 : 0;
    if (std::fabs(share) <= told) return;
    meshes.front().notes.push_back(
        fmt::format("its mesh has a volume of {:.6g}, {:.2g} % {} than its file: longer edges cut across curves; a "
                    "smaller size helps",
                    meshed, 100 * std::fabs(share), share > 0 ? "more" : "less"));
}

/// The meshes of the surface of body `b`. A damaged one is meshed from its winding number, as it was read.
Result<std::vector<Part>> mesh_surface_body(std::span<const BodyGeometry> bodies, std::size_t b,
                                            const MeshSettings& settings, const SizeField& field, Progress& progress) {
    const auto& drawn = std::get<TriMesh>(bodies[b].shape);
    TriMesh surface = drawn;
    const SliverCount slivers = remove_slivers(surface);
    const auto blame = [&](const Error& error) {
        return about(bodies[b].name, {error.cause, fmt::format("body \"{}\": {}", bodies[b].name, error.message)});
    };
    Status few = check_tet_count(std::fabs(signed_volume(surface)), surface_area(surface), settings.size);
    if (!few) return blame(few.error());
    Result<std::vector<TetMesh>> meshes = mesh_pieces(surface, settings, sizes_of(field, {b}));
    const bool damaged = !meshes;
    if (damaged) {
        if (progress.cancelled()) return cancelled();
        // Without its slivers the surface may still be closed, which makes winding numbers fast.
        const TriMesh& known = border_edges(surface).empty() ? surface : drawn;
        Result<TetMesh> mesh = mesh_by_winding(known, settings.size, settings.angle_deg, progress);
        if (!mesh && mesh.error().cause == Cause::cancelled) return tl::unexpected(mesh.error());
        if (!mesh) return blame({mesh.error().cause, mesh.error().message + "; " + meshes.error().message});
        if (std::string& note = mesh->notes.front(); note.find("is damaged") == std::string::npos)
            note = meshes.error().message + ": " + note;
        meshes = std::vector<TetMesh>{std::move(*mesh)};
    } else {
        replace_slivers(*meshes, surface, settings, progress);
        follow_thin_walls(*meshes, surface, b, settings, field);
        judge_volume(*meshes, surface);
    }
    if (progress.cancelled()) return cancelled();
    if (slivers.removed > 0 && !damaged) {
        meshes->front().notes.insert(meshes->front().notes.begin(),
                                     fmt::format("{} flat triangle(s) of the surface were removed", slivers.removed));
    }
    std::vector<Part> parts;
    for (TetMesh& mesh : *meshes) {
        mesh.region.assign(mesh.region.size(), static_cast<int>(b));
        for (std::string& note : mesh.notes) note = fmt::format("body \"{}\": {}", bodies[b].name, note);
        parts.push_back({settings.order == 2 ? to_quadratic(mesh) : std::move(mesh)});
    }
    return parts;
}

/// Bodies that touch, some of them surfaces, in one mesh.
Result<Part> mesh_group(std::span<const BodyGeometry> bodies, const TouchingGroup& group, const MeshSettings& settings,
                        const SizeField& field, Progress& progress) {
    std::vector<std::string> names;
    for (const std::size_t b : group.bodies) names.push_back(fmt::format("body \"{}\"", bodies[b].name));
    const SizeOfSurface size_at = [&](std::size_t s, const Vec3& p) { return field.at(group.bodies[s], p); };
    Result<JointMesh> joint =
        mesh_together(group.surfaces, names, settings.size, size_at, settings.angle_deg, progress);
    if (!joint) {
        for (std::size_t s = 0; s < names.size(); ++s) {
            const std::vector<Diagnostic>& problems = joint.error().problems;
            if (!problems.empty() && problems.front().key == names[s])
                return about(bodies[group.bodies[s]].name, joint.error());
        }
        return tl::unexpected(joint.error());
    }
    TetMesh& mesh = joint->mesh;
    for (std::size_t s = 0; s < names.size(); ++s) {
        const BodyGeometry& body = bodies[group.bodies[s]];
        if (body.air || std::ranges::find(mesh.region, static_cast<int>(s)) != mesh.region.end()) continue;
        return about(body.name, {Cause::input, fmt::format("{} is empty: all of it belongs to later ones", names[s])});
    }
    std::string list;
    for (std::size_t s = 0; s < names.size(); ++s) {
        const std::string damage = describe(joint->damage[s]);
        list += fmt::format("{}{} {:.6g}{}", s == 0 ? "" : ", ", names[s], volume(mesh, static_cast<int>(s)),
                            damage.empty() ? "" : fmt::format(" (damaged: {})", damage));
    }
    mesh.notes.insert(
        mesh.notes.begin(),
        "bodies that touch were meshed together from their winding numbers; check their volumes: " + list);
    for (const JointMesh::Overlap& overlap : joint->overlaps) {
        if (bodies[group.bodies[overlap.keeper]].air) continue;
        mesh.notes.push_back(fmt::format("{} and {} overlap by about {:.2g}; {} has it", names[overlap.loser],
                                         names[overlap.keeper], overlap.volume, names[overlap.keeper]));
    }
    for (int& region : mesh.region) region = static_cast<int>(group.bodies[static_cast<std::size_t>(region)]);
    return Part{settings.order == 2 ? to_quadratic(mesh) : std::move(mesh)};
}

TetMesh joined(const std::vector<Part>& parts, int order) {
    TetMesh mesh;
    mesh.order = order;
    for (const Part& part : parts) {
        const int offset = static_cast<int>(mesh.points.size());
        mesh.points.insert(mesh.points.end(), part.mesh.points.begin(), part.mesh.points.end());
        for (const int node : part.mesh.nodes) mesh.nodes.push_back(node + offset);
        mesh.region.insert(mesh.region.end(), part.mesh.region.begin(), part.mesh.region.end());
        mesh.notes.insert(mesh.notes.end(), part.mesh.notes.begin(), part.mesh.notes.end());
    }
    return mesh;
}

Status check_settings(std::span<const BodyGeometry> bodies, const MeshSettings& settings) {
    if (bodies.empty()) return input_error("there is no body to mesh");
    if (!(settings.size > 0 && std::isfinite(settings.size))) return input_error("the mesh size must be above zero");
    if (settings.order != 1 && settings.order != 2) return input_error("the order of a mesh is 1 or 2");
    return {};
}

/// How the bodies are meshed: those of a group at once, surfaces one by one, all other solids together.
struct Drawing {
    std::span<const BodyGeometry> bodies;
    std::vector<TouchingGroup> groups;
    std::vector<bool> grouped;  ///< (bodies)
    int way = 0;                ///< of building solids
};

Result<Drawing> group_bodies(std::span<const BodyGeometry> bodies, double size, int way) {
    Result<std::vector<TouchingGroup>> groups = touching_groups(bodies, size);
    if (!groups) return tl::unexpected(groups.error());
    Drawing drawing{bodies, std::move(*groups), std::vector<bool>(bodies.size(), false), way};
    for (const TouchingGroup& group : drawing.groups) {
        for (const std::size_t b : group.bodies) drawing.grouped[b] = true;
    }
    return drawing;
}

/// Solids at most `join_within` apart are joined.
Result<TetMesh> mesh_once(const Drawing& drawing, const MeshSettings& settings, const SizeField& field,
                          Progress& progress, double join_within = 0) {
    const std::span<const BodyGeometry> bodies = drawing.bodies;
    progress.advance("mesh", 0);
    Result<Part> solids = mesh_drawn_solids(bodies, settings, field, join_within, drawing.grouped, drawing.way);
    if (!solids) return tl::unexpected(solids.error());
    std::vector<Part> parts;
    if (solids->mesh.tet_count() > 0) parts.push_back(std::move(*solids));
    const auto take = [&](Part part) -> Status {
        for (const Part& before : parts) {
            if (Status apart = check_apart(part, before, bodies, 0.01 * settings.size); !apart) return apart;
        }
        parts.push_back(std::move(part));
        return {};
    };
    for (const TouchingGroup& group : drawing.groups) {
        Result<Part> part = mesh_group(bodies, group, settings, field, progress);
        if (!part) return tl::unexpected(part.error());
        if (Status taken = take(std::move(*part)); !taken) return tl::unexpected(taken.error());
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!std::holds_alternative<TriMesh>(bodies[b].shape) || drawing.grouped[b]) continue;
        if (progress.cancelled()) return cancelled();
        progress.advance("mesh", static_cast<double>(b) / static_cast<double>(bodies.size()));
        Result<std::vector<Part>> fresh = mesh_surface_body(bodies, b, settings, field, progress);
        if (!fresh) return tl::unexpected(fresh.error());
        for (Part& part : *fresh) {
            if (Status taken = take(std::move(part)); !taken) return tl::unexpected(taken.error());
        }
    }
    TetMesh mesh = joined(parts, settings.order);
    for (const BodyGeometry& body : bodies) mesh.region_names.push_back(body.name);
    progress.advance("mesh", 1);
    return mesh;
}

std::string told(const NarrowGap& gap, std::span<const BodyGeometry> bodies) {
    return fmt::format("a gap of {:.3g} between \"{}\" and \"{}\" at ({:.4g}, {:.4g}, {:.4g})", gap.width,
                       bodies[static_cast<std::size_t>(gap.first)].name,
                       bodies[static_cast<std::size_t>(gap.second)].name, gap.at.x, gap.at.y, gap.at.z);
}

/// A note for each original gap: closed, or still open.
std::vector<std::string> gap_notes(std::span<const BodyGeometry> bodies, const std::vector<NarrowGap>& before,
                                   const std::vector<NarrowGap>& after) {
    std::vector<std::string> notes;
    for (const NarrowGap& gap : before) {
        const bool open = std::any_of(after.begin(), after.end(), [&](const NarrowGap& other) {
            return other.first == gap.first && other.second == gap.second;
        });
        notes.push_back(told(gap, bodies) + (open ? " could not be closed: they are not joined "
                                                    "there; draw them so that they touch or overlap"
                                                  : " was closed; close_gaps says up to which width"));
    }
    return notes;
}

/// The mesh, made again with bodies joined across narrow gaps.
Result<TetMesh> close_gaps(const Drawing& drawing, const MeshSettings& settings, const SizeField& field, TetMesh mesh,
                           Progress& progress) {
    if (!(settings.close_gaps > 0)) return mesh;
    const std::vector<NarrowGap> gaps = narrow_gaps(mesh, settings.close_gaps);
    if (gaps.empty()) return mesh;
    constexpr double room = 1.05;  // margin for rounding
    double widest = 0;
    for (const NarrowGap& gap : gaps) widest = std::max(widest, gap.width);
    Result<TetMesh> closed = mesh_once(drawing, settings, field, progress, room * widest);
    if (!closed && closed.error().cause != Cause::failed) return closed;
    const std::vector<NarrowGap> left = closed ? narrow_gaps(*closed, settings.close_gaps) : gaps;
    if (closed) mesh = std::move(*closed);
    const std::vector<std::string> notes = gap_notes(drawing.bodies, gaps, left);
    mesh.notes.insert(mesh.notes.end(), notes.begin(), notes.end());
    return mesh;
}

/// Estimates the number of tets for the given sizes from a first mesh.
double expected_tets(const TetMesh& mesh, const SizeField& field) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(n[k])]; };
        const double size = field.at(static_cast<std::size_t>(mesh.region[t]), 0.25 * (at(0) + at(1) + at(2) + at(3)));
        sum += 8.5 * signed_tet_volume(at(0), at(1), at(2), at(3)) / (size * size * size);
    }
    return sum;
}

/// Meshes once to measure wall thickness, and adapts the sizes.
Status follow_walls(const Drawing& drawing, const MeshSettings& settings, SizeField& field, Progress& progress) {
    if (settings.through_wall < 1) return {};
    MeshSettings coarse = settings;
    coarse.order = 1;
    const Result<TetMesh> first = mesh_once(drawing, coarse, field, progress);
    if (!first) return tl::unexpected(first.error());
    for (std::size_t b = 0; b < drawing.bodies.size(); ++b) {
        if (!drawing.bodies[b].air) field.add_walls(walls_of(*first, b), settings.through_wall);
    }
    constexpr double most = 20e6;
    const double tets = expected_tets(*first, field);
    if (tets <= most) return {};
    return input_error(
        "{} elements through every wall are about {:.2g} tetrahedra, more than the {:.2g} allowed; ask for "
        "fewer or take a larger size",
        settings.through_wall, tets, most);
}

/// Without the rounding errors of coordinates that are zero.
Vec3 rounded(Vec3 p, double size) {
    constexpr double noise = 1e-9;
    for (std::size_t k = 0; k < 3; ++k) p[k] = std::fabs(p[k]) < noise * size ? 0 : p[k];
    return p;
}

/// A note for each body with a wall of fewer than three elements: its thinnest wall, by the edge length there.
void judge_walls(std::span<const BodyGeometry> bodies, TetMesh& mesh) {
    constexpr double enough = 2.5;  // about three
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (bodies[b].air) continue;
        const WallSample* thinnest = nullptr;
        const std::vector<WallSample> walls = walls_of(mesh, b);
        for (const WallSample& wall : walls) {
            if (thinnest == nullptr || wall.thickness / wall.edge < thinnest->thickness / thinnest->edge)
                thinnest = &wall;
        }
        if (thinnest == nullptr || thinnest->thickness > enough * thinnest->edge) continue;
        const Vec3 place = rounded(thinnest->at, bounds(bodies[b]).diagonal());
        mesh.notes.push_back(fmt::format(
            "body \"{}\": the wall at ({:.4g}, {:.4g}, {:.4g}), {:.3g} thick, has about {:.1f} elements through it; "
            "elements_through_wall asks for more",
            bodies[b].name, place.x, place.y, place.z, thinnest->thickness, thinnest->thickness / thinnest->edge));
    }
}

/// Converts surfaces that may touch another body to solids if they have few flat faces.
std::vector<BodyGeometry> with_solids(std::span<const BodyGeometry> bodies, double margin) {
    std::vector<BodyGeometry> result(bodies.begin(), bodies.end());
    const auto near = [&](const BodyGeometry& a, const BodyGeometry& b) {
        return boxes_meet(bounds(a), bounds(b), margin);
    };
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto* surface = std::get_if<TriMesh>(&bodies[i].shape);
        if (surface == nullptr) continue;
        bool alone = true;
        for (std::size_t j = 0; j < bodies.size(); ++j) alone = alone && (i == j || !near(bodies[i], bodies[j]));
        if (alone) continue;
        if (Result<Solid> solid = polyhedron(*surface)) result[i].shape = std::move(*solid);
    }
    return result;
}

/// Surfaces with seams from rounding closed, and a note for each that had some.
std::vector<BodyGeometry> without_seams(std::span<const BodyGeometry> bodies, std::vector<std::string>& notes) {
    std::vector<BodyGeometry> result(bodies.begin(), bodies.end());
    for (BodyGeometry& body : result) {
        auto* surface = std::get_if<TriMesh>(&body.shape);
        const std::size_t closed = surface == nullptr ? 0 : close_seams(*surface).edges;
        if (closed > 0)
            notes.push_back(
                fmt::format("body \"{}\": {} open edges of its surface were closed: their ends differ by less "
                            "than a millionth of its size",
                            body.name, closed));
    }
    return result;
}

}  // namespace

Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> drawn, const MeshSettings& settings, Progress& progress,
                            int way) {
    if (Status status = check_settings(drawn, settings); !status) return tl::unexpected(status.error());
    std::vector<std::string> notes;
    const std::vector<BodyGeometry> bodies =
        with_solids(without_seams(drawn, notes), std::max(settings.close_gaps, 0.01 * settings.size));
    SizeField field(bodies, settings);
    const Result<Drawing> drawing = group_bodies(bodies, settings.size, way);
    if (!drawing) return tl::unexpected(drawing.error());
    if (Status status = follow_walls(*drawing, settings, field, progress); !status)
        return tl::unexpected(status.error());
    Result<TetMesh> mesh = mesh_once(*drawing, settings, field, progress);
    if (mesh) mesh = close_gaps(*drawing, settings, field, std::move(*mesh), progress);
    if (!mesh) return mesh;
    mesh->notes.insert(mesh->notes.begin(), notes.begin(), notes.end());
    if (field.too_thin())
        mesh->notes.push_back(
            fmt::format("a wall is too thin for {} elements through it: edges go down to an eighth of the mesh size; "
                        "take a smaller one",
                        settings.through_wall));
    else if (settings.judge_walls && settings.through_wall == 0)
        judge_walls(bodies, *mesh);
    return mesh;
}

}  // namespace pliant::mesh::kernel
