// The only file that includes CGAL.
#include "mesh/winding_mesher.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/make_mesh_3.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>

#include "mesh/gmsh_kernel.hpp"
#include "mesh/surface_orientation.hpp"
#include "mesh/triangle_tree.hpp"

namespace pliant::mesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Mesh_domain_with_polyline_features_3<CGAL::Labeled_mesh_domain_3<Kernel>>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using Polylines = std::vector<std::vector<Kernel::Point_3>>;

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

class SharpEdges {
public:
    SharpEdges(const TriangleTree& tree, double size, double angle_deg)
        : tree_(tree), size_(size), least_cosine_(std::cos(angle_deg * std::numbers::pi / 180)) {}

    /// Chains of sharp edges that bound material, broken where three or more meet and at sharp bends.
    Polylines find() {
        collect();
        Polylines lines;
        for (const auto& [node, ends] : next_) {
            if (ends.size() != 2) {
                for (const int end : ends) walk(node, end, lines);
            }
        }
        for (const auto& [node, ends] : next_) {  // what is left are closed loops
            for (const int end : ends) walk(node, end, lines);
        }
        return lines;
    }

private:
    void collect() {
        std::map<std::pair<int, int>, std::vector<int>> triangles_of;
        const TriMesh& surface = tree_.surface();
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [low, high] = std::minmax(surface.triangles[t][k], surface.triangles[t][(k + 1) % 3]);
                triangles_of[{low, high}].push_back(static_cast<int>(t));
            }
        }
        for (const auto& [edge, triangles] : triangles_of) {
            if (triangles.size() != 2 || dot(normal(triangles[0]), normal(triangles[1])) > least_cosine_) continue;
            if (!bounds_material(edge.first, edge.second)) continue;
            next_[edge.first].push_back(edge.second);
            next_[edge.second].push_back(edge.first);
        }
    }

    [[nodiscard]] Vec3 normal(int triangle) const {
        const auto& [a, b, c] = tree_.surface().triangles[static_cast<std::size_t>(triangle)];
        const Vec3 n = cross(at(b) - at(a), at(c) - at(a));
        return n / norm(n);
    }
    [[nodiscard]] const Vec3& at(int node) const { return tree_.surface().points[static_cast<std::size_t>(node)]; }

    /// Both material and none close to the middle of the edge.
    [[nodiscard]] bool bounds_material(int a, int b) const {
        const Vec3 along = at(b) - at(a);
        const Vec3 middle = 0.5 * (at(a) + at(b));
        const double radius = 0.02 * std::min(size_, norm(along));
        const Vec3 other = std::fabs(along.x) < 0.6 * norm(along) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        Vec3 u = cross(along, other);
        u = u / norm(u);
        const Vec3 v = cross(along, u) / norm(along);
        int held = 0;
        constexpr int directions = 16;
        for (int i = 0; i < directions; ++i) {
            const double turn = 2 * std::numbers::pi * (i + 0.37) / directions;
            held += tree_.winding_number(middle + radius * (std::cos(turn) * u + std::sin(turn) * v)) > inside ? 1 : 0;
        }
        return held > 0 && held < directions;
    }

    /// Goes from `from` over `to` to the end of the chain, unless that was done from the other end.
    void walk(int from, int to, Polylines& lines) {
        if (!done_.insert(std::minmax(from, to)).second) return;
        const int start = from;
        std::vector<Kernel::Point_3> line = {cgal(at(from)), cgal(at(to))};
        while (to != start && next_[to].size() == 2) {
            const int onward = next_[to][0] == from ? next_[to][1] : next_[to][0];
            const Vec3 before = at(to) - at(from);
            const Vec3 after = at(onward) - at(to);
            if (dot(before, after) < least_cosine_ * norm(before) * norm(after)) break;  // a corner
            if (!done_.insert(std::minmax(to, onward)).second) break;
            from = to;
            to = onward;
            line.push_back(cgal(at(to)));
        }
        lines.push_back(std::move(line));
    }

    const TriangleTree& tree_;
    double size_;
    double least_cosine_;
    std::map<int, std::vector<int>> next_;
    std::set<std::pair<int, int>> done_;
};

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

/// Around the origin. CGAL's edge of a facet of circumradius r is up to sqrt(3) r long, that of a cell up to 1.63 r.
Complex mesh_around_origin(const TriangleTree& tree, const Box3& box, double size, double angle_deg) {
    namespace params = CGAL::parameters;
    CGAL::get_default_random() = CGAL::Random(0);
    const double radius = 0.6 * box.diagonal();
    Domain domain = Domain::create_implicit_mesh_domain(
        [&tree](const Kernel::Point_3& p) {
            return inside - tree.winding_number({p.x(), p.y(), p.z()});
        },
        Kernel::Sphere_3(CGAL::ORIGIN, radius * radius), params::relative_error_bound = 1e-5);
    const Polylines lines = SharpEdges(tree, size, angle_deg).find();
    domain.add_features(lines.begin(), lines.end());
    const Criteria criteria(params::edge_size = size, params::facet_angle = 25, params::facet_size = 0.65 * size,
                            params::facet_distance = 0.05 * size, params::cell_radius_edge_ratio = 2,
                            params::cell_size = 0.75 * size);
    return CGAL::make_mesh_3<Complex>(domain, criteria, params::perturb(params::sliver_bound = 12),
                                      params::exude(params::sliver_bound = 12));
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
    return fmt::format("the surface is damaged ({}) and was meshed from its winding number; check its volume: {:.6g}",
                       text.empty() ? "it cuts through itself" : text, volume);
}

}  // namespace

Result<TetMesh> mesh_by_winding(const TriMesh& surface, double size, double angle_deg) {
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
        TetMesh mesh = collect(mesh_around_origin(tree, box, size, angle_deg), middle);
        const double meshed = mesh::volume(mesh);
        if (!(std::fabs(meshed - volume) < 0.1 * volume))
            return failure(
                "the mesh of the damaged surface has a volume of {:.6g} instead of about {:.6g}; try another "
                "mesh size",
                meshed, volume);
        mesh.notes.push_back(damage_note(damage, meshed));
        return mesh;
    } catch (const std::exception& error) {
        return failure("CGAL says: {}", error.what());
    }
}

}  // namespace pliant::mesh
