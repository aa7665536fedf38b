#include "simulation/gradient/friction_slips.hpp"

#include "base/linalg/vectors.hpp"
#include "simulation/contact/surface.hpp"

namespace pliant::sim {

Eigen::Vector2d slip_of_motion(const contact::FrozenPair& pair, const Eigen::VectorXd& motion) {
    Vec3 moved;
    for (int i = 0; i < pair.node_count; ++i)
        moved += pair.weights[i] * contact::node_at(linalg::view(motion), pair.nodes[i]);
    return {dot(pair.tangents[0], moved), dot(pair.tangents[1], moved)};
}

void add_to_nodes(const contact::Friction& friction, const Slips& slips, Eigen::VectorXd& nodes) {
    for (std::size_t k = 0; k < slips.size(); ++k) {
        const contact::FrozenPair& pair = friction.pairs()[k];
        const Vec3 along = slips[k][0] * pair.tangents[0] + slips[k][1] * pair.tangents[1];
        for (int i = 0; i < pair.node_count; ++i)
            nodes.segment<3>(3 * static_cast<Eigen::Index>(pair.nodes[i])) += pair.weights[i] * linalg::vector(along);
    }
}

}  // namespace pliant::sim
