#include "simulation/reduced/sampled_robot.hpp"

#include <algorithm>
#include <utility>

namespace pliant::sim::reduced {
namespace {

/// Calls `visit(Attachment&)` with everything that is attached to nodes.
template <class Visit>
void visit_attachments(Description& d, const Visit& visit) {
    const auto all = [&](std::vector<Attachment>& list) { std::ranges::for_each(list, visit); };
    for (PressureLoad& load : d.pressures) all(load.wall.points);
    for (Cable& cable : d.cables) all(cable.points);
    for (Chamber& chamber : d.chambers) all(chamber.wall.points);
    for (Spring& spring : d.springs) all(spring.points);
    for (PointMass& mass : d.masses) visit(mass.point);
    for (Marker& marker : d.markers) visit(marker.point);
    for (Load& load : d.loads) {
        Attachment spread{load.nodes, load.shares, {}};
        visit(spread);
        load.nodes = spread.nodes;
        load.shares = spread.weights;
    }
}

/// Calls `visit(int&)` with the nodes that act together without being one point.
template <class Visit>
void visit_nodes(Description& d, const Visit& visit) {
    for (TorqueLoad& load : d.torques) std::ranges::for_each(load.nodes, visit);
    for (RigidPlate& plate : d.plates) std::ranges::for_each(plate.nodes, visit);
}

void take_tets(const Description& d, const std::vector<Weight>& tets, Description& sampled) {
    sampled.mesh.order = d.mesh.order;
    sampled.mesh.region_names = d.mesh.region_names;
    for (const Weight& tet : tets) {
        const std::span<const int> nodes = d.mesh.tet(tet.column);
        sampled.mesh.nodes.insert(sampled.mesh.nodes.end(), nodes.begin(), nodes.end());
        sampled.mesh.region.push_back(d.mesh.region[tet.column]);
        if (!d.material_of_tet.empty()) sampled.material_of_tet.push_back(d.material_of_tet[tet.column]);
        sampled.tet_weights.push_back(tet.weight);
    }
}

}  // namespace

Status check_reducible(const Description& d) {
    const auto no = [](std::string_view what) {
        return input_error("a reduced model has no {}: it is made of equilibria without contact", what);
    };
    if (d.moves_in_time) return no("motion in time");
    if (!d.objects.empty()) return no("[[object]]");
    if (!d.joints.empty()) return no("[[joint]]");
    if (d.fluid) return no("[fluid]");
    if (d.contact && !d.contact->self_when_met) return no("[contact]");
    if (d.contact && !d.contact->obstacles.empty()) return no("[[obstacle]]");
    if (!d.growths.empty()) return no("actuators of the thesis' model (gap and air elements)");
    for (const Support& support : d.supports)
        if (support.moves())
            return input_error("a reduced model has no support that moves, such as \"{}\"", support.name);
    for (const Cable& cable : d.cables)
        if (cable.friction > 0)
            return input_error("a reduced model has no friction of cables, such as \"{}\"", cable.name);
    return {};
}

SampledRobot sampled_robot(const Description& d, const std::vector<Weight>& tets) {
    SampledRobot sampled;
    Description& part = sampled.description;
    part.materials = d.materials;
    part.material_of_region = d.material_of_region;
    part.loads = d.loads;
    part.torques = d.torques;
    part.pressures = d.pressures;
    part.cables = d.cables;
    part.chambers = d.chambers;
    part.springs = d.springs;
    part.plates = d.plates;
    part.masses = d.masses;
    part.markers = d.markers;
    part.gravity_m_s2 = d.gravity_m_s2;
    part.gravity_share = d.gravity_share;
    part.ambient_pressure_Pa = d.ambient_pressure_Pa;
    part.may_be_free = true;  // the basis knows what is held
    take_tets(d, tets, part);

    // Nodes that are used as they are keep their order.
    std::vector<int> index(d.mesh.points.size(), -1);
    const auto use = [&](int node) { index[static_cast<std::size_t>(node)] = 0; };
    std::ranges::for_each(part.mesh.nodes, use);
    visit_nodes(part, use);
    visit_attachments(part, [&](const Attachment& point) {
        if (point.nodes.size() == 1) use(point.nodes[0]);
    });
    const auto add = [&](Attachment moves_with, const Vec3& position) {
        part.mesh.points.push_back(position);
        sampled.nodes.push_back(std::move(moves_with));
        return static_cast<int>(sampled.nodes.size()) - 1;
    };
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] >= 0) index[node] = add({{static_cast<int>(node)}, {1.0}, {}}, d.mesh.points[node]);
    }
    const auto renumber = [&](int& node) { node = index[static_cast<std::size_t>(node)]; };
    std::ranges::for_each(part.mesh.nodes, renumber);
    visit_nodes(part, renumber);
    // What is attached to many nodes gets one of its own: the mean, which then moves with the mean of the modes.
    visit_attachments(part, [&](Attachment& point) {
        if (point.nodes.size() == 1) return renumber(point.nodes[0]);
        if (point.nodes.empty()) return;  // fixed in space
        Vec3 mean;
        for (std::size_t k = 0; k < point.nodes.size(); ++k)
            mean += point.weights[k] * d.mesh.points[static_cast<std::size_t>(point.nodes[k])];
        const int node = add(point, mean);
        point = {{node}, {1.0}, {}};
    });
    return sampled;
}

}  // namespace pliant::sim::reduced
