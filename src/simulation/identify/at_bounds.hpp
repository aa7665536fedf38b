// Unknowns that end at a bound: how far from it the data allow them, and what that leaves open for the others.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant::sim::identify {

/// Where an unknown ended, in its coordinate.
struct End {
    int inward = 0;   ///< 0: within its bounds; 1: at its lower bound, -1: at its upper one
    double room = 0;  ///< distance to the other bound, which may be infinite
};

struct AtBounds {
    /// (unknowns) how far into its range the data allow an unknown at its bound to be; 0 for the others, and where the
    /// data exclude all of the range; NaN if they give no interval.
    Eigen::VectorXd reach;
    /// (unknowns) by how much the intervals of the others grow at each end if those at bounds move that far.
    Eigen::VectorXd below, above;
    /// Groups of unknowns, with one at a bound among them, of which only a combination is determined.
    std::vector<std::vector<std::size_t>> mixed;
};

/// For residuals r and their derivative J (residuals, unknowns) at the solution. The linear problem without bounds has
/// its minimum beyond them; what its 95 % interval keeps inside of a bound is the reach. Without an interval the others
/// grow as if all of the room were open. A move from a bound moves the others to where they fit best. `negligible`,
/// `groups`: as for confidence().
[[nodiscard]] AtBounds at_bounds(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, const std::vector<End>& ends,
                                 double negligible, const std::vector<int>& groups = {});

}  // namespace pliant::sim::identify
