// What a fit is worth: intervals, and which unknowns the data cannot tell apart.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pliant::sim::identify {

struct Confidence {
    Eigen::VectorXd half_width;   ///< (unknowns) 95 %, in u; not a number where there is none
    Eigen::MatrixXd correlation;  ///< (unknowns, unknowns); not a number likewise
    std::vector<bool> matters;    ///< (unknowns)
    /// Groups of unknowns of which only some combination is known.
    std::vector<std::vector<std::size_t>> mixed;
};

/// Of residuals r and their derivative J (residuals, unknowns) at the solution. `held`: unknowns at their bounds, which
/// count as known. An unknown does not matter where a change of 1 in u changes the residuals by less than `negligible`
/// of their units; nor does a residual that no unknown changes by so much, which does not count. Beyond a correlation
/// of 0.99, or where a singular value of J with columns of length 1 is below 1e-6 of the largest, unknowns are mixed.
[[nodiscard]] Confidence confidence(const Eigen::MatrixXd& J, const Eigen::VectorXd& r, const std::vector<bool>& held,
                                    double negligible);

}  // namespace pliant::sim::identify
