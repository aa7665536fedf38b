#include "geometry/files/surface_mending.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/repair/surface_nesting.hpp"
#include "geometry/repair/surface_seams.hpp"

namespace pliant::mesh {
namespace {

/// Maximum distance of two copies of a point, each off by some steps along every axis.
constexpr double float_steps = 16;
constexpr double printed_steps = 4;
/// Few printed digits may mean round numbers: points farther apart than this fraction of an edge are not merged.
constexpr double share_of_edge = 0.1;

double largest_coordinate(const TriMesh& surface) {
    double largest = 0;
    for (const Vec3& p : surface.points) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    return largest;
}

double mean_length(const TriMesh& surface, const std::vector<BorderEdge>& edges) {
    double sum = 0;
    for (const BorderEdge& edge : edges)
        sum += norm(surface.points[static_cast<std::size_t>(edge.to)] -
                    surface.points[static_cast<std::size_t>(edge.from)]);
    return sum / static_cast<double>(edges.size());
}

void join_points(SurfaceFile& file, const std::string& name) {
    const std::vector<BorderEdge> border = border_edges(file.mesh);
    const double largest = largest_coordinate(file.mesh);
    if (border.empty() || largest == 0) return;
    const double known = std::max(float_steps * float_step(largest), printed_steps * file.printed.step(largest));
    const double reach = std::min(known, share_of_edge * mean_length(file.mesh, border));
    const ClosedSeams closed = close_seams(file.mesh, reach);
    if (closed.points == 0) return;
    file.warnings.push_back(fmt::format(
        "{}: {} point(s) at open edges lay within {:.2g} of another, the file's own precision, and were joined to it",
        name, closed.points, reach));
}

void turn_shells(SurfaceFile& file, const std::string& name) {
    const TurnedShells turned = orient_by_nesting(file.mesh);
    if (turned.triangles > 0)
        file.warnings.push_back(
            fmt::format("{}: {} triangle(s) ran against their neighbours and were turned", name, turned.triangles));
    if (turned.inside_out > 0)
        file.warnings.push_back(
            fmt::format("{}: {} shell(s) inside out were turned outwards", name, turned.inside_out));
    if (turned.cavities > 0)
        file.warnings.push_back(fmt::format(
            "{}: {} shell(s) inside another one looked outwards and were turned into cavities; a solid inside a solid "
            "belongs in a file of its own",
            name, turned.cavities));
}

}  // namespace

void mend_surface(SurfaceFile& file, const std::string& name) {
    join_points(file, name);
    turn_shells(file, name);
}

}  // namespace pliant::mesh
