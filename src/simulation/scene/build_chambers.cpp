#include "simulation/scene/build_chambers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/repair/cavity.hpp"
#include "geometry/repair/split_edges.hpp"
#include "geometry/repair/surface_check.hpp"
#include "simulation/actuators/chamber_surface.hpp"
#include "simulation/scene/build_places.hpp"
#include "simulation/scene/chamber_mouths.hpp"
#include "simulation/scene/chamber_overlaps.hpp"
#include "simulation/scene/target_values.hpp"

namespace pliant::robot {
namespace {

/// The wall in a surface file need not match the mesh exactly: largest distance from the bodies, as a share of the
/// robot's size.
constexpr double wall_reach = 0.03;
/// Of the space inside such a wall; some is allowed because the wall need not match the mesh.
constexpr double most_material = 0.9;

/// The boundary of a meshed chamber. A mouth not covered by a body must be inside a support.
sim::Wall wall_of_region(ModelDraft& draft, const ChamberSpec& spec) {
    const int region = static_cast<int>(draft.region_of(Region::Use::chamber, spec.name));
    std::vector<mesh::Face> faces = mesh::region_faces(draft.whole, region);
    // Where the air has elements, they carry the nodes of a mouth.
    const std::size_t mouth_faces = spec.elements ? 0 : put_mouths_last(draft, faces);
    sim::Wall wall = sim::wall_of_faces(draft.whole, faces, draft.node_of_whole);
    wall.mouth_faces = mouth_faces;
    if (faces.empty()) {
        draft.problem(spec.line, "chamber", spec.name, "is empty");
        return {};
    }
    if (const std::string open = open_mouth(draft, spec, faces, wall); !open.empty())
        draft.problem(spec.line, "chamber", spec.name, open);
    return wall;
}

/// The wall of a cavity of the bodies.
sim::Wall wall_of_cavity(ModelDraft& draft, const ChamberSpec& spec, const CavityAt& cavity) {
    const Vec3 point = draft.robot.unit_m * cavity.point;
    Result<std::vector<mesh::Face>> faces = mesh::cavity_faces(draft.bodies, point);
    if (faces) return pressed_wall(draft, std::move(*faces));
    draft.problem(spec.line, "chamber", spec.name,
                  fmt::format("inside: the point {} {}", draft.show(point), faces.error().message));
    return {};
}

/// The share of the space inside a closed surface that is material, by the points of a grid; 0 if none of them lies
/// inside.
double share_of_material(const mesh::TriMesh& surface, const sim::Attacher& attacher) {
    constexpr int cells = 12;
    const mesh::TriangleTree tree(surface);
    const Box3 box = mesh::bounds(surface);
    const Vec3 step = box.size() / cells;
    int inside = 0, material = 0;
    for (int k = 0; k < cells * cells * cells; ++k) {
        const Vec3 cell{k % cells + 0.5, k / cells % cells + 0.5, k / (cells * cells) + 0.5};
        const Vec3 p = box.low + Vec3{cell.x * step.x, cell.y * step.y, cell.z * step.z};
        if (tree.winding_number(p) < 0.5) continue;
        ++inside;
        material += attacher.distance_outside(p) > 0 ? 0 : 1;
    }
    return inside > 0 ? static_cast<double>(material) / inside : 0;
}

/// The point in the middle of each edge, by its ends in ascending order.
using EdgeMiddles = std::map<std::pair<int, int>, int>;

/// `outwards`: the side that the triangles look to; `middles`: empty for faces that stay flat.
std::vector<sim::WallFace> wall_faces(const mesh::TriMesh& surface, bool outwards, const EdgeMiddles& middles) {
    std::vector<sim::WallFace> faces;
    for (const auto& t : surface.triangles) {
        const std::array<int, 3> c = outwards ? t : std::array<int, 3>{t[0], t[2], t[1]};
        const auto middle = [&](std::size_t k) {
            return middles.empty() ? -1 : middles.at(std::minmax(c[k], c[(k + 1) % 3]));
        };
        faces.push_back({c[0], c[1], c[2], middle(0), middle(1), middle(2)});
    }
    return faces;
}

/// Adds the middles to the points of the surface.
EdgeMiddles add_middles(mesh::TriMesh& surface) {
    EdgeMiddles middles;
    for (const auto& t : surface.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [edge, fresh] = middles.try_emplace(std::minmax(t[k], t[(k + 1) % 3]));
            if (!fresh) continue;
            edge->second = static_cast<int>(surface.points.size());
            const Vec3 a = surface.points[static_cast<std::size_t>(edge->first.first)];
            const Vec3 b = surface.points[static_cast<std::size_t>(edge->first.second)];
            surface.points.push_back(0.5 * (a + b));
        }
    }
    return middles;
}

/// A closed surface whose points are attached to the tets that contain them. Only its points move, and pressure acts on
/// them: its triangles must not be larger than the faces of the tets beside them, and bend as these do.
sim::Wall wall_of_file(ModelDraft& draft, const sim::Attacher& attacher, const ChamberSpec& spec,
                       const SurfaceFile& given) {
    Result<mesh::SurfaceFile> file = mesh::read_surface(given.path);
    if (!file) {
        draft.problem(spec.line, "chamber", spec.name, file.error().message);
        return {};
    }
    mesh::TriMesh surface = mesh::scaled(mesh::placed(std::move(file->mesh), given.placement), draft.robot.unit_m);
    if (Status closed = mesh::check_closed(surface); !closed) {
        draft.problem(spec.line, "chamber", spec.name, closed.error().message);
        return {};
    }
    if (const double material = share_of_material(surface, attacher); material > most_material) {
        draft.problem(spec.line, "chamber", spec.name,
                      fmt::format("{:.0f} % of the space in its surface is material, but the bodies must already have "
                                  "the cavity; with geometry = a shape it is cut out of them",
                                  100 * material));
        return {};
    }
    // Quadratic tets have nodes in the middle of their edges, and faces that bend.
    const bool bends = draft.description.mesh.order == 2;
    const double share = bends ? 0.5 : 1;
    surface =
        mesh::with_short_edges(std::move(surface), [&](const Vec3& p) { return share * attacher.edge_of_tet(p); });
    const bool outwards = mesh::signed_volume(surface) > 0;
    const EdgeMiddles middles = bends ? add_middles(surface) : EdgeMiddles{};
    sim::Wall wall;
    for (const Vec3& p : surface.points) {
        Result<sim::Attachment> attachment = attacher.carried_by_tet(p, wall_reach * draft.box.diagonal());
        if (!attachment) {
            draft.problem(spec.line, "chamber", spec.name,
                          fmt::format("its wall at {} is far from every body; {}", draft.show(p), draft.show_bounds()));
            return {};
        }
        wall.points.push_back(std::move(*attachment));
    }
    wall.faces = wall_faces(surface, outwards, middles);
    return wall;
}

/// Nothing is below a vacuum.
void check_pressure(ModelDraft& draft, const ChamberSpec& spec) {
    if (spec.target.kind != sim::ChamberTarget::Kind::pressure_Pa) return;
    const double ambient = draft.robot.ambient_pressure_Pa;
    for (const TargetValue& wanted : target_values(spec)) {
        const double pressure = wanted.value + spec.target.offset;
        if (pressure >= -ambient) continue;
        return draft.problem(
            spec.line, "chamber", spec.name,
            fmt::format("{}a pressure of {:.6g} kPa{} is below a vacuum: the air around has {:.6g} "
                        "kPa (program.ambient_pressure)",
                        wanted.where, 1e-3 * pressure, with_offset(spec.target.offset), 1e-3 * ambient));
    }
}

/// What remains of a chamber of this volume; empty if its volume is not given.
std::optional<double> volume_at(const sim::ChamberTarget& target, double value, double rest_m3) {
    using Kind = sim::ChamberTarget::Kind;
    if (target.kind == Kind::volume_ratio) return value * rest_m3 + target.offset;
    if (target.kind == Kind::volume_change_m3) return rest_m3 + value + target.offset;
    return std::nullopt;
}

/// A chamber cannot lose all the air that it holds, nor more.
void check_volume_change(ModelDraft& draft, const ChamberSpec& spec, const sim::Wall& wall) {
    constexpr double ml_per_m3 = 1e6, rounding = 1e-9;
    std::vector<double> rest;
    for (const Vec3& p : draft.description.mesh.points) rest.insert(rest.end(), {p.x, p.y, p.z});
    const double holds = sim::ChamberSurface(wall, rest).volume(rest);
    for (const TargetValue& wanted : target_values(spec)) {
        const std::optional<double> volume = volume_at(spec.target, wanted.value, holds);
        if (!volume || *volume > rounding * holds) continue;
        return draft.problem(
            spec.line, "chamber", spec.name,
            fmt::format("{}cannot lose {:.4g} ml{}, it holds {:.4g} ml", wanted.where, ml_per_m3 * (holds - *volume),
                        with_offset(spec.target.offset), ml_per_m3 * holds));
    }
}

void add_chamber(ModelDraft& draft, const sim::Attacher& attacher, const ChamberSpec& spec) {
    sim::Chamber chamber{spec.name, {}, spec.target};
    if (const auto* file = std::get_if<SurfaceFile>(&spec.air))
        chamber.wall = wall_of_file(draft, attacher, spec, *file);
    else if (const auto* cavity = std::get_if<CavityAt>(&spec.air))
        chamber.wall = wall_of_cavity(draft, spec, *cavity);
    else
        chamber.wall = wall_of_region(draft, spec);
    if (chamber.wall.faces.empty()) return;
    using Kind = sim::ChamberTarget::Kind;
    const bool by_volume = spec.target.kind == Kind::volume_ratio || spec.target.kind == Kind::volume_change_m3;
    if (by_volume && are_held(draft.description, chamber.wall.points))
        draft.problem(spec.line, "chamber", spec.name, "cannot change its volume: all of its wall is in a [[fixed]]");
    check_pressure(draft, spec);
    check_volume_change(draft, spec, chamber.wall);
    if (spec.elements) {
        const std::size_t region = draft.region_of(Region::Use::chamber, spec.name);
        const auto actuator = static_cast<int>(draft.description.steered_count());
        draft.description.growths.push_back(
            {draft.material_of(region), {}, actuator, spec.weight * softest_Pa(draft.robot), 0, {}});
    }
    draft.description.chambers.push_back(std::move(chamber));
}

}  // namespace

void add_chambers(ModelDraft& draft, const sim::Attacher& attacher) {
    for (const ChamberSpec& chamber : draft.robot.chambers) add_chamber(draft, attacher, chamber);
    if (draft.description.chambers.size() == draft.robot.chambers.size()) check_overlaps(draft);  // else told already
}

}  // namespace pliant::robot
