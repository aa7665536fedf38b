#include "simulation/actuators/spring.hpp"

#include <algorithm>
#include <cstddef>

#include "simulation/elements/node_blocks.hpp"

namespace pliant::sim {

SpringPath::SpringPath(const Spring& spring, std::span<const double> rest)
    : path_(spring.points, rest),
      stiffness_N_m_(spring.stiffness_N_m),
      free_length_m_(spring.free_length_m.value_or(path_.length(rest))),
      only_pulls_(spring.only_pulls) {}

double SpringPath::force(std::span<const double> x) const {
    const double pull = stiffness_N_m_ * (path_.length(x) - free_length_m_);
    return only_pulls_ ? std::max(pull, 0.0) : pull;
}

double SpringPath::energy(std::span<const double> x) const {
    const double pull = force(x);
    return pull * pull / (2 * stiffness_N_m_);
}

void SpringPath::add_gradient(std::span<const double> x, std::span<double> forces) const {
    path_.add_gradient(x, force(x), forces);
}

void SpringPath::add_hessian(std::span<const double> x, const std::vector<int>& free_index,
                             const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const {
    const double pull = force(x);
    if (only_pulls_ && !(pull > 0)) return;
    if (pull > 0 || !project) path_.add_hessian(x, pull, free_index, pattern, values);
    const std::vector<CablePath::NodeGradient> gradient = path_.gradient(x);
    for (const auto& [column, g] : gradient) {
        const int j = free_index[static_cast<std::size_t>(column)];
        if (j < 0) continue;
        for (const auto& [row, h] : gradient) {
            const int i = free_index[static_cast<std::size_t>(row)];
            if (i < j) continue;
            pattern.add_block(values, i, j, [&, &h = h, &g = g](int r, int c) {
                return stiffness_N_m_ * h[static_cast<std::size_t>(r)] * g[static_cast<std::size_t>(c)];
            });
        }
    }
}

void SpringPath::append_clique(const std::vector<int>& free_index, linalg::Lists& cliques) const {
    append_node_clique(path_.nodes(), free_index, cliques);
}

}  // namespace pliant::sim
