#include "simulation/solver/held_multipliers.hpp"

#include <algorithm>
#include <cmath>

#include "base/linalg/dense.hpp"

namespace pliant::sim {

Eigen::VectorXd multipliers_that_hold(const Eigen::MatrixXd& S, const Eigen::VectorXd& b,
                                      const std::vector<bool>& only_pull) {
    const Eigen::Index count = b.size();
    Eigen::VectorXd m = Eigen::VectorXd::Zero(count);
    std::vector<Eigen::Index> active;
    for (Eigen::Index i = 0; i < count; ++i) {
        if (!only_pull[static_cast<std::size_t>(i)]) active.push_back(i);
    }
    // Parallel cables make the matrix singular, and pressed patches unsymmetric: the shortest solution.
    const auto solved = [&] { return linalg::shortest_least_squares(S(active, active), b(active)); };
    if (!active.empty()) m(active) = solved();
    const double rounding = 1e-13 * (b.cwiseAbs().maxCoeff() + 1e-300);
    for (Eigen::Index round = 0; round < 3 * count + 3; ++round) {
        const Eigen::VectorXd violation = b - S * m;
        Eigen::Index worst = -1;
        for (Eigen::Index i = 0; i < count; ++i) {
            const bool slack = std::find(active.begin(), active.end(), i) == active.end();
            if (slack && violation[i] > rounding && (worst < 0 || violation[i] > violation[worst])) worst = i;
        }
        if (worst < 0) break;
        active.push_back(worst);
        while (!active.empty()) {
            const Eigen::VectorXd wanted = solved();
            double share = 1;  // of the way from m to wanted that keeps every tension positive
            for (std::size_t k = 0; k < active.size(); ++k) {
                const double from = m[active[k]];
                const double to = wanted[static_cast<Eigen::Index>(k)];
                if (only_pull[static_cast<std::size_t>(active[k])] && to <= 0)
                    share = std::min(share, from / (from - to));
            }
            for (std::size_t k = 0; k < active.size(); ++k)
                m[active[k]] += share * (wanted[static_cast<Eigen::Index>(k)] - m[active[k]]);
            if (share == 1) break;
            const double zero = 1e-14 * m.cwiseAbs().maxCoeff();
            std::erase_if(active, [&](Eigen::Index i) {
                return only_pull[static_cast<std::size_t>(i)] && m[i] <= zero ? (m[i] = 0, true) : false;
            });
        }
    }
    return m;
}

}  // namespace pliant::sim
