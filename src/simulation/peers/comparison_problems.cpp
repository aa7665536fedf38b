#include "simulation/peers/comparison_problems.hpp"

#include <cmath>

#include "simulation/actuators/attach.hpp"
#include "simulation/actuators/cable_path.hpp"
#include "simulation/actuators/chamber_surface.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/elements/actuated_space.hpp"
#include "simulation/peers/reference_problems.hpp"

namespace pliant::sim::comparison {
namespace {

using reference::kuhn_box;
using reference::mean_of;
using reference::nodes_where;

constexpr double mm = 1e-3;
constexpr double tiny = 1e-9;

std::function<bool(Vec3)> beyond_x(double x) {
    return [x](Vec3 p) { return p.x > x - tiny; };
}

Support clamp(const mesh::TetMesh& mesh) {
    return {"clamp", nodes_where(mesh, [](Vec3 p) { return p.x < tiny; }), {}};
}

std::vector<double> flat(const std::vector<Vec3>& points) {
    std::vector<double> x;
    x.reserve(3 * points.size());
    for (const Vec3& p : points) x.insert(x.end(), {p.x, p.y, p.z});
    return x;
}

// The finger's notches: one column of cells in every five, empty above a third of the height and widened to the top.
constexpr int notches = 4;
constexpr int cells_per_notch = 5;
constexpr double pitch = 15 * mm;
constexpr double height = 9 * mm;
constexpr double notch_floor = 3 * mm;
constexpr double cable_z = 6 * mm;
constexpr double flare = 1.4 * mm;  ///< of each flank, from floor to top

/// Maps from the box with cells of equal width.
Vec3 to_finger(Vec3 p) {
    const double cell = pitch / cells_per_notch;
    const int line = static_cast<int>(std::lround(p.x / cell));
    const int notches_before = line / cells_per_notch;
    const double start = pitch * notches_before;
    const double third = pitch / 4.5;  // four wide cells and a notch of half their width
    const double x[cells_per_notch] = {0, third, 2 * third, 2.5 * third, 3.5 * third};
    const double open = std::max(0.0, (p.z - notch_floor) / (height - notch_floor)) * flare;
    const int k = line % cells_per_notch;
    return {start + x[k] + (k == 2 ? -open : 0) + (k == 3 ? open : 0), p.y, p.z};
}

/// Region 0: the finger, region 1: its notches.
mesh::TetMesh finger_mesh() {
    const double cell = pitch / cells_per_notch;
    const auto region = [&](Vec3 c) {
        return static_cast<int>(c.x / cell) % cells_per_notch == 2 && c.z > notch_floor ? 1 : 0;
    };
    mesh::TetMesh whole = kuhn_box({notches * pitch, 6 * mm, height}, notches * cells_per_notch, 2, 6, region);
    for (Vec3& p : whole.points) p = to_finger(p);
    return whole;
}

Cable finger_cable(const mesh::TetMesh& mesh, const CableTarget& target) {
    Cable cable{"cable", {}, target};
    const double cell = pitch / cells_per_notch;
    const auto guide = [&](int line) {
        const Vec3 at = to_finger({line * cell, 3 * mm, cable_z});
        cable.points.push_back({nodes_where(mesh, [&](Vec3 p) { return norm(p - at) < tiny; }), {1.0}, {}});
    };
    guide(0);
    for (int n = 0; n < notches; ++n) {
        guide(n * cells_per_notch + 2);
        guide(n * cells_per_notch + 3);
    }
    guide(notches * cells_per_notch);
    return cable;
}

/// Region 1 of `whole` becomes empty space (removed), or elements whose target shape actuator 0 scales.
void set_bodies(Description& d, mesh::Extract solid, const material::Law& law, Drive drive, const Growth& growth) {
    d.mesh = std::move(solid.mesh);
    d.materials = {{"rubber", law, 0}};
    d.material_of_region = {0};
    if (drive == Drive::constraint) return;
    const double softest = material::youngs_modulus(material::moduli(law));
    const bool is_gap = growth.length_m > 0;
    d.materials.push_back({"space", is_gap ? gap_law(softest) : air_law(softest, default_air_weight), 0});
    d.material_of_region.push_back(1);
    d.growths = {growth};
    d.growths[0].weight_Pa = (is_gap ? default_gap_weight : default_air_weight) * softest;
}

}  // namespace

Description bar(int order, const material::Law& hard, const material::Law& soft, double strain) {
    const double length = 100 * mm;
    Description d;
    d.mesh = kuhn_box({length, 10 * mm, 10 * mm}, 12, 2, 2, [&](Vec3 c) { return c.x < length / 2 ? 0 : 1; });
    const auto interface = nodes_where(d.mesh, [&](Vec3 p) { return std::fabs(p.x - length / 2) < tiny; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"hard", hard, 0}, {"soft", soft, 0}};
    d.material_of_region = {0, 1};
    d.supports = {clamp(d.mesh), {"grip", nodes_where(d.mesh, beyond_x(length)), {strain * length, 0, 0}}};
    d.markers = {{"tip", mean_of(interface)}};
    return d;
}

Description beam(int order, const material::Law& law, int cells) {
    const double length = 100 * mm;
    Description d;
    d.mesh = kuhn_box({length, 5 * mm, 5 * mm}, cells, 2, 2, [](Vec3) { return 0; });
    const auto end = nodes_where(d.mesh, beyond_x(length));
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"rubber", law, 0}};
    d.material_of_region = {0};
    d.supports = {clamp(d.mesh)};
    std::vector<mesh::Face> faces;
    for (const mesh::Face& f : mesh::boundary_faces(d.mesh)) {
        const auto& p = d.mesh.points;
        if (p[f.nodes[0]].x + p[f.nodes[1]].x + p[f.nodes[2]].x > 3 * length - tiny) faces.push_back(f);
    }
    const SurfaceShares shares = surface_shares(d.mesh, faces);
    d.loads = {{"push", shares.nodes, shares.shares, {0, 0, 0.06}}};
    d.markers = {{"tip", mean_of(end)}};
    return d;
}

Description cable_finger(int order, const material::Law& law, const CableTarget& target, Drive drive) {
    mesh::TetMesh whole = finger_mesh();
    const auto at_end = beyond_x(notches * pitch);
    mesh::Extract linear = mesh::extract_regions(whole, {true, drive == Drive::elements});
    const auto end = nodes_where(linear.mesh, at_end);
    if (order == 2) linear.mesh = mesh::to_quadratic(linear.mesh);
    Description d;
    const double notch_m = to_finger({3 * pitch / 5, 0, cable_z}).x - to_finger({2 * pitch / 5, 0, cable_z}).x;
    set_bodies(d, std::move(linear), law, drive, {1, {1, 0, 0}, 0, 0, notches * notch_m, {0, 3 * mm, cable_z}});
    d.supports = {clamp(d.mesh)};
    d.cables = {finger_cable(d.mesh, target)};
    d.markers = {{"tip", mean_of(end)}};
    return d;
}

Description air_block(int order, const material::Law& law, const ChamberTarget& target, Drive drive) {
    const auto region = [](Vec3 c) {
        const bool inside =
            c.x > 5 * mm && c.x < 25 * mm && c.y > 2.5 * mm && c.y < 7.5 * mm && c.z > 2 * mm && c.z < 6 * mm;
        return inside ? 1 : 0;
    };
    mesh::TetMesh whole = kuhn_box({30 * mm, 10 * mm, 10 * mm}, 6, 4, 5, region);
    const auto corners = whole.points.size();
    if (order == 2) whole = mesh::to_quadratic(whole);
    mesh::Extract solid = mesh::extract_regions(whole, {true, drive == Drive::elements});
    Description d;
    d.chambers = {{"air", wall_of_faces(whole, mesh::region_faces(whole, 1), solid.node), target}};
    std::vector<int> end;
    for (std::size_t n = 0; n < corners; ++n) {
        if (whole.points[n].x > 30 * mm - tiny) end.push_back(solid.node[n]);
    }
    set_bodies(d, std::move(solid), law, drive, {1, {}, 0, 0, 0, {}});
    d.supports = {clamp(d.mesh)};
    d.markers = {{"tip", mean_of(end)}};
    return d;
}

double cable_length(const Description& description, const std::vector<Vec3>& positions) {
    return CablePath(description.cables.at(0).points, flat(description.mesh.points)).length(flat(positions));
}

double chamber_volume(const Description& description, const std::vector<Vec3>& positions) {
    return ChamberSurface(description.chambers.at(0).wall, flat(description.mesh.points)).volume(flat(positions));
}

std::vector<Vec3> moved(const mesh::TetMesh& mesh, const std::vector<Vec3>& displacement) {
    std::vector<Vec3> positions = mesh.points;
    for (std::size_t n = 0; n < positions.size(); ++n) positions[n] += displacement[n];
    return positions;
}

Vec3 tip_displacement(const Description& description, const Step& step) {
    return step.markers.at(0).position_m - position(description.markers.at(0).point, flat(description.mesh.points));
}

}  // namespace pliant::sim::comparison
