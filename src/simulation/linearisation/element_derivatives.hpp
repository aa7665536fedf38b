// How the forces of the elements change with the numbers of their laws and with their masses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "simulation/elements/elements.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// forces (3n) += change of the internal forces at positions x (3n), as the constants of a material move along
/// `direction`.
void add_law_force(const Elements& elements, std::size_t material, const std::vector<double>& direction,
                   const Eigen::VectorXd& x, Eigen::VectorXd& forces);
/// (materials, constants) its product with `weights` (3n), for each constant of each law.
[[nodiscard]] std::vector<std::vector<double>> law_products(const Elements& elements, const Description& description,
                                                            const Eigen::VectorXd& x, const Eigen::VectorXd& weights);

/// (m) m^3 of the tets of a material; 0 of all others.
[[nodiscard]] std::vector<double> tet_volumes(const Elements& elements, std::size_t material);
/// forces (3n) += the weight of a material of 1 kg/m^3 under an acceleration.
void add_weight(const Elements& elements, std::size_t material, const Eigen::Vector3d& acceleration,
                Eigen::VectorXd& forces);

}  // namespace pliant::sim
