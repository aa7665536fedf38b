// Exchanges vectors between the ranks that share nodes.
#pragma once

#include <petscvec.h>

#include <Eigen/Core>

#include "simulation/distributed/petsc.hpp"
#include "simulation/distributed/ranks.hpp"
#include "simulation/distributed/share.hpp"

namespace pliant::sim::distributed {

/// Vectors are over the local nodes of a rank (3n), or over the owned ones (3 owned), which are the first of them; the
/// others are ghosts. All functions are collective.
class NodeExchange {
public:
    NodeExchange(const Ranks& ranks, const Share& share);

    /// (3n) -> (3 owned): sums of the contributions of all ranks.
    [[nodiscard]] Eigen::VectorXd add_up(const Eigen::VectorXd& local) const;
    /// (3 owned) -> (3n): the values of the owners, with the same bits on all ranks.
    [[nodiscard]] Eigen::VectorXd with_ghosts(const Eigen::VectorXd& owned) const;
    /// Of vectors (3 owned).
    [[nodiscard]] double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
    [[nodiscard]] double norm(const Eigen::VectorXd& a) const;

    [[nodiscard]] const Ranks& ranks() const { return ranks_; }
    [[nodiscard]] Eigen::Index local() const { return 3 * local_; }
    [[nodiscard]] Eigen::Index owned() const { return 3 * owned_; }

private:
    Ranks ranks_;
    Eigen::Index local_ = 0, owned_ = 0;        ///< nodes
    Owned<Vec, VecDestroy> on_all_, on_own_;    ///< owned nodes of all ranks; local nodes of this one
    Owned<VecScatter, VecScatterDestroy> way_;  ///< from the first to the second
};

}  // namespace pliant::sim::distributed
