#include "geometry/meshing/gmsh_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

#include "base/core/boxes.hpp"
#include "geometry/mesh/curved_tets.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/mesher/message_pipe.hpp"
#include "geometry/meshing/build_solid.hpp"
#include "geometry/meshing/drawn_improver.hpp"
#include "geometry/meshing/gmsh_session.hpp"
#include "geometry/meshing/sampled_volume.hpp"
#include "geometry/meshing/tet_improver.hpp"
#include "geometry/repair/surface_shells.hpp"
#include "geometry/repair/surface_slivers.hpp"
#include "geometry/shapes/overlap_note.hpp"
#include "geometry/shapes/shape_names.hpp"

namespace pliant::mesh::kernel {
namespace {

namespace occ = gmsh::model::occ;
using gmsh::Entities;

/// Open CASCADE joined solids wrongly.
struct WrongJoint : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "the volumes are wrong"; }
};

/// A note for every two solids that overlap; join_volumes() gives the overlap to the later one. Throws if the points in
/// them tell another overlap.
std::vector<std::string> overlaps(std::span<const NamedSolid> solids, const std::vector<Entities>& volumes) {
    std::vector<std::string> notes;
    for (std::size_t i = 0; i < solids.size(); ++i) {
        for (std::size_t j = i + 1; j < solids.size(); ++j) {
            const Solid &one = solids[i].solid, &other = solids[j].solid;
            if (!boxes_meet(bounds(one), bounds(other))) continue;
            const double overlap = common_volume(volumes[i], volumes[j]);
            const double smaller = std::min(volume_of(volumes[i]), volume_of(volumes[j]));
            const auto sampled = [&](int points) { return covered_volume(one, {&other, 1}, points); };
            if (can_be_sampled(one) && can_be_sampled(other) && !fits(overlap, volume_slack(smaller), sampled))
                throw WrongJoint();
            if (overlap <= 1e-9 * smaller) continue;
            notes.push_back(overlap_note(solids[i].name, solids[j].name, overlap));
        }
    }
    return notes;
}

/// Throws if joining left a solid with another volume than what later ones do not cover of it.
void check_joint(std::span<const NamedSolid> solids, const std::vector<double>& before,
                 const std::vector<double>& after, double within) {
    for (std::size_t i = 0; i < solids.size(); ++i) {
        const Solid& solid = solids[i].solid;
        const Box3 box = bounds(solid);
        std::vector<Solid> later;
        for (std::size_t j = i + 1; j < solids.size(); ++j) {
            if (boxes_meet(box, bounds(solids[j].solid), within)) later.push_back(solids[j].solid);
        }
        if (!can_be_sampled(solid) || !can_be_sampled(later)) continue;
        const Vec3 d = box.size();
        const double moved = within * 2 * (d.x * d.y + d.y * d.z + d.z * d.x);  // faces may move by this to close gaps
        const auto sampled = [&](int points) { return covered_volume(solid, later, points); };
        if (!fits(before[i] - after[i], volume_slack(before[i]) + moved, sampled)) throw WrongJoint();
    }
}

/// Maps Gmsh's 10-node tet to ours: its last two mid-edge nodes are swapped.
constexpr std::array<int, 10> gmsh_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

/// The tets of the current Gmsh model; `body_of_volume` gives regions.
TetMesh collect_tets(const std::map<int, int>& body_of_volume, int order) {
    const auto [tags, coordinates] = gmsh::model::mesh::get_nodes();
    std::map<std::size_t, Vec3> position;
    for (std::size_t i = 0; i < tags.size(); ++i) {
        position[tags[i]] = {coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]};
    }
    TetMesh mesh;
    mesh.order = order;
    std::map<std::size_t, int> index;
    const int type = order == 2 ? 11 : 4;
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    for (const auto& [volume, body] : body_of_volume) {
        const auto [elements, nodes] = gmsh::model::mesh::get_elements_by_type(type, volume);
        for (std::size_t t = 0; t < elements.size(); ++t) {
            for (std::size_t a = 0; a < width; ++a) {
                const std::size_t tag = nodes[t * width + static_cast<std::size_t>(gmsh_order[a])];
                const auto [entry, fresh] = index.try_emplace(tag, static_cast<int>(mesh.points.size()));
                if (fresh) mesh.points.push_back(position[tag]);
                mesh.nodes.push_back(entry->second);
            }
            mesh.region.push_back(body);
        }
    }
    return mesh;
}

/// Tets with smaller dihedral angles are improved after Gmsh.
constexpr double improved_below_deg = 1.4 * sliver_deg;

/// Slivers are due to chance: a slightly smaller size gives other points, and usually no slivers. `attempt(factor)`
/// meshes with sizes times `factor`; `best` is its result for 1.
template <class Attempt>
Result<TetMesh> without_slivers(Result<TetMesh> best, const Attempt& attempt) {
    double angle = smallest_dihedral_deg(*best);
    constexpr std::size_t many = 20;  // if one tet in this many is a sliver, the cause is not chance but walls thinner
                                      // than the edges are long
    if (angle >= sliver_deg || many * sliver_count(*best, sliver_deg) > best->tet_count()) return best;
    for (double factor = 0.97; factor > 0.8 && angle < sliver_deg; factor -= 0.03) {
        Result<TetMesh> other = attempt(factor);
        if (!other) continue;
        const double its = smallest_dihedral_deg(*other);
        if (its <= angle) continue;
        angle = its;
        best = std::move(other);
    }
    return best;
}

/// `size_at` times `factor`, if it is not empty.
SizeAt times(const SizeAt& size_at, double factor) {
    if (!size_at || factor == 1) return size_at;
    return [&size_at, factor](std::size_t solid, const Vec3& p) { return factor * size_at(solid, p); };
}

/// Curved quadratic tets must keep this fraction of their straight Jacobian everywhere.
constexpr double least_jacobian = 0.1;

Result<TetMesh> generate(const std::map<int, int>& body_of_volume, int order) {
    gmsh::model::mesh::generate(3);
    if (order == 2) gmsh::model::mesh::set_order(2);
    TetMesh mesh = collect_tets(body_of_volume, order);
    if (mesh.tet_count() == 0) return failure("no tetrahedra came out");
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        if (signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]) > 0) continue;
        const Vec3& p = mesh.points[n[0]];
        return failure("a tetrahedron at ({:.6g}, {:.6g}, {:.6g}) came out flat; try another mesh size", p.x, p.y, p.z);
    }
    if (order == 2) straighten_folded_tets(mesh, least_jacobian);
    return mesh;
}

/// Joins the solids where they touch or are at most `within` apart, so that the pieces share their common faces;
/// returns the solid of every volume.
std::map<int, int> join_volumes(const std::vector<Entities>& volumes, double within) {
    Entities all;
    std::vector<int> owner;
    for (std::size_t s = 0; s < volumes.size(); ++s) {
        all.insert(all.end(), volumes[s].begin(), volumes[s].end());
        owner.insert(owner.end(), volumes[s].size(), static_cast<int>(s));
    }
    if (all.size() == 1) return {{all.front().second, 0}};
    gmsh::option::set_number("Geometry.ToleranceBoolean", within);
    const std::vector<Entities> parts = occ::fragment({all.front()}, Entities(all.begin() + 1, all.end())).became;
    std::map<int, int> solid_of_volume;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        for (const auto& [dimension, tag] : parts[i]) {
            if (dimension == 3) solid_of_volume[tag] = owner[i];
        }
    }
    return solid_of_volume;
}

/// The solids that an entity of the model belongs to or bounds.
using SolidsOf = std::map<std::pair<int, int>, std::vector<std::size_t>>;

SolidsOf solids_of_entities(const std::map<int, int>& solid_of_volume) {
    SolidsOf solids;
    for (const auto& [volume, solid] : solid_of_volume) {
        Entities level = {{3, volume}};
        for (int dimension = 3; dimension >= 0; --dimension) {
            for (const auto& entity : level) solids[entity].push_back(static_cast<std::size_t>(solid));
            if (dimension == 0) break;
            level = gmsh::model::get_boundary(level, false);
        }
    }
    return solids;
}

/// Sets sizes from `size_at`; entities between solids take the smallest of theirs.
void follow_size(const SizeAt& size_at, const SolidsOf& solids, double size) {
    if (!size_at) return;
    gmsh::model::mesh::set_size_callback(
        [&size_at, solids, size](int dimension, int tag, double x, double y, double z) {
            double least = size;
            const auto found = solids.find({dimension, tag});
            if (found == solids.end()) return std::min(least, size_at(0, {x, y, z}));
            least = std::numeric_limits<double>::infinity();
            for (const std::size_t solid : found->second) least = std::min(least, size_at(solid, {x, y, z}));
            return least;
        });
}

/// The given triangles of a surface as a discrete entity of the model. Every node belongs to the first entity that uses
/// it: `added` (points).
int add_triangles(const TriMesh& surface, std::span<const std::size_t> triangles, std::vector<bool>& added) {
    const int entity = gmsh::model::add_discrete_entity(2);
    std::vector<std::size_t> tags, elements, nodes;
    for (const std::size_t t : triangles) {
        elements.push_back(t + 1);
        for (const int n : surface.triangles[t]) {
            const auto point = static_cast<std::size_t>(n);
            nodes.push_back(point + 1);
            if (!added[point]) tags.push_back(point + 1);
            added[point] = true;
        }
    }
    std::sort(tags.begin(), tags.end());
    std::vector<double> coordinates;
    for (const std::size_t tag : tags) {
        const Vec3& p = surface.points[tag - 1];
        coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    }
    gmsh::model::mesh::add_nodes(2, entity, tags, coordinates);
    gmsh::model::mesh::add_elements_by_type(entity, 2, elements, nodes);
    return entity;
}

/// The surface as one discrete entity of the model.
void add_surface(const TriMesh& surface) {
    std::vector<std::size_t> all(surface.triangles.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    std::vector<bool> added(surface.points.size(), false);
    add_triangles(surface, all, added);
}

/// The surface as one discrete entity per shell: Gmsh finds regions by the entities around them, so that a cavity whose
/// wall is in one entity with the outer shell would be no hole.
std::vector<int> add_shells(const TriMesh& surface) {
    std::vector<bool> added(surface.points.size(), false);
    std::vector<int> entities;
    for (const std::vector<std::size_t>& shell : shell_triangles(surface))
        entities.push_back(add_triangles(surface, shell, added));
    return entities;
}

/// Meshes the region that loops of surfaces enclose; a loop may consist of separate ones.
Result<TetMesh> mesh_enclosed(const std::vector<std::vector<int>>& loops, double size, const SizeAt& size_at) {
    std::vector<int> shells;
    for (const std::vector<int>& loop : loops) shells.push_back(gmsh::model::geo::add_surface_loop(loop));
    const int volume = gmsh::model::geo::add_volume(shells);
    gmsh::model::geo::synchronize();
    set_size(size);
    follow_size(size_at, {}, size);
    return generate({{volume, 0}}, 1);
}

tl::unexpected<Error> nothing_left(const NamedSolid& named) {
    if (const auto* air = std::get_if<EnclosedSolid>(&named.solid->shape)) {
        return about(
            named.name,
            {Cause::input,
             fmt::format("chamber \"{}\": the point ({:.6g}, {:.6g}, {:.6g}) lies in no closed cavity: it is in a "
                         "body, or the space around it is open; close each mouth with cap = SHAPE",
                         named.name, air->point.x, air->point.y, air->point.z)});
    }
    return about(named.name, {Cause::input, fmt::format("body \"{}\" is empty: nothing is left of it", named.name)});
}

/// The error where joining fails in every way, at last for this reason.
tl::unexpected<Error> cannot_join(std::span<const NamedSolid> solids, const std::string& reason) {
    std::vector<Solid> shapes;
    std::string names;
    for (const NamedSolid& named : solids) {
        shapes.push_back(named.solid);
        names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", named.name);
    }
    return about(solids.back().name,
                 {Cause::input, fmt::format("Open CASCADE joins the bodies {} wrongly, which consist of {}; {} ({})",
                                            names, shapes_of(shapes), advice_on_contact, reason)});
}

/// Where the volume of a mesh differs most from that of the solid, as a share of it.
struct VolumeError {
    double share = 0;
    std::size_t solid = 0;
};

VolumeError volume_error(const TetMesh& mesh, const std::vector<double>& exact) {
    std::vector<double> volume(exact.size(), 0.0);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t)
        volume[static_cast<std::size_t>(mesh.region[t])] += curved_volume(mesh, t);
    VolumeError worst;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double share = exact[i] > 0 ? volume[i] / exact[i] - 1 : 0;
        if (std::fabs(share) > std::fabs(worst.share)) worst = {share, i};
    }
    return worst;
}

/// How solids are meshed.
struct Attempt {
    double size = 0;
    int order = 2;
    SizeAt size_at;
    double join_within = 0;
    int refinement = 1;  ///< how much more closely curves are followed
    int way = 0;         ///< of build()
};

/// What an attempt finds out besides its mesh.
struct Findings {
    std::vector<double> exact;  ///< the volume of each solid
    bool misjoined = false;     ///< Open CASCADE joined the solids wrongly; built in another way they may fit
};

Result<TetMesh> try_mesh_solids(std::span<const NamedSolid> solids, const Attempt& how, Findings& findings) {
    const double size = how.size;
    std::vector<double>& exact = findings.exact;
    return in_session("meshing", [&]() -> Result<TetMesh> {
        std::vector<Entities> volumes;
        std::vector<double> drawn;
        for (const NamedSolid& named : solids) {
            const Result<Entities> built = build(named.solid, how.way);
            if (!built)
                return about(named.name,
                             {built.error().cause, fmt::format("body \"{}\": {}", named.name, built.error().message)});
            volumes.push_back(*built);
            drawn.push_back(volume_of(volumes.back()));
            if (!(drawn.back() > 0)) return nothing_left(named);
        }
        findings.misjoined = true;  // unless it gets beyond the checks
        std::vector<std::string> notes = overlaps(solids, volumes);
        const std::map<int, int> solid_of_volume = join_volumes(volumes, how.join_within);
        exact.assign(solids.size(), 0);
        for (const auto& [tag, solid] : solid_of_volume)
            exact[static_cast<std::size_t>(solid)] += occ::get_mass(3, tag);
        check_joint(solids, drawn, exact, how.join_within);
        findings.misjoined = false;
        for (std::size_t i = 0; i < solids.size(); ++i) {
            const auto is_left = [&](const auto& entry) { return entry.second == static_cast<int>(i); };
            if (std::none_of(solid_of_volume.begin(), solid_of_volume.end(), is_left))
                return about(solids[i].name,
                             {Cause::input,
                              fmt::format("body \"{}\" is empty: all of it belongs to later ones", solids[i].name)});
        }
        occ::synchronize();
        Entities joined;
        for (const auto& [tag, solid] : solid_of_volume) joined.emplace_back(3, tag);
        const double volume = std::accumulate(drawn.begin(), drawn.end(), 0.0);
        if (Status status = check_tet_count(volume, boundary_area(joined), size); !status)
            return tl::unexpected(status.error());
        set_size(size);
        gmsh::option::set_number("Mesh.MeshSizeFromCurvature", 8 * how.refinement);
        gmsh::option::set_number("Mesh.MeshSizeMin", 0.2 * size / how.refinement);
        if (how.size_at) {
            gmsh::option::set_number("Mesh.MeshSizeMin", 0.05 * size / how.refinement);
            follow_size(how.size_at, solids_of_entities(solid_of_volume), size);
        }
        Result<TetMesh> mesh = generate(solid_of_volume, how.order);
        if (mesh) improve_drawn_tets(*mesh, improved_below_deg);
        if (mesh && how.order == 2) straighten_folded_tets(*mesh, least_jacobian);
        if (mesh) mesh->notes.insert(mesh->notes.begin(), notes.begin(), notes.end());
        return mesh;
    });
}

}  // namespace

Status check_tet_count(double volume, double area, double size) {
    constexpr double per_cube = 8.5;  // number of regular tets of edge 1 in a cube of edge 1
    constexpr double per_square =
        2.3;  // number of regular triangles of edge 1 in a square of edge 1: thin bodies are all surface
    constexpr double most = 20e6;
    const auto estimate = [&](double edge) {
        return per_cube * volume / (edge * edge * edge) + per_square * area / (edge * edge);
    };
    if (estimate(size) <= most) return {};
    double enough = size;
    while (estimate(enough) > most) enough *= 1.1;
    return input_error(
        "a mesh size of {:.6g} gives about {:.2g} tetrahedra, more than the {:.2g} allowed; take {:.3g} or more", size,
        estimate(size), most, enough);
}

Result<TetMesh> mesh_solids(std::span<const NamedSolid> solids, double size, int order, const SizeAt& size_at,
                            double join_within, int way) {
    constexpr double most_off = 0.03;
    constexpr int finest = 8;
    Findings findings;
    const std::vector<double>& exact = findings.exact;
    const int last_way = way + all_ways - 1;
    const auto attempt = [&](double factor, int refinement) -> Result<TetMesh> {
        for (;; ++way) {
            findings.misjoined = false;
            Result<TetMesh> mesh = try_mesh_solids(
                solids, {factor * size, order, times(size_at, factor), join_within, refinement, way}, findings);
            if (!findings.misjoined) return mesh;
            if (way == last_way) return cannot_join(solids, mesh.error().message);
        }
    };
    // On a thin round wall the chords of one side may cut through the other, or quadratic tets may have to be straight
    // on one side and not on the other, which makes it thick: follow the curves more closely.
    const auto is_too_coarse = [&](const Result<TetMesh>& mesh) {
        if (!mesh) return mesh.error().cause == Cause::failed;
        return order == 2 && std::fabs(volume_error(*mesh, exact).share) > most_off;
    };
    int refinement = 1;
    Result<TetMesh> mesh = attempt(1, refinement);
    while (refinement < finest && is_too_coarse(mesh)) {
        Result<TetMesh> finer = attempt(1, 2 * refinement);
        if (mesh && !finer) break;
        refinement *= 2;
        mesh = std::move(finer);
    }
    // Gmsh may fail on the seam of a round face.
    while (!mesh && mesh.error().cause == Cause::failed && way + 1 < seam_ways) {
        ++way;
        refinement = 1;
        mesh = attempt(1, refinement);
    }
    if (!mesh) return mesh;
    mesh = without_slivers(std::move(mesh), [&](double factor) { return attempt(factor, refinement); });
    if (!mesh || !is_too_coarse(mesh)) return mesh;
    const VolumeError off = volume_error(*mesh, exact);
    mesh->notes.push_back(
        fmt::format("body \"{}\": its mesh has {:.0f} % {} volume than its drawing, because its walls are thin and "
                    "curved; a smaller size helps",
                    solids[off.solid].name, 100 * std::fabs(off.share), off.share > 0 ? "more" : "less"));
    return mesh;
}

namespace {

/// One attempt at mesh_surface().
Result<TetMesh> try_mesh_surface(const TriMesh& surface, double size, double angle_deg, const SizeAt& size_at) {
    // With few triangles in a shell Gmsh may loop forever, splitting a part in two.
    constexpr std::size_t enough = 64;
    const auto anew = [&]() -> Result<TetMesh> {
        add_surface(with_enough_triangles(surface, enough));
        gmsh::model::mesh::classify_surfaces(angle_deg * std::numbers::pi / 180, true, true, std::numbers::pi);
        gmsh::model::mesh::create_geometry();
        std::vector<int> all;
        for (const auto& [dimension, tag] : gmsh::model::get_entities(2)) all.push_back(tag);
        return mesh_enclosed({all}, size, size_at);
    };
    const auto as_drawn = [&]() -> Result<TetMesh> {
        std::vector<std::vector<int>> loops;
        for (const int shell : add_shells(surface)) loops.push_back({shell});
        Result<TetMesh> mesh = mesh_enclosed(loops, size, size_at);
        constexpr double tolerance = 1e-3;  // with the same triangles the mesh has the same volume
        const double drawn = signed_volume(surface);
        if (mesh && std::fabs(volume(*mesh) - drawn) > tolerance * std::fabs(drawn))
            return failure("meshing: the mesh has a volume of {:.6g}, the surface encloses {:.6g}", volume(*mesh),
                           drawn);
        return mesh;
    };
    // Gmsh's parametrisation hangs or crashes on triangles without area.
    Result<TetMesh> mesh = has_flat_triangles(surface) ? failure("meshing: the surface has triangles without area")
                                                       : in_session("meshing", anew);
    if (!mesh) {
        const std::string reason = mesh.error().message;
        mesh = in_session("meshing", as_drawn);
        if (mesh)
            mesh->notes.push_back(fmt::format(
                "the surface keeps the triangles that it was drawn with, whatever the mesh size ({})", reason));
    }
    if (mesh) improve_tets(*mesh, {.wanted_deg = improved_below_deg, .feature_deg = angle_deg});
    if (mesh || mesh.error().message.find("PLC Error") == std::string::npos) return mesh;
    return input_error("the surface cuts through itself; repair it in the program that drew it ({})",
                       mesh.error().message);
}

}  // namespace

Result<TetMesh> mesh_surface(const TriMesh& surface, double size, double angle_deg, const SizeAt& size_at) {
    Result<TetMesh> best = try_mesh_surface(surface, size, angle_deg, size_at);
    if (!best || !best->notes.empty()) return best;  // a surface that keeps its triangles gives the same slivers again
    return without_slivers(std::move(best), [&](double factor) -> Result<TetMesh> {
        Result<TetMesh> other = try_mesh_surface(surface, factor * size, angle_deg, times(size_at, factor));
        if (other && !other->notes.empty()) return failure("it keeps the triangles that were drawn");
        return other;
    });
}

}  // namespace pliant::mesh::kernel
