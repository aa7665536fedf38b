// How the forces of the elements change with the numbers of their laws and with their masses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "simulation/elements/elements.hpp"
#include "simulation/parts/description.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// forces (3n) += change of the internal forces at positions x (3n), as the constants of a material move along
/// `direction`.
void add_law_force(const Elements& elements, std::size_t material, const std::vector<double>& direction,
                   const Eigen::VectorXd& x, Eigen::VectorXd& forces);
/// The same with the constants of each tet changed by a column of `direction` (constants, tets).
void add_law_force(const Elements& elements, const Eigen::MatrixXd& direction, const Eigen::VectorXd& x,
                   Eigen::VectorXd& forces);
/// (most constants, tets) the product of the change with `weights` (3n), for each constant of each tet's own law; 0
/// where a law has fewer.
[[nodiscard]] Eigen::MatrixXd law_products(const Elements& elements, const Description& description,
                                           const Eigen::VectorXd& x, const Eigen::VectorXd& weights);

/// forces += K motion of the tets that have any of the `wanted` nodes (n), which is all of it at those. Precondition:
/// laws with an energy.
void add_tangent_product(const Elements& elements, const std::vector<bool>& wanted, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& motion, Eigen::VectorXd& forces);

/// What acts on masses.
struct Masses {
    std::vector<double> density_kg_m3;  ///< (materials)
    Eigen::Vector3d weight =
        Eigen::Vector3d::Zero();     ///< of the out-of-balance force for each kg: minus gravity, m/s^2
    Eigen::VectorXd acceleration{};  ///< (3n) that the mass matrix multiplies, m/s^2; empty at rest
};
/// (tets) by the density of each tet, the product of the forces on masses with `weights` (3n).
[[nodiscard]] Eigen::VectorXd density_products(const Elements& elements, const Masses& masses,
                                               const Eigen::VectorXd& weights);
/// forces (3n) += those forces where each tet has so much more density (tets).
void add_density_force(const Elements& elements, const Masses& masses, const Eigen::VectorXd& density,
                       Eigen::VectorXd& forces);
/// What acts on the masses of a state.
[[nodiscard]] Masses masses_at(const Description& description, const Controls& controls, const Eigen::VectorXd& x);

/// forces (3n) += the change of the internal forces and of those on masses with a motion (3n) of the rest positions.
/// With L the gradient of that motion, grad N_a changes by -L^T grad N_a, F by -F L and a volume by tr L of itself.
void add_rest_product(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& motion, Eigen::VectorXd& forces);
/// result (3n) += the transpose of that product with `weights` (3n) of the forces.
void add_rest_weights(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& weights, Eigen::VectorXd& result);

}  // namespace pliant::sim
