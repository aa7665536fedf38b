// Uncertainty of a fit: confidence intervals, and which unknowns the data cannot tell apart.
#pragma once

#include <Eigen/Core>
#include <set>
#include <string>
#include <vector>

namespace pliant::sim::identify {

struct Confidence {
    Eigen::VectorXd half_width;   ///< (unknowns) of the 95 % interval, in u; NaN if there is none
    Eigen::MatrixXd correlation;  ///< (unknowns, unknowns); NaN likewise
    std::vector<bool> matters;    ///< (unknowns)
    /// Groups of unknowns of which only a combination is determined.
    std::vector<std::vector<std::size_t>> mixed;
    /// Groups of residuals that some unknown rests on, with less than one value to spare: their noise is not known.
    std::set<int> unclear;
};

/// (unknowns) whether a change of 1 in u changes the residuals by more than `negligible` of their units.
[[nodiscard]] std::vector<bool> which_matter(const Eigen::MatrixXd& J, double negligible);

/// For residuals r and their derivative J (residuals, unknowns) at the solution. `held`: unknowns at their bounds,
/// taken as known. An unknown does not matter if a change of 1 in u changes the residuals by less than `negligible` of
/// their units; a residual that no unknown changes by that much is not counted. Unknowns are mixed if their correlation
/// exceeds 0.99, or if a singular value of J with columns normalised to 1 is below 1e-6 of the largest. `groups`: for
/// each residual a group with noise of its own; empty: all are one group.
[[nodiscard]] Confidence confidence(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, const std::vector<bool>& held,
                                    double negligible, const std::vector<int>& groups = {});

}  // namespace pliant::sim::identify
