// Proper orthogonal decomposition (Sirovich 1987): the few motions of which known motions are made.
#pragma once

#include <Eigen/Core>

namespace pliant::sim::reduced {

/// `snapshots` (size, count), a motion each. Orthonormal columns (size, modes), the most important first: as few as
/// leave out at most `error` of all snapshots, in the 2-norm of all entries, and at most `most`. At least one, unless
/// all snapshots are zero.
[[nodiscard]] Eigen::MatrixXd snapshot_basis(const Eigen::MatrixXd& snapshots, double error, int most);

}  // namespace pliant::sim::reduced
