#include "simulation/gradient/friction_slips.hpp"

#include <array>

#include "base/linalg/vectors.hpp"
#include "simulation/contact/surface.hpp"
#include "simulation/linearisation/contact_forces.hpp"

namespace pliant::sim {
namespace {

bool is_of_object(const Equilibrium& system, const contact::FrozenPair& pair) {
    return touches_object(system, {pair.nodes.data(), static_cast<std::size_t>(pair.node_count)});
}

}  // namespace

Slips slips_of_motion(const Equilibrium& system, const contact::Friction& friction, const Eigen::VectorXd& motion) {
    const std::array<std::vector<double>, 2> moved = {contact_motion(system, motion, false),
                                                      contact_motion(system, motion, true)};
    Slips slips;
    for (const contact::FrozenPair& pair : friction.pairs()) {
        const std::vector<double>& nodes = moved[is_of_object(system, pair) ? 1 : 0];
        Vec3 way;
        for (int i = 0; i < pair.node_count; ++i) way += pair.weights[i] * contact::node_at(nodes, pair.nodes[i]);
        slips.emplace_back(dot(pair.tangents[0], way), dot(pair.tangents[1], way));
    }
    return slips;
}

void add_to_forces(const Equilibrium& system, const contact::Friction& friction, const Slips& slips,
                   Eigen::VectorXd& forces) {
    const std::vector<double> none(friction.start().size(), 0.0);
    std::array<std::vector<double>, 2> on_nodes = {none, none};
    for (std::size_t k = 0; k < slips.size(); ++k) {
        const contact::FrozenPair& pair = friction.pairs()[k];
        const Vec3 along = slips[k][0] * pair.tangents[0] + slips[k][1] * pair.tangents[1];
        std::vector<double>& nodes = on_nodes[is_of_object(system, pair) ? 1 : 0];
        for (int i = 0; i < pair.node_count; ++i) {
            const auto first = 3 * static_cast<std::size_t>(pair.nodes[i]);
            for (std::size_t c = 0; c < 3; ++c) nodes[first + c] += pair.weights[i] * along[c];
        }
    }
    add_contact_forces(system, on_nodes[0], false, forces);
    if (system.model().object_points().count() > 0) add_contact_forces(system, on_nodes[1], true, forces);
}

}  // namespace pliant::sim
