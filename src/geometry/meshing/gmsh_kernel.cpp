#include "geometry/meshing/gmsh_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <new>
#include <numbers>
#include <numeric>

#include "base/core/boxes.hpp"
#include "geometry/mesh/curved_tets.hpp"
#include "geometry/mesh/mesh_report.hpp"
#include "geometry/meshing/drawn_improver.hpp"
#include "geometry/meshing/gmsh_calls.hpp"
#include "geometry/meshing/tet_improver.hpp"
#include "geometry/repair/surface_orientation.hpp"
#include "geometry/repair/surface_shells.hpp"
#include "geometry/repair/surface_slivers.hpp"
#include "geometry/shapes/flat_faces.hpp"

namespace pliant::mesh::kernel {
namespace {

namespace occ = gmsh::model::occ;
using gmsh::Entities;

/// A separate Gmsh model, silent and reproducible.
class Session {
public:
    Session() {
        gmsh::initialize();
        gmsh::option::set_number("General.Terminal", 0);
        gmsh::option::set_number("General.AbortOnError", 2);  // throw exceptions
        gmsh::option::set_number("General.NumThreads", 1);
        gmsh::option::set_number("Mesh.RandomSeed", 1);
        gmsh::option::set_number("Mesh.Algorithm", 6);    // frontal Delaunay on surfaces
        gmsh::option::set_number("Mesh.Algorithm3D", 1);  // Delaunay in volumes
        gmsh::option::set_number("Mesh.Optimize", 1);
        gmsh::model::add("pliant");
    }
    ~Session() {
        try {
            gmsh::finalize();
        } catch (...) {  // nothing can be done about it, and a destructor must not throw
        }
    }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
};

/// Runs `work` in a session; exceptions from Gmsh become errors.
template <class Work>
auto in_session(std::string_view task, const Work& work) -> decltype(work()) {
    try {
        const Session session;
        return work();
    } catch (const std::bad_alloc&) {
        throw;  // the caller handles the limit
    } catch (const std::exception& error) {
        return failure("{}: Gmsh says: {}", task, error.what());
    } catch (...) {
        return failure("{}: Gmsh failed without a reason", task);
    }
}

/// The solids of a STEP file, in file order. Open CASCADE converts the file's unit to millimetres.
Entities import_solids(const std::string& file, double scale) {
    Entities solids = occ::import_shapes(file);
    std::erase_if(solids, [](const auto& entity) { return entity.first != 3; });
    if (scale != 1 && !solids.empty()) occ::dilate(solids, scale);
    return solids;
}

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

    static Entities build(const Solid& solid) { return std::visit(BuildSolid{}, solid->shape); }

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

double mass(const Entities& volumes) {
    double sum = 0;
    for (const auto& [dimension, tag] : volumes) {
        if (dimension == 3) sum += occ::get_mass(dimension, tag);
    }
    return sum;
}

/// Volume that two solids share.
double common_volume(const Entities& one, const Entities& other) {
    const Entities common = BuildSolid::intersect(occ::copy(one), occ::copy(other));
    const double volume = mass(common);
    if (!common.empty()) occ::remove(common, true);
    return volume;
}

/// A note for every two solids that overlap; join_volumes() gives the overlap to the later one.
std::vector<std::string> overlaps(std::span<const NamedSolid> solids, const std::vector<Entities>& volumes) {
    std::vector<std::string> notes;
    for (std::size_t i = 0; i < solids.size(); ++i) {
        for (std::size_t j = i + 1; j < solids.size(); ++j) {
            if (!boxes_meet(bounds(solids[i].solid), bounds(solids[j].solid))) continue;
            const double overlap = common_volume(volumes[i], volumes[j]);
            if (overlap <= 1e-9 * std::min(mass(volumes[i]), mass(volumes[j]))) continue;
            notes.push_back(
                fmt::format("\"{0}\" and \"{1}\" overlap in a volume of {2:.6g} (in the file's unit, cubed), which "
                            "belongs to \"{1}\", the later one",
                            solids[i].name, solids[j].name, overlap));
        }
    }
    return notes;
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

void set_size(double size) {
    gmsh::option::set_number("Mesh.MeshSizeMax", size);
    gmsh::option::set_number("Mesh.MeshSizeMin", 0);
    gmsh::option::set_number("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::set_number("Mesh.MeshSizeExtendFromBoundary", 1);
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

double boundary_area(const Entities& volumes) {
    double sum = 0;
    for (const auto& [dimension, tag] : gmsh::model::get_boundary(volumes, false)) sum += occ::get_mass(dimension, tag);
    return sum;
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

/// The surface as one discrete entity of the model.
int add_triangles(const TriMesh& surface) {
    const int entity = gmsh::model::add_discrete_entity(2);
    std::vector<std::size_t> tags(surface.points.size());
    std::iota(tags.begin(), tags.end(), std::size_t{1});
    std::vector<double> coordinates;
    for (const Vec3& p : surface.points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    gmsh::model::mesh::add_nodes(2, entity, tags, coordinates);
    std::vector<std::size_t> elements(surface.triangles.size());
    std::iota(elements.begin(), elements.end(), std::size_t{1});
    std::vector<std::size_t> nodes;
    for (const auto& triangle : surface.triangles) {
        for (const int n : triangle) nodes.push_back(static_cast<std::size_t>(n) + 1);
    }
    gmsh::model::mesh::add_elements_by_type(entity, 2, elements, nodes);
    return entity;
}

/// Meshes the region enclosed by the model's surfaces.
Result<TetMesh> mesh_enclosed(double size, const SizeAt& size_at) {
    std::vector<int> loop;
    for (const auto& [dimension, tag] : gmsh::model::get_entities(2)) loop.push_back(tag);
    const int volume = gmsh::model::geo::add_volume({gmsh::model::geo::add_surface_loop(loop)});
    gmsh::model::geo::synchronize();
    set_size(size);
    follow_size(size_at, {}, size);
    return generate({{volume, 0}}, 1);
}

/// Appends the triangles of one face of the model to `surface`; `index` maps Gmsh's nodes to points.
void append_face(int face, TriMesh& surface, std::map<std::size_t, int>& index) {
    const auto [elements, nodes] = gmsh::model::mesh::get_elements_by_type(2, face);
    for (std::size_t t = 0; t < elements.size(); ++t) {
        std::array<int, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [entry, fresh] = index.try_emplace(nodes[3 * t + k], static_cast<int>(surface.points.size()));
            triangle[k] = entry->second;
            if (!fresh) continue;
            const std::vector<double> at = gmsh::model::mesh::get_node(nodes[3 * t + k]);
            surface.points.push_back({at[0], at[1], at[2]});
        }
        surface.triangles.push_back(triangle);
    }
}

/// The triangles on the faces of `volumes`, normals outwards.
TriMesh collect_surface(const Entities& volumes) {
    TriMesh surface;
    for (const auto& volume : volumes) {
        TriMesh one;
        std::map<std::size_t, int> index;
        for (const auto& [dimension, tag] : gmsh::model::get_boundary({volume}, true))
            append_face(std::abs(tag), one, index);
        orient_solid(one);  // Open CASCADE's faces may have either orientation
        append(surface, one);
    }
    return surface;
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

/// `exact` receives the volume of each solid.
Result<TetMesh> try_mesh_solids(std::span<const NamedSolid> solids, double size, int order, const SizeAt& size_at,
                                double join_within, int refinement, std::vector<double>& exact) {
    return in_session("meshing", [&]() -> Result<TetMesh> {
        std::vector<Entities> volumes;
        double volume = 0;
        for (const NamedSolid& named : solids) {
            volumes.push_back(BuildSolid::build(named.solid));
            const double one = mass(volumes.back());
            if (!(one > 0)) return nothing_left(named);
            volume += one;
        }
        std::vector<std::string> notes = overlaps(solids, volumes);
        const std::map<int, int> solid_of_volume = join_volumes(volumes, join_within);
        for (std::size_t i = 0; i < solids.size(); ++i) {
            const auto is_left = [&](const auto& entry) { return entry.second == static_cast<int>(i); };
            if (std::none_of(solid_of_volume.begin(), solid_of_volume.end(), is_left))
                return about(solids[i].name,
                             {Cause::input,
                              fmt::format("body \"{}\" is empty: all of it belongs to later ones", solids[i].name)});
        }
        occ::synchronize();
        Entities joined;
        exact.assign(solids.size(), 0);
        for (const auto& [tag, solid] : solid_of_volume) {
            joined.emplace_back(3, tag);
            exact[static_cast<std::size_t>(solid)] += occ::get_mass(3, tag);
        }
        if (Status status = check_tet_count(volume, boundary_area(joined), size); !status)
            return tl::unexpected(status.error());
        set_size(size);
        gmsh::option::set_number("Mesh.MeshSizeFromCurvature", 8 * refinement);
        gmsh::option::set_number("Mesh.MeshSizeMin", 0.2 * size / refinement);
        if (size_at) {
            gmsh::option::set_number("Mesh.MeshSizeMin", 0.05 * size / refinement);
            follow_size(size_at, solids_of_entities(solid_of_volume), size);
        }
        Result<TetMesh> mesh = generate(solid_of_volume, order);
        if (mesh) improve_drawn_tets(*mesh, improved_below_deg);
        if (mesh && order == 2) straighten_folded_tets(*mesh, least_jacobian);
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
                            double join_within) {
    constexpr double most_off = 0.03;
    constexpr int finest = 8;
    std::vector<double> exact;
    const auto attempt = [&](double factor, int refinement) {
        return try_mesh_solids(solids, factor * size, order, times(size_at, factor), join_within, refinement, exact);
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
        add_triangles(with_enough_triangles(surface, enough));
        gmsh::model::mesh::classify_surfaces(angle_deg * std::numbers::pi / 180, true, true, std::numbers::pi);
        gmsh::model::mesh::create_geometry();
        return mesh_enclosed(size, size_at);
    };
    const auto as_drawn = [&]() -> Result<TetMesh> {
        add_triangles(surface);
        return mesh_enclosed(size, size_at);
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

namespace {

struct RoundFace {
    double area, least_radius, largest_radius;
};

struct RoundFaces {
    std::vector<RoundFace> faces;
    bool only_balls_and_cylinders = true;  ///< of radii up to `reach`: known at every point, not at the samples alone
};

/// The faces of the volumes that are not flat, with their radii at a grid of points, at most `reach`.
RoundFaces round_faces(const Entities& volumes, double reach) {
    constexpr int grid = 4;
    RoundFaces round;
    for (const auto& [dimension, tag] : gmsh::model::get_boundary(volumes, false)) {
        const auto [low, high] = gmsh::model::get_parametrization_bounds(dimension, tag);
        std::vector<double> places;
        for (int i = 0; i < grid * grid; ++i) {
            const double u = (i % grid + 0.5) / grid, v = (i / grid + 0.5) / grid;
            places.push_back(low[0] + u * (high[0] - low[0]));
            places.push_back(low[1] + v * (high[1] - low[1]));
        }
        RoundFace face{occ::get_mass(dimension, tag), reach, 0};
        for (const double curvature : gmsh::model::get_curvature(tag, places)) {
            if (!(std::fabs(curvature) * reach > 1)) continue;
            face.least_radius = std::min(face.least_radius, 1 / std::fabs(curvature));
            face.largest_radius = std::max(face.largest_radius, 1 / std::fabs(curvature));
        }
        if (face.largest_radius > 0) round.faces.push_back(face);
        const std::string type = gmsh::model::get_type(dimension, tag);
        const bool is_known = (type == "Sphere" || type == "Cylinder") && face.largest_radius > 0;
        round.only_balls_and_cylinders = round.only_balls_and_cylinders && (is_known || type == "Plane");
    }
    return round;
}

/// How many triangles, about, the round faces get with so many chords per turn.
double triangles_of(const std::vector<RoundFace>& faces, double segments) {
    constexpr double equilateral = 0.433;  // area over the square of an edge
    double sum = 0;
    for (const RoundFace& face : faces) {
        const double edge = 2 * std::numbers::pi * face.least_radius / segments;
        sum += face.area / (equilateral * edge * edge);
    }
    return sum;
}

struct Chords {
    double per_turn, deviation;
};

/// So many chords per turn that those of an arc of radius r deviate by tolerance / 2; the other half is for triangles,
/// which deviate more from a ball than their edges do. Gmsh divides arcs of all radii into equally many: what the
/// largest one needs would make a long thin rod a matter of hours, so where that is too much, only what the radii at
/// hand need, or even less. So it is too where these are known at every point.
Chords chords_for(const Entities& volumes, double reach, double tolerance) {
    constexpr double least = 24, most = 2000, too_many_triangles = 5e5, many_triangles = 2e5;
    constexpr double finer = 1.5, few_triangles = 5e4;  // 2.25 times nearer than asked, where it costs little
    const auto needed = [&](double radius) {
        return std::clamp(2 * std::numbers::pi / std::sqrt(4 * tolerance / radius), least, most);
    };
    const auto [faces, only_balls_and_cylinders] = round_faces(volumes, reach);
    double radius = tolerance;
    for (const RoundFace& face : faces) radius = std::max(radius, face.largest_radius);
    if (only_balls_and_cylinders) {
        for (const auto& [factor, limit] : {std::pair(finer, few_triangles), std::pair(1.0, too_many_triangles)}) {
            const double chords = std::min(factor * needed(radius), needed(reach));
            if (triangles_of(faces, chords) <= limit) return {chords, tolerance};
        }
    } else if (triangles_of(faces, needed(reach)) <= too_many_triangles) {
        return {needed(reach), tolerance};
    }
    const double fewer = std::sqrt(std::min(1.0, many_triangles / triangles_of(faces, needed(radius))));
    const double chords = std::max(least, fewer * needed(radius));
    return {chords, std::max(tolerance, std::pow(std::numbers::pi / chords, 2) * radius)};
}

}  // namespace

Result<TriMesh> tessellate(const Solid& solid, double tolerance) {
    return in_session("tessellating", [&]() -> Result<TriMesh> {
        const Entities volumes = BuildSolid::build(solid);
        if (volumes.empty()) return input_error("is empty: nothing is left of it");
        occ::synchronize();
        const double reach = std::max(bounds(solid).diagonal() / 2, tolerance);
        const auto [segments, deviation] = chords_for(volumes, reach, tolerance);
        set_size(4 * reach);  // flat faces need no inner points
        gmsh::option::set_number("Mesh.MeshSizeFromCurvature", segments);
        gmsh::model::mesh::generate(2);
        TriMesh surface = collect_surface(volumes);
        const double exact = mass(volumes);
        const double found = signed_volume(surface);
        if (std::fabs(found - exact) > 4 * deviation * boundary_area(volumes) + 1e-6 * exact)
            return failure("the surface encloses {:.6g} where the solid has {:.6g}", found, exact);
        return surface;
    });
}

namespace {

/// The solids of a STEP file, with meshed surfaces.
Entities import_surfaces(const std::string& file, double scale) {
    Entities solids = import_solids(file, scale);
    occ::synchronize();
    gmsh::option::set_number("Mesh.MeshSizeFromCurvature", 32);
    if (!solids.empty()) gmsh::model::mesh::generate(2);
    return solids;
}

}  // namespace

Result<StepContent> read_step(const std::string& file, double scale) {
    return in_session("reading", [&]() -> Result<StepContent> {
        const Entities solids = import_surfaces(file, scale);
        if (solids.empty()) return input_error("holds no solid");
        StepContent content;
        for (const auto& solid : solids) {
            const std::string path = gmsh::model::get_entity_name(3, solid.second);
            content.names.push_back(path.substr(path.rfind('/') + 1));
            content.surfaces.push_back(collect_surface({solid}));
        }
        return content;
    });
}

Result<double> solid_volume(const Solid& solid) {
    return in_session("measuring", [&]() -> Result<double> { return mass(BuildSolid::build(solid)); });
}

}  // namespace pliant::mesh::kernel
