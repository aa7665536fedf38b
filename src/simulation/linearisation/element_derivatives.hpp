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

/// What acts on masses.
struct Masses {
    std::vector<double> density_kg_m3;  ///< (materials)
    Eigen::Vector3d weight =
        Eigen::Vector3d::Zero();     ///< of the out-of-balance force for each kg: minus gravity, m/s^2
    Eigen::VectorXd acceleration{};  ///< (3n) that the mass matrix multiplies, m/s^2; empty at rest
};
/// forces (3n) += the change of the internal forces and of those on masses with a motion (3n) of the rest positions.
/// With L the gradient of that motion, grad N_a changes by -L^T grad N_a, F by -F L and a volume by tr L of itself.
void add_rest_product(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& motion, Eigen::VectorXd& forces);
/// result (3n) += the transpose of that product with `weights` (3n) of the forces.
void add_rest_weights(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& weights, Eigen::VectorXd& result);

}  // namespace pliant::sim
