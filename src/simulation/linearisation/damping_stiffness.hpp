// A motion in time is damped by beta K u, where K is Elements::add_strain_stiffness and u the velocity: the derivatives
// of that force with everything that K depends on. Elsewhere K is held fixed.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "simulation/elements/elements.hpp"
#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// A step that is damped by stiffness.
struct DampedStep {
    const Elements* elements;
    Eigen::VectorXd place;     ///< (3n) positions at which K is taken, Inertia::damped_positions
    Eigen::VectorXd velocity;  ///< (3n) u, m/s
    double factor = 0;         ///< beta, s
};
/// Empty for a static step, and for one without damping by stiffness.
[[nodiscard]] std::optional<DampedStep> damped_step(const Linearisation& at);

/// forces (3n) += change of the damping force with a motion (3n) of the positions at which K is taken.
void add_damping_place_product(const DampedStep& step, const Eigen::VectorXd& motion, Eigen::VectorXd& forces);
/// (3n) the transpose of the same, times `weights` (3n) of the forces.
[[nodiscard]] Eigen::VectorXd damping_place_weights(const DampedStep& step, const Eigen::VectorXd& weights);

/// forces (3n) += change of the damping force with the constants of each tet: a column of `direction` (constants,
/// tets).
void add_damping_law_force(const DampedStep& step, const Eigen::MatrixXd& direction, Eigen::VectorXd& forces);
/// products (constants, tets) += its product with `weights` (3n), for each constant of each tet's law.
void add_damping_law_products(const DampedStep& step, const Eigen::VectorXd& weights, Eigen::MatrixXd& products);

/// forces (3n) += change of the damping force with a motion (3n) of the rest positions, as add_rest_product().
void add_damping_rest_product(const DampedStep& step, const Eigen::VectorXd& motion, Eigen::VectorXd& forces);
/// result (3n) += the transpose of the same, times `weights` (3n) of the forces.
void add_damping_rest_weights(const DampedStep& step, const Eigen::VectorXd& weights, Eigen::VectorXd& result);

}  // namespace pliant::sim
