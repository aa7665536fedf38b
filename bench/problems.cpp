#include "problems.hpp"

#include <numeric>

#include "geometry/files/tet_file.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/elements/actuated_space.hpp"
#include "simulation/peers/reference_problems.hpp"

namespace pliant::bench {

using namespace pliant::sim;

Description two_material_bend(double nu, int order, int cells_along, int cells_across) {
    Description d;
    d.mesh = reference::kuhn_box({0.1, 0.01, 0.01}, cells_along, cells_across, cells_across,
                                 [](Vec3 c) { return c.x < 0.05 ? 0 : 1; });
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"hard", material::neo_hookean(45e6, nu), 0}, {"soft", material::neo_hookean(12e6, nu), 0}};
    d.material_of_region = {0, 1};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    std::vector<mesh::Face> faces;
    for (const mesh::Face& f : mesh::boundary_faces(d.mesh)) {
        const auto& p = d.mesh.points;
        if (p[f.nodes[0]].x + p[f.nodes[1]].x + p[f.nodes[2]].x > 0.3 - 1e-9) faces.push_back(f);
    }
    const SurfaceShares shares = surface_shares(d.mesh, faces);
    d.loads = {{"tip", shares.nodes, shares.shares, {0, 0, 5}}};
    d.markers = {{"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.1 - 1e-9; }))}};
    return d;
}

Description cable_bar(int order) {
    Description d = two_material_bend(0.45, order);
    d.loads.clear();
    Cable cable{"flexor", {}, {CableTarget::Kind::length_ratio, 0.8}};
    for (int k = 0; k <= 8; ++k) {
        const Vec3 at{0.0125 * k, 0.004, 0.01};
        const auto nodes = reference::nodes_where(d.mesh, [&](Vec3 p) { return norm(p - at) < 1e-9; });
        if (!nodes.empty()) cable.points.push_back({nodes, {1.0}, {}});
    }
    d.cables = {cable};
    return d;
}

namespace {

/// Regions: solid and air.
mesh::TetMesh air_bar_mesh(int order) {
    mesh::TetMesh whole = reference::kuhn_box({0.06, 0.012, 0.012}, 36, 6, 6, [](Vec3 c) {
        const bool inside = c.x > 0.01 && c.x < 0.05 && c.y > 0.004 && c.y < 0.008 && c.z > 0.002 && c.z < 0.006;
        return inside ? 1 : 0;
    });
    whole.region_names = {"solid", "air"};
    return order == 2 ? mesh::to_quadratic(whole) : whole;
}

void add_clamp_and_tip(Description& d) {
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.markers = {{"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.06 - 1e-9; }))}};
}

}  // namespace

Description air_bar(int order) {
    const mesh::TetMesh whole = air_bar_mesh(order);
    mesh::Extract solid = mesh::extract_regions(whole, {true, false});
    Description d;
    d.chambers.push_back({"air", wall_of_faces(whole, mesh::region_faces(whole, 1), solid.node), {}});
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.5};
    d.mesh = std::move(solid.mesh);
    d.materials = {{"rubber", material::neo_hookean(1e6, 0.45), 0}};
    d.material_of_region = {0};
    add_clamp_and_tip(d);
    return d;
}

Description thesis_gap_bar() {
    const double length = 0.1, notch = 0.004, floor = 0.005, cable_z = 0.01375, weight_Pa = 45e6;
    Description d;
    d.mesh = reference::kuhn_box({length, 0.02, 0.015}, 25, 4, 12, [&](Vec3 c) {
        const bool in_notch = static_cast<int>(c.x / notch) % 5 == 2 && c.z > floor;
        return in_notch ? 2 : c.x < length / 2 ? 0 : 1;
    });
    const material::ShapeBlend rigid{weight_Pa, 1}, soft{weight_Pa, 1 / material::shape_parameter_of_thesis(45.0 / 12)};
    const double softest_Pa = material::youngs_modulus(material::moduli(soft));
    d.materials = {{"rigid", rigid, 0}, {"soft", soft, 0}, {"gap", gap_law(softest_Pa), 0}};
    d.material_of_region = {0, 1, 2};
    d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    d.markers = {
        {"tip", reference::mean_of(reference::nodes_where(d.mesh, [&](Vec3 p) { return p.x > length - 1e-9; }))}};
    Cable cable{"flexor", {}, {CableTarget::Kind::length_ratio, 0.88}};
    for (int k = 0; k <= 25; ++k) {
        const Vec3 at{notch * k, 0.01, cable_z};
        if (k != 0 && k != 25 && k % 5 != 2 && k % 5 != 3) continue;
        cable.points.push_back(
            {reference::nodes_where(d.mesh, [&](Vec3 p) { return norm(p - at) < 1e-9; }), {1.0}, {}});
    }
    d.cables = {cable};
    d.growths = {{2, {1, 0, 0}, 0, default_gap_weight * softest_Pa, 5 * notch, {0, 0.01, cable_z}}};
    return d;
}

Description thesis_air_bar() {
    Description d;
    d.mesh = air_bar_mesh(1);
    std::vector<int> same(d.mesh.points.size());
    std::iota(same.begin(), same.end(), 0);
    d.chambers.push_back({"air", wall_of_faces(d.mesh, mesh::region_faces(d.mesh, 1), same), {}});
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.5};
    const material::ShapeBlend soft{45e6, 1 / material::shape_parameter_of_thesis(45.0 / 12)};
    const double softest_Pa = material::youngs_modulus(material::moduli(soft));
    d.materials = {{"rubber", soft, 0}, {"air", air_law(softest_Pa, default_air_weight), 0}};
    d.material_of_region = {0, 1};
    d.growths = {{1, {}, 0, default_air_weight * softest_Pa, 0, {}}};
    add_clamp_and_tip(d);
    return d;
}

Description finger_7k(const std::string& reference_data) {
    Description d;
    d.mesh = *mesh::read_tet_mesh(reference_data + "/softrobots/cable_finger/finger_7k.vtk");
    for (Vec3& p : d.mesh.points) p = 1e-3 * p;
    d.materials = {{"silicone", material::neo_hookean(6e5, 0.45), 0}};
    d.material_of_region.assign(d.mesh.region_names.size(), 0);
    const double edge = 1e-6;
    d.supports = {
        {"base", reference::nodes_where(d.mesh, [&](Vec3 p) { return p.x > -0.015 - edge && p.y < 0.01 + edge; }), {}}};
    Cable cable{"flexor", {{{}, {}, {0, 0.0125, 0.0025}}}, {CableTarget::Kind::shortening_m, 0.04}};
    const Attacher attacher(d.mesh);
    const double guides[][2] = {{-17.5, 2.5},  {-32.5, 2.5},  {-47.5, 2.5},  {-62.5, 2.5},  {-77.5, 2.5},
                                {-83.5, 4.5},  {-85.5, 6.5},  {-85.5, 8.5},  {-83.5, 10.5}, {-77.5, 12.5},
                                {-62.5, 12.5}, {-47.5, 12.5}, {-32.5, 12.5}, {-17.5, 12.5}};
    for (const auto& [x, z] : guides)
        cable.points.push_back(*attacher.carried_by_tet({1e-3 * x, 0.0125, 1e-3 * z}, 1e-4));
    d.cables = {cable};
    d.markers = {{"tip", reference::mean_of(reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < -0.1033; }))}};
    return d;
}

Description notched_finger(const std::string& reference_data, int order, const CableTarget& target) {
    const reference::NamedMesh named = reference::load_tet(reference_data + "/fem/finger_p1_8563.tet", 1e-3);
    Description d;
    d.mesh = order == 2 ? mesh::to_quadratic(named.mesh) : named.mesh;
    d.materials = {{"rubber", material::neo_hookean(45e6, 0.45), 0}};
    d.material_of_region.assign(d.mesh.region_names.size(), 0);
    d.supports = {{"L", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
    Cable cable{"cable", {}, target};
    for (const int node : named.sets.at("cable")) cable.points.push_back({{node}, {1.0}, {}});
    d.cables = {cable};
    d.markers = {{"tip", reference::mean_of(named.sets.at("tip"))}};
    return d;
}

}  // namespace pliant::bench
