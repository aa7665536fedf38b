// Derivatives of the element forces with respect to material constants and masses.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "simulation/elements/elements.hpp"
#include "simulation/parts/description.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// (constants, tets) `direction` for the tets of a material, zero for the others.
[[nodiscard]] Eigen::MatrixXd constants_of_tets(const Elements& elements, std::size_t material,
                                                const std::vector<double>& direction);
/// forces (3n) += derivative of the internal forces at positions x (3n) with the constants of each tet along a column
/// of `direction` (constants, tets).
void add_law_force(const Elements& elements, const Eigen::MatrixXd& direction, const Eigen::VectorXd& x,
                   Eigen::VectorXd& forces);
/// (most constants, tets) product of that derivative with `weights` (3n), for each constant of each tet's own law; 0 if
/// a law has fewer.
[[nodiscard]] Eigen::MatrixXd law_products(const Elements& elements, const Description& description,
                                           const Eigen::VectorXd& x, const Eigen::VectorXd& weights);

/// forces += K motion for the tets that have any of the `wanted` nodes (n), which makes it complete at those nodes.
/// Precondition: laws with an energy.
void add_tangent_product(const Elements& elements, const std::vector<bool>& wanted, const Eigen::VectorXd& x,
                         const Eigen::VectorXd& motion, Eigen::VectorXd& forces);

/// Accelerations that act on masses.
struct Masses {
    std::vector<double> density_kg_m3;                 ///< (materials)
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();  ///< out-of-balance force per kg: minus gravity, m/s^2
    Eigen::VectorXd acceleration{};  ///< (3n) factor of the mass matrix, m/s^2; empty in a quasi-static step
};
/// (tets) derivative with respect to the density of each tet: product of the forces on masses with `weights` (3n).
[[nodiscard]] Eigen::VectorXd density_products(const Elements& elements, const Masses& masses,
                                               const Eigen::VectorXd& weights);
/// forces (3n) += change of those forces if the density of each tet increases by this much (tets).
void add_density_force(const Elements& elements, const Masses& masses, const Eigen::VectorXd& density,
                       Eigen::VectorXd& forces);
/// The accelerations that act on masses at a state.
[[nodiscard]] Masses masses_at(const Description& description, const Controls& controls, const Eigen::VectorXd& x);

/// forces (3n) += the change of the internal forces and of those on masses with a motion (3n) of the rest positions.
/// With L the gradient of that motion, grad N_a changes by -L^T grad N_a, F by -F L and the relative volume by tr L.
void add_rest_product(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& motion, Eigen::VectorXd& forces);
/// result (3n) += the transpose of that product with `weights` (3n) of the forces.
void add_rest_weights(const Elements& elements, const Masses& masses, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& weights, Eigen::VectorXd& result);

}  // namespace pliant::sim
