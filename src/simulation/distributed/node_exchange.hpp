// Between what each rank knows of its nodes and what belongs to it.
#pragma once

#include <petscvec.h>

#include <Eigen/Core>

#include "simulation/distributed/petsc.hpp"
#include "simulation/distributed/ranks.hpp"
#include "simulation/distributed/share.hpp"

namespace pliant::sim::distributed {

/// Vectors come in two kinds: over all nodes that a rank knows (3n), and over those that belong to it (3 owned), which
/// are the first of them. All functions are collective.
class NodeExchange {
public:
    NodeExchange(const Ranks& ranks, const Share& share);

    /// (3n) -> (3 owned): the sums over all ranks of what each has found for its nodes.
    [[nodiscard]] Eigen::VectorXd add_up(const Eigen::VectorXd& known) const;
    /// (3 owned) -> (3n): what the owners say, the same bits on all ranks that know a node.
    [[nodiscard]] Eigen::VectorXd spread(const Eigen::VectorXd& owned) const;
    /// Of vectors over owned nodes.
    [[nodiscard]] double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
    [[nodiscard]] double norm(const Eigen::VectorXd& a) const;

    [[nodiscard]] const Ranks& ranks() const { return ranks_; }
    [[nodiscard]] Eigen::Index known() const { return 3 * known_; }
    [[nodiscard]] Eigen::Index owned() const { return 3 * owned_; }

private:
    Ranks ranks_;
    Eigen::Index known_ = 0, owned_ = 0;        ///< nodes
    Owned<Vec, VecDestroy> on_all_, on_own_;    ///< of the owned nodes of all ranks, and of the known ones of this
    Owned<VecScatter, VecScatterDestroy> way_;  ///< from the first to the second
};

}  // namespace pliant::sim::distributed
