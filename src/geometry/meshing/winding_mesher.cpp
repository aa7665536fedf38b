// The only file that includes CGAL.
#include "geometry/meshing/winding_mesher.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/make_mesh_3.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

#include "base/core/disjoint_sets.hpp"
#include "geometry/meshing/gmsh_kernel.hpp"
#include "geometry/meshing/labelled_space.hpp"
#include "geometry/meshing/sharp_edges.hpp"
#include "geometry/meshing/tet_improver.hpp"

namespace pliant::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Labeled = CGAL::Mesh_domain_with_polyline_features_3<CGAL::Labeled_mesh_domain_3<Kernel>>;

/// CGAL starts with points where random rays hit the surface, a search that can take very long if the body fills little
/// of its box, unless sharp edges provide enough. Here it gets given points instead.
class Domain : public Labeled {
public:
    using Labeled::Labeled;

    using Start = std::pair<Vec3, Surface_patch_index>;
    std::function<std::vector<Start>()> starts;

    struct Construct_initial_points {
        const Domain& domain;
        template <class Output>
        Output operator()(Output output, int = 0) const {
            for (const auto& [p, patch] : domain.starts())
                *output++ = std::pair(Kernel::Point_3(p.x, p.y, p.z), domain.index_from_surface_patch_index(patch));
            return output;
        }
    };
    [[nodiscard]] Construct_initial_points construct_initial_points_object() const { return {*this}; }
};
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

/// The winding number must reach this value somewhere inside a surface: for a sheet it is at most a half, directly at
/// its face.
constexpr double surely_inside = 0.6;

/// Tets with smaller dihedral angles are improved after CGAL, whose own optimisers leave as many and may take minutes.
constexpr double wanted_deg = 12;

Kernel::Point_3 cgal(const Vec3& p) {
    return {p.x, p.y, p.z};
}

constexpr int samples = 60000;

/// The fraction of a box for which `holds` is true, by evenly spread points (Roberts' R3 sequence; no plane, such as a
/// sheet, contains many of them).
template <class Holds>
double share_of(const Box3& box, const Holds& holds) {
    constexpr double g = 1.22074408460475947536;  // x^4 = x + 1
    int held = 0;
    for (int i = 1; i <= samples; ++i) {
        const auto along = [&](double step) { return std::fmod(0.5 + i * step, 1.0); };
        const Vec3 d = box.size();
        const Vec3 p = box.low + Vec3{d.x * along(1 / g), d.y * along(1 / (g * g)), d.z * along(1 / (g * g * g))};
        held += holds(p) ? 1 : 0;
    }
    return static_cast<double>(held) / samples;
}

/// A little larger, so that a flat surface does not fill its box.
Box3 grown(const Box3& box) {
    const double by = 1e-3 * box.diagonal();
    return {box.low - Vec3{by, by, by}, box.high + Vec3{by, by, by}};
}

using Cells = std::vector<Complex::Cell_handle>;

double volume_of(const Complex::Cell_handle& cell) {
    const auto at = [&](int k) {
        const auto& p = cell->vertex(k)->point();
        return Vec3{p.x(), p.y(), p.z()};
    };
    return std::fabs(signed_tet_volume(at(0), at(1), at(2), at(3)));
}

/// The cells of the complex without crumbs: sets of cells connected by faces with a total below a hundredth of a tet.
/// Where a surface intersects itself they are attached to the rest by an edge only, or not at all.
Cells cells_without_crumbs(const Complex& complex, double size) {
    const double least = 1e-3 * size * size * size;
    Cells cells;
    std::unordered_map<Complex::Cell_handle, int> number;
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
        number.emplace(cell, static_cast<int>(cells.size()));
        cells.push_back(cell);
    }
    DisjointSets pieces(cells.size());
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (int k = 0; k < 4; ++k) {
            const auto other = number.find(cells[c]->neighbor(k));
            if (other != number.end()) pieces.join(static_cast<int>(c), other->second);
        }
    }
    std::vector<double> volumes(cells.size());  // of each piece, stored at its lowest cell
    const auto piece = [&](std::size_t c) { return static_cast<std::size_t>(pieces.find(static_cast<int>(c))); };
    for (std::size_t c = 0; c < cells.size(); ++c) volumes[piece(c)] += volume_of(cells[c]);
    Cells kept;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        if (volumes[piece(c)] >= least) kept.push_back(cells[c]);
    }
    return kept;
}

TetMesh collect(const Complex& complex, const Vec3& offset, double size) {
    TetMesh mesh;
    std::unordered_map<Triangulation::Vertex_handle, int> index;
    for (const Complex::Cell_handle& cell : cells_without_crumbs(complex, size)) {
        std::array<int, 4> nodes{};
        for (int k = 0; k < 4; ++k) {
            const auto vertex = cell->vertex(k);
            const auto [entry, fresh] = index.try_emplace(vertex, static_cast<int>(mesh.points.size()));
            const auto& p = vertex->point();
            if (fresh) mesh.points.push_back(offset + Vec3{p.x(), p.y(), p.z()});
            nodes[static_cast<std::size_t>(k)] = entry->second;
        }
        const auto at = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(nodes[k])]; };
        if (signed_tet_volume(at(0), at(1), at(2), at(3)) < 0) std::swap(nodes[1], nodes[2]);
        mesh.nodes.insert(mesh.nodes.end(), nodes.begin(), nodes.end());
        mesh.region.push_back(complex.subdomain_index(cell) - 1);
    }
    return mesh;
}

/// Estimated number of nodes in a mesh of this size without finer details.
double expected_nodes(const TriMesh& surface, double size) {
    double area = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const auto at = [&](int n) { return surface.points[static_cast<std::size_t>(n)]; };
        area += norm(cross(at(b) - at(a), at(c) - at(a))) / 2;
    }
    return std::fabs(signed_volume(surface)) / (size * size * size) + area / (size * size);
}

/// Several times that number, with allowance for details finer than the size.
std::size_t node_limit(const LabelledSpace& space, double size) {
    double sum = 0;
    for (const WindingGrid& surface : space.surfaces()) sum += 6000 + 6 * expected_nodes(surface.surface(), size);
    return static_cast<std::size_t>(std::min(sum, 20e6));
}

/// CGAL cannot be cancelled: an exception from our only function that it calls leaves it.
struct Cancelled {};

/// Progress of CGAL, by the number of times it has queried whether a point is inside: an estimated `per_node` for each
/// node.
class Asked {
public:
    Asked(double nodes, Progress& progress) : expected_(per_node * nodes), progress_(progress) {}

    void count() {
        if (progress_.cancelled()) throw Cancelled();
        constexpr long step = 1 << 14;
        // The total is an estimate: the progress approaches 1 ever more slowly.
        if (++count_ % step == 0)
            progress_.advance("mesh surfaces", 1 - std::exp(-2 * static_cast<double>(count_) / expected_));
    }

private:
    static constexpr double per_node = 400;
    long count_ = 0;
    double expected_;
    Progress& progress_;
};

/// Requirements on the mesh other than its size.
struct Demands {
    std::vector<std::vector<Vec3>> edges;  ///< to be preserved
    double distance;                       ///< of the mesh's surface from the true one, as a fraction of the size
    double facet_angle_deg;
    double share = 1;  ///< of all sizes: factor on the edge length
};

/// Edge lengths in the form that CGAL needs, times `share`: for cells by their region, for facets and curves the
/// minimum over adjacent regions, which for curves may be any.
class Sizes {
public:
    using FT = double;
    Sizes(const SizeOfSurface& size_at, std::size_t surfaces, double share)
        : size_at_(&size_at), surfaces_(surfaces), share_(share) {}

    FT operator()(const Kernel::Point_3& p, int dimension, const Domain::Index& index) const {
        const Vec3 at{p.x(), p.y(), p.z()};
        if (const auto* region = dimension == 3 ? boost::get<Domain::Subdomain_index>(&index) : nullptr)
            return share_ * (*size_at_)(static_cast<std::size_t>(*region) - 1, at);
        if (const auto* patch = dimension == 2 ? boost::get<Domain::Surface_patch_index>(&index) : nullptr) {
            double least = std::numeric_limits<double>::infinity();
            for (const int region : {patch->first, patch->second}) {
                if (region > 0) least = std::min(least, (*size_at_)(static_cast<std::size_t>(region) - 1, at));
            }
            return share_ * least;
        }
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t s = 0; s < surfaces_; ++s) least = std::min(least, (*size_at_)(s, at));
        return share_ * least;
    }

private:
    const SizeOfSurface* size_at_;
    std::size_t surfaces_;
    double share_;
};

/// Surfaces centred at the origin, and the requirements on their mesh.
struct Task {
    const LabelledSpace& space;
    std::span<const std::string> names;
    std::vector<double> volumes;  ///< expected for the regions
    Box3 box;
    double size;
    const SizeOfSurface& size_at;
    Asked& asked;
};

/// Points where labels meet, about 4000 at most, spread evenly over the triangles (within each by Roberts' R2
/// sequence).
std::vector<Domain::Start> points_on(const LabelledSpace& space, const TriMesh& surface, double step) {
    constexpr double g = 1.32471795724474602596;  // x^3 = x + 1
    constexpr double tried = 4000;
    const auto corner = [&](std::size_t t, std::size_t k) {
        return surface.points[static_cast<std::size_t>(surface.triangles[t][k])];
    };
    const auto normal = [&](std::size_t t) { return cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)); };
    double whole = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) whole += norm(normal(t));
    std::vector<Domain::Start> found;
    double due = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3 n = normal(t);
        due += tried * norm(n) / whole;
        for (int i = 1; due >= 1; ++i, --due) {
            double u = std::fmod(0.5 + i / g, 1.0);
            double v = std::fmod(0.5 + i / (g * g), 1.0);
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const Vec3 p = corner(t, 0) + u * (corner(t, 1) - corner(t, 0)) + v * (corner(t, 2) - corner(t, 0));
            const Vec3 away = (step / norm(n)) * n;
            const auto labels = std::minmax({space.label(p + away), space.label(p - away)});
            if (labels.first != labels.second) found.emplace_back(p, labels);
        }
    }
    return found;
}

/// From each surface `least` points as far apart as possible, and more as long as they are at least `apart` from each
/// other. If walls are thinner than that spacing, there may be no tet that intersects the surface.
std::vector<Domain::Start> spread_points(const LabelledSpace& space, double diagonal, double apart, std::size_t least) {
    constexpr std::size_t most = 200;
    std::vector<Domain::Start> found;
    for (const WindingGrid& grid : space.surfaces()) {
        const std::vector<Domain::Start> its = points_on(space, grid.surface(), 1e-7 * diagonal);
        found.insert(found.end(), its.begin(), its.end());
    }
    std::vector<Domain::Start> chosen;
    std::vector<double> distance(found.size(), std::numeric_limits<double>::infinity());
    while (!found.empty() && chosen.size() < most) {
        const auto farthest = std::max_element(distance.begin(), distance.end()) - distance.begin();
        const double its = distance[static_cast<std::size_t>(farthest)];
        if (its == 0 || (its < apart && chosen.size() >= least)) break;
        chosen.push_back(found[static_cast<std::size_t>(farthest)]);
        const Vec3 p = chosen.back().first;
        for (std::size_t i = 0; i < found.size(); ++i) distance[i] = std::min(distance[i], norm(found[i].first - p));
    }
    return chosen;
}

/// Nothing if refinement does not terminate within the limit. In CGAL the edge of a facet of circumradius r is up to
/// sqrt(3) r long, that of a cell up to 1.63 r.
std::optional<Complex> mesh_around_origin(const Task& task, const Demands& demands) {
    namespace params = CGAL::parameters;
    CGAL::get_default_random() = CGAL::Random(0);
    const double radius = 0.6 * task.box.diagonal();
    constexpr double exact = 1e-3;  // of the size: accuracy of points on the surface; each digit costs three queries
    Domain domain(
        [&](const Kernel::Point_3& p) {
            task.asked.count();
            return task.space.label({p.x(), p.y(), p.z()});
        },
        Kernel::Sphere_3(CGAL::ORIGIN, radius * radius), params::relative_error_bound = exact * task.size / radius);
    domain.starts = [&] {
        const auto least = static_cast<std::size_t>(20 / std::pow(demands.share, 3));
        return spread_points(task.space, 2 * radius, demands.share * task.size, least);
    };
    std::vector<std::vector<Kernel::Point_3>> lines;
    for (const std::vector<Vec3>& chain : demands.edges) {
        auto& line = lines.emplace_back();
        for (const Vec3& p : chain) line.push_back(cgal(p));
    }
    domain.add_features(lines.begin(), lines.end());
    const std::size_t surfaces = task.space.surfaces().size();
    const auto sizes = [&](double share) { return Sizes(task.size_at, surfaces, demands.share * share); };
    const Criteria criteria(params::edge_size = sizes(1), params::facet_angle = demands.facet_angle_deg,
                            params::facet_size = sizes(0.65),
                            params::facet_distance = demands.share * demands.distance * task.size,
                            params::cell_radius_edge_ratio = 2, params::cell_size = sizes(0.75));
    CGAL::Mesh_error_code code = CGAL::CGAL_MESH_3_NO_ERROR;
    Complex complex = CGAL::make_mesh_3<Complex>(
        domain, criteria, params::no_perturb(), params::no_exude(),
        params::mesh_3_options(params::maximal_number_of_vertices = node_limit(task.space, demands.share * task.size),
                               params::pointer_to_error_code = &code));
    if (code != CGAL::CGAL_MESH_3_NO_ERROR) return std::nullopt;
    return complex;
}

/// Surfaces oriented outwards and moved to the origin.
struct Centred {
    std::vector<TriMesh> surfaces;
    std::vector<SurfaceDamage> damage;
    Vec3 middle;  ///< the original centre
};

Centred centre(std::span<const TriMesh> surfaces) {
    Centred result;
    Box3 whole;
    for (const TriMesh& surface : surfaces) {
        for (const Vec3& p : surface.points) whole.add(p);
    }
    if (!whole.empty()) result.middle = whole.center();
    for (const TriMesh& surface : surfaces) {
        TriMesh& moved = result.surfaces.emplace_back(surface);
        for (Vec3& p : moved.points) p -= result.middle;
        result.damage.push_back(orient(moved));
    }
    return result;
}

/// Triangles most of whose edges are open, and more of whose box they enclose by half than wholly.
bool is_unrelated(const WindingGrid& surface, const SurfaceDamage& damage, const Box3& box, double enclosed) {
    constexpr std::size_t open_edges_each = 2;
    constexpr double hardly = 0.2;
    if (damage.open_edges <= open_edges_each * surface.surface().triangles.size()) return false;
    const double doubtful = share_of(box, [&](const Vec3& p) {
        const double times = surface.winding_number(p);
        return times < -hardly || (times > hardly && times <= surely_inside);
    });
    return doubtful >= enclosed;
}

/// Of each region, by sampling.
Result<std::vector<double>> expected_volumes(const LabelledSpace& space, std::span<const SurfaceDamage> damage,
                                             std::span<const std::string> names) {
    std::vector<double> volumes;
    for (std::size_t s = 0; s < space.surfaces().size(); ++s) {
        const WindingGrid& surface = space.surfaces()[s];
        const Box3 box = grown(surface.box());
        const auto encloses = [&](const Vec3& p) { return surface.winding_number(p) > surely_inside; };
        const double enclosed = surface.surface().triangles.empty() ? 0 : share_of(box, encloses);
        if (enclosed == 0 || is_unrelated(surface, damage[s], box, enclosed))
            return kernel::about(
                names[s], {Cause::input,
                           fmt::format("{} encloses nothing: it is an open sheet, or more hole than wall", names[s])});
        const auto owns = [&](const Vec3& p) { return space.label(p) == static_cast<int>(s) + 1; };
        const Vec3 d = box.size();
        volumes.push_back(share_of(box, owns) * d.x * d.y * d.z);
    }
    return volumes;
}

/// Volumes that surfaces lose to later ones, if larger than the sampling error of two samplings.
std::vector<JointMesh::Overlap> overlaps_of(const LabelledSpace& space, const std::vector<double>& volumes) {
    constexpr double least = 5e-3;  // of the smaller one
    std::vector<JointMesh::Overlap> found;
    for (std::size_t loser = 0; loser + 1 < volumes.size(); ++loser) {
        const WindingGrid& surface = space.surfaces()[loser];
        std::vector<int> held(volumes.size() + 1);  // sample points of the losing surface, by their label
        (void)share_of(surface.box(), [&](const Vec3& p) {
            const bool its = surface.winding_number(p) > surely_inside;
            if (its) ++held[static_cast<std::size_t>(space.label(p))];
            return its;
        });
        const Vec3 d = surface.box().size();
        for (std::size_t keeper = loser + 1; keeper < volumes.size(); ++keeper) {
            const double volume = static_cast<double>(held[keeper + 1]) / samples * d.x * d.y * d.z;
            if (volume > least * std::min(volumes[loser], volumes[keeper])) found.push_back({loser, keeper, volume});
        }
    }
    return found;
}

Status check_volumes(const TetMesh& mesh, const Task& task) {
    for (std::size_t s = 0; s < task.volumes.size(); ++s) {
        const double meshed = volume(mesh, static_cast<int>(s));
        const double expected = task.volumes[s];
        if (std::fabs(meshed - expected) <= 0.1 * expected) continue;
        return kernel::about(task.names[s],
                             {Cause::failed, fmt::format("the mesh of {} has a volume of {:.6g} "
                                                         "instead of about {:.6g}; try another mesh size",
                                                         task.names[s], meshed, expected)});
    }
    return {};
}

/// The mesh with edges of `share` times the wanted sizes, with sharp edges rounded off if it does not terminate
/// otherwise.
Result<TetMesh> try_mesh(const Task& task, const SharpEdges& edges, const Vec3& offset, double angle_deg,
                         double share) {
    std::optional<Complex> complex = mesh_around_origin(task, {edges.chains, 0.05, 25, share});
    const bool rounded = !complex;
    if (rounded) complex = mesh_around_origin(task, {{}, 0.15, 20, share});
    if (!complex)
        return failure("the mesh of {} does not come to an end; try a smaller mesh size", fmt::join(task.names, ", "));
    TetMesh mesh = collect(*complex, offset, share * task.size);
    improve_tets(mesh, {.wanted_deg = wanted_deg, .feature_deg = angle_deg});
    if (Status status = check_volumes(mesh, task); !status) return tl::unexpected(status.error());
    if (rounded)
        mesh.notes.emplace_back("its sharp edges are rounded off: with them the mesh does not come to an end");
    else if (edges.dropped > 0)
        mesh.notes.push_back(
            fmt::format("{} sharp edges that cross or nearly touch others are rounded off", edges.dropped));
    return mesh;
}

/// The mesh with the wanted sizes or, if these are too coarse to follow the surface, with somewhat smaller ones.
Result<TetMesh> mesh_finely_enough(const Task& task, const SharpEdges& edges, const Vec3& offset, double angle_deg) {
    constexpr std::array<double, 3> shares = {0.7, 0.5, 0.35};
    Result<TetMesh> mesh = try_mesh(task, edges, offset, angle_deg, 1);
    for (std::size_t i = 0; !mesh && i < shares.size(); ++i) {
        Result<TetMesh> finer = try_mesh(task, edges, offset, angle_deg, shares[i]);
        if (!finer) continue;
        mesh = std::move(finer);
        mesh->notes.push_back(fmt::format(
            "its edges are {:g} times as long as the mesh size asks: longer ones cannot follow its shape", shares[i]));
    }
    return mesh;
}

Result<JointMesh> mesh_centred(Centred centred, std::span<const std::string> names, double size,
                               const SizeOfSurface& size_at, double angle_deg, Progress& progress) {
    const LabelledSpace space(std::move(centred.surfaces));
    const Result<std::vector<double>> volumes = expected_volumes(space, centred.damage, names);
    if (!volumes) return tl::unexpected(volumes.error());
    double whole = 0;
    double nodes = 0;
    Box3 box;
    for (std::size_t s = 0; s < space.surfaces().size(); ++s) {
        const WindingGrid& surface = space.surfaces()[s];
        whole += (*volumes)[s];
        nodes += expected_nodes(surface.surface(), size);
        box.add(surface.box().low);
        box.add(surface.box().high);
    }
    Status few = kernel::check_tet_count(whole, whole / size, size);
    if (!few) return tl::unexpected(few.error());
    try {
        const SharpEdges edges = sharp_edges(space, size, angle_deg);
        Asked asked(1000 + nodes, progress);
        const SizeOfSurface size_here = [&](std::size_t s, const Vec3& p) { return size_at(s, p + centred.middle); };
        const Task task{space, names, *volumes, grown(box), size, size_here, asked};
        Result<TetMesh> mesh = mesh_finely_enough(task, edges, centred.middle, angle_deg);
        if (!mesh) return tl::unexpected(mesh.error());
        return JointMesh{std::move(*mesh), std::move(centred.damage), overlaps_of(space, *volumes)};
    } catch (const Cancelled&) {
        return cancelled();
    } catch (const std::exception& error) {
        return failure("CGAL says: {}", error.what());
    }
}

}  // namespace

Result<JointMesh> mesh_together(std::span<const TriMesh> surfaces, std::span<const std::string> names, double size,
                                const SizeOfSurface& size_at, double angle_deg, Progress& progress) {
    return mesh_centred(centre(surfaces), names, size, size_at, angle_deg, progress);
}

Result<TetMesh> mesh_by_winding(const TriMesh& surface, double size, double angle_deg, Progress& progress) {
    const std::string name = "the surface";
    Result<JointMesh> joint = mesh_together(
        {&surface, 1}, {&name, 1}, size, [size](std::size_t, const Vec3&) { return size; }, angle_deg, progress);
    if (!joint) return tl::unexpected(joint.error());
    const std::string damage = describe(joint->damage.front());
    joint->mesh.region_names = {"0"};
    joint->mesh.notes.insert(
        joint->mesh.notes.begin(),
        fmt::format("the surface {}was meshed from its winding number; check its volume: {:.6g}",
                    damage.empty() ? "" : fmt::format("is damaged ({}) and ", damage), volume(joint->mesh)));
    return std::move(joint->mesh);
}

}  // namespace pliant::mesh
