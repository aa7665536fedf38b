// The only file that includes CGAL.
#include "mesh/winding_mesher.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/perturb_mesh_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "mesh/gmsh_kernel.hpp"
#include "mesh/sharp_edges.hpp"
#include "mesh/surface_orientation.hpp"
#include "mesh/tet_improver.hpp"
#include "mesh/triangle_tree.hpp"

namespace pliant::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Mesh_domain_with_polyline_features_3<CGAL::Labeled_mesh_domain_3<Kernel>>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

constexpr double inside = 0.5;
/// Somewhere inside the surface must wind this often: a sheet reaches a half on its very face.
constexpr double surely_inside = 0.6;

Kernel::Point_3 cgal(const Vec3& p) {
    return {p.x, p.y, p.z};
}

/// The share of a box in which the surface winds at least `least` times, by points spread evenly over it (Roberts' R3
/// sequence; no plane holds many of them, where a sheet could lie).
double share_inside(const TriangleTree& tree, const Box3& box, double least) {
    constexpr int count = 60000;
    constexpr double g = 1.22074408460575947536;  // x^4 = x + 1
    int held = 0;
    for (int i = 1; i <= count; ++i) {
        const auto along = [&](double step) { return std::fmod(0.5 + i * step, 1.0); };
        const Vec3 d = box.size();
        const Vec3 p = box.low + Vec3{d.x * along(1 / g), d.y * along(1 / (g * g)), d.z * along(1 / (g * g * g))};
        held += tree.winding_number(p) > least ? 1 : 0;
    }
    return static_cast<double>(held) / count;
}

/// A little larger, so that a flat surface does not fill its box.
Box3 grown(const Box3& box) {
    const double by = 1e-3 * box.diagonal();
    return {box.low - Vec3{by, by, by}, box.high + Vec3{by, by, by}};
}

TetMesh collect(const Complex& complex, const Vec3& offset) {
    TetMesh mesh;
    mesh.region_names = {"0"};
    std::unordered_map<Triangulation::Vertex_handle, int> index;
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
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
        mesh.region.push_back(0);
    }
    return mesh;
}

/// Several times what a mesh of this size has where nothing is finer than it, and room for what is.
std::size_t node_limit(const TriMesh& surface, double size) {
    double area = 0;
    for (const auto& [a, b, c] : surface.triangles) {
        const auto at = [&](int n) { return surface.points[static_cast<std::size_t>(n)]; };
        area += norm(cross(at(b) - at(a), at(c) - at(a))) / 2;
    }
    const double nodes = std::fabs(signed_volume(surface)) / (size * size * size) + area / (size * size);
    return 6000 + static_cast<std::size_t>(std::min(6 * nodes, 20e6));
}

/// CGAL cannot be asked to stop: it is left through the only function of ours that it calls.
struct Cancelled {};

/// Where CGAL is, by how often it has asked whether a point is inside: `per_node` times for each node, as a guess.
class Asked {
public:
    Asked(double nodes, Progress& progress) : expected_(per_node * nodes), progress_(progress) {}

    void count() {
        if (progress_.cancelled()) throw Cancelled();
        constexpr long step = 1 << 14;
        // How many are needed is a guess: the bar nears its end ever more slowly.
        if (++count_ % step == 0)
            progress_.advance("mesh a damaged surface", 1 - std::exp(-2 * static_cast<double>(count_) / expected_));
    }

private:
    static constexpr double per_node = 400;
    long count_ = 0;
    double expected_;
    Progress& progress_;
};

/// What is asked of the mesh beside its size.
struct Demands {
    std::vector<std::vector<Vec3>> edges;  ///< that stay
    double distance;                       ///< of the mesh's surface from the true one, as a share of the size
    double facet_angle_deg;
};

/// Around the origin; nothing where refinement does not come to an end within the limit. CGAL's edge of a facet of
/// circumradius r is up to sqrt(3) r long, that of a cell up to 1.63 r.
std::optional<Complex> mesh_around_origin(const TriangleTree& tree, const Box3& box, const Demands& demands,
                                          double size, Asked& asked) {
    namespace params = CGAL::parameters;
    CGAL::get_default_random() = CGAL::Random(0);
    const double radius = 0.6 * box.diagonal();
    constexpr double exact = 1e-3;  // of the size: how well points lie on the surface; each digit costs three questions
    Domain domain = Domain::create_implicit_mesh_domain(
        [&](const Kernel::Point_3& p) {
            asked.count();
            return inside - tree.winding_number({p.x(), p.y(), p.z()});
        },
        Kernel::Sphere_3(CGAL::ORIGIN, radius * radius), params::relative_error_bound = exact * size / radius);
    std::vector<std::vector<Kernel::Point_3>> lines;
    for (const std::vector<Vec3>& chain : demands.edges) {
        auto& line = lines.emplace_back();
        for (const Vec3& p : chain) line.push_back(cgal(p));
    }
    domain.add_features(lines.begin(), lines.end());
    const Criteria criteria(params::edge_size = size, params::facet_angle = demands.facet_angle_deg,
                            params::facet_size = 0.65 * size, params::facet_distance = demands.distance * size,
                            params::cell_radius_edge_ratio = 2, params::cell_size = 0.75 * size);
    CGAL::Mesh_error_code code = CGAL::CGAL_MESH_3_NO_ERROR;
    Complex complex = CGAL::make_mesh_3<Complex>(
        domain, criteria, params::no_perturb(), params::no_exude(),
        params::mesh_3_options(params::maximal_number_of_vertices = node_limit(tree.surface(), size),
                               params::pointer_to_error_code = &code));
    if (code != CGAL::CGAL_MESH_3_NO_ERROR) return std::nullopt;
    CGAL::perturb_mesh_3(complex, domain, params::sliver_bound = 12);
    CGAL::exude_mesh_3(complex, params::sliver_bound = 12);
    return complex;
}

std::string damage_note(const SurfaceDamage& damage, double volume) {
    std::string text;
    const auto add = [&](std::size_t count, std::string_view what) {
        if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
    };
    add(damage.open_edges, "open edges");
    add(damage.crowded_edges, "edges of more than two triangles");
    add(damage.turned, "triangles turned");
    add(damage.repeated, "repeated triangles");
    add(damage.flat, "flat triangles");
    add(damage.inside_out ? 1 : 0, "surface turned inside out");
    const std::string is = text.empty() ? "" : fmt::format("is damaged ({}) and ", text);
    return fmt::format("the surface {}was meshed from its winding number; check its volume: {:.6g}", is, volume);
}

}  // namespace

Result<TetMesh> mesh_by_winding(const TriMesh& surface, double size, double angle_deg, Progress& progress) {
    TriMesh centred = surface;
    const Box3 whole = bounds(surface);
    const Vec3 middle = 0.5 * (whole.low + whole.high);
    for (Vec3& p : centred.points) p -= middle;
    const SurfaceDamage damage = orient(centred);
    const Box3 box = grown(bounds(centred));
    const TriangleTree tree(std::move(centred));
    if (tree.surface().triangles.empty() || share_inside(tree, box, surely_inside) == 0)
        return input_error("the surface encloses nothing: it is an open sheet, or more hole than wall");
    const Vec3 d = box.size();
    const double volume = share_inside(tree, box, inside) * d.x * d.y * d.z;
    Status few = kernel::check_tet_count(volume, volume / size, size);
    if (!few) return tl::unexpected(few.error());
    try {
        const SharpEdges edges = sharp_edges(tree, size, angle_deg);
        Asked asked(1 + static_cast<double>(node_limit(tree.surface(), size)) / 6, progress);
        std::optional<Complex> complex = mesh_around_origin(tree, box, {edges.chains, 0.05, 25}, size, asked);
        const bool rounded = !complex;
        if (rounded) complex = mesh_around_origin(tree, box, {{}, 0.15, 20}, size, asked);
        if (!complex)
            return failure("the mesh of the damaged surface does not come to an end; try a smaller mesh size");
        TetMesh mesh = collect(*complex, middle);
        improve_tets(mesh, {.feature_deg = angle_deg});
        const double meshed = mesh::volume(mesh);
        if (!(std::fabs(meshed - volume) < 0.1 * volume))
            return failure(
                "the mesh of the damaged surface has a volume of {:.6g} instead of about {:.6g}; try another "
                "mesh size",
                meshed, volume);
        mesh.notes.push_back(damage_note(damage, meshed));
        if (rounded)
            mesh.notes.emplace_back("its sharp edges are rounded off: with them the mesh does not come to an end");
        else if (edges.dropped > 0)
            mesh.notes.push_back(
                fmt::format("{} sharp edges that cross or nearly touch others are rounded off", edges.dropped));
        return mesh;
    } catch (const Cancelled&) {
        return cancelled();
    } catch (const std::exception& error) {
        return failure("CGAL says: {}", error.what());
    }
}

}  // namespace pliant::mesh
