// The numbers that a state depends on: the inputs in the controls, and the parameters of the robot.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// A number, identified by what it belongs to. Listed by inputs() and parameters().
struct Parameter {
    enum class Kind {
        // Of the controls.
        length,          ///< prescribed length of a cable, m; with friction its true length
        tension,         ///< prescribed tension of a cable, N
        volume,          ///< prescribed volume of a chamber, m^3
        pressure,        ///< prescribed pressure of a chamber or a load, Pa
        gas,             ///< sealed in a chamber: absolute pressure times volume, J
        support_share,   ///< of a support's motion
        load_share,      ///< of a load's force
        gravity_share,   ///< of gravity
        obstacle_share,  ///< of an obstacle's motion
        joint_wanted,    ///< target of a driven joint: angle, position, torque or force; rad, m, N m or N
        // Of the robot and of what surrounds it.
        law,                 ///< part: index into material::parameters()
        density,             ///< of a material, kg/m^3: affects weight and inertia
        spring_stiffness,    ///< N/m
        spring_free_length,  ///< m
        cable_friction,      ///< friction coefficient of a cable in its guides, lagged
        load_force,          ///< part: x, y or z, N, at full share
        load_torque,         ///< part: about x, y or z, N m, at full share
        load_pressure,       ///< of a pressure load, Pa, at full share
        gravity,             ///< part: x, y or z, m/s^2, at full share
        ambient_pressure,    ///< reference of sealed gas, Pa
        support_move,        ///< part: x, y or z, m, at full share
        support_angle,       ///< rad, at full share
        contact_stiffness,   ///< Pa
        self_friction,       ///< coefficient of the robot against itself, lagged
        obstacle_friction,   ///< coefficient of the robot against an obstacle, lagged
        object_mass,         ///< kg: its inertia scales with it
        object_friction,     ///< coefficient of an object where its own applies, lagged
        point_mass,          ///< kg: of all points that carry one [[mass]]; its inertia scales with it
        joint_stiffness,     ///< N m/rad or N/m, along the free coordinate
        joint_damping,       ///< N m s/rad or N s/m
        gap_weight,          ///< of the elements of a gap that a cable passes, Pa; index: that of the growth
        mass_damping,        ///< of a motion in time, 1/s
        stiffness_damping,   ///< of a motion in time, s
    };
    Kind kind = Kind::length;
    std::size_t index = 0;  ///< of the actuator (cables, chambers, pressure loads, in this order), support, material...
    std::string name;       ///< cable "left": length
    std::string unit;       ///< "" if dimensionless
    double value = 0;       ///< at this state
    std::size_t part = 0;   ///< component, for quantities with several numbers
};

/// The point masses from `first` on that carry one [[mass]]: it has several if it has an inertia.
[[nodiscard]] std::span<const PointMass> points_of_mass(const Description& d, std::size_t first);

/// Weighted length over true length of a cable: 1 without friction.
[[nodiscard]] double weighted_share(const Linearisation& at, std::size_t cable);

/// All inputs that a controller may change.
[[nodiscard]] std::vector<Parameter> inputs(const Linearisation& at);

/// All parameters of the robot: laws, loads, springs, supports and contact; without rest positions
/// (rest_positions.hpp) and the motions of obstacles, whose shares are inputs. Coefficients of friction that are zero
/// are not included, because no friction is frozen for them.
[[nodiscard]] std::vector<Parameter> parameters(const Linearisation& at);
/// The same for any state of a motion in time with this damping; null: at rest.
[[nodiscard]] std::vector<Parameter> parameters(const Linearisation& at, const Damping* in_time);

/// Derivative of the equations with respect to the number. The prescribed length of a slack cable has no effect.
/// Quantities that are lagged or chosen before a step are held fixed: frozen friction except for its coefficient,
/// stiffness damping, the history of a motion. The stiffness of plates and rigid objects follows the stiffest law, as
/// when a model is rebuilt.
[[nodiscard]] Derivative derivative(Linearisation& at, const Parameter& by);

/// dq/dp for many parameters, with one pass over the tets for all laws and densities together.
[[nodiscard]] Eigen::VectorXd derivatives(Linearisation& at, const Adjoint& adjoint, std::span<const Parameter> by);

/// dq/dp for the material of each tet, as if each had its own. The dependence of rigid plates and objects on the
/// stiffest material is not included.
struct TetDerivatives {
    /// (most constants, tets) with respect to each constant of the tet's own law, in the order of
    /// material::stress_by_constants(); 0 if a law has fewer. With respect to Young's modulus: times the direction of
    /// that number, material::parameters().
    Eigen::MatrixXd constants;
    Eigen::VectorXd density;  ///< (tets)
};
[[nodiscard]] TetDerivatives tet_derivatives(const Linearisation& at, const Adjoint& adjoint);
/// As above, from those derivatives.
[[nodiscard]] Eigen::VectorXd derivatives(Linearisation& at, const Adjoint& adjoint, std::span<const Parameter> by,
                                          const TetDerivatives& tets);

}  // namespace pliant::sim
