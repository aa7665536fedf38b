// The numbers that a state is a function of: what the controls ask for, and what the robot is made of.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "simulation/linearisation/linearisation.hpp"

namespace pliant::sim {

/// A number, by what it belongs to. Made by inputs() and parameters(), which say what there is.
struct Parameter {
    enum class Kind {
        // Of the controls.
        length,          ///< that a cable is wanted to have, m: of one with friction its true length
        tension,         ///< that a cable is given, N
        volume,          ///< that a chamber is wanted to have, m^3
        pressure,        ///< that a chamber or a load is given, Pa
        gas,             ///< sealed in a chamber: absolute pressure times volume, J
        support_share,   ///< of a support's motion
        load_share,      ///< of a load's force
        gravity_share,   ///< of gravity
        obstacle_share,  ///< of an obstacle's motion
        joint_wanted,    ///< of a joint that is driven: angle, place, torque or force; rad, m, N m or N
        // Of the robot and of what surrounds it.
        law,                 ///< part: of material::parameters()
        density,             ///< of a material, kg/m^3: of its weight and its inertia
        spring_stiffness,    ///< N/m
        spring_free_length,  ///< m
        cable_friction,      ///< coefficient of a cable in its guides, as it is lagged
        load_force,          ///< part: x, y or z, N, at full share
        load_pressure,       ///< of a pressure load, Pa, at full share
        gravity,             ///< part: x, y or z, m/s^2, at full share
        ambient_pressure,    ///< Pa: what sealed gas is measured against
        support_move,        ///< part: x, y or z, m, at full share
        support_angle,       ///< rad, at full share
        contact_stiffness,   ///< Pa
        self_friction,       ///< coefficient of the robot against itself, as it is lagged
        obstacle_friction,   ///< coefficient of the robot against an obstacle, as it is lagged
        object_mass,         ///< kg: its inertia grows with it
        object_friction,     ///< coefficient of an object where its own counts, as it is lagged
        point_mass,          ///< kg
        joint_stiffness,     ///< N m/rad or N/m, of the coordinate that it leaves
        joint_damping,       ///< N m s/rad or N s/m
        gap_weight,          ///< of the elements of a gap that a cable passes, Pa; index: of the growth
        mass_damping,        ///< of a motion in time, 1/s
        stiffness_damping,   ///< of a motion in time, s
    };
    Kind kind = Kind::length;
    std::size_t index = 0;  ///< of the actuator (cables, chambers, pressure loads, in this order), support, material...
    std::string name;       ///< cable "left": length
    std::string unit;       ///< "" for a plain number
    double value = 0;       ///< at this state
    std::size_t part = 0;   ///< where a thing has several such numbers
};

/// Weighted over true length of a cable: 1 without friction.
[[nodiscard]] double weighted_share(const Linearisation& at, std::size_t cable);

/// Every number that a controller may change.
[[nodiscard]] std::vector<Parameter> inputs(const Linearisation& at);

/// Every number that the robot is made with, of laws, loads, springs, supports and contact; but not rest positions
/// (rest_positions.hpp). Coefficients of friction that are zero are not among them: of what does not rub nothing
/// is frozen.
[[nodiscard]] std::vector<Parameter> parameters(const Linearisation& at);

/// How the equations change with it. The wanted length of a slack cable does nothing. What is lagged or chosen before a
/// step stays as it is: frozen friction but for its coefficient, damping by stiffness, the history of a motion. The
/// springs of plates and what keeps objects rigid follow the stiffest law, as they do where a model is built anew.
[[nodiscard]] Derivative derivative(Linearisation& at, const Parameter& by);

/// dq/dp for many parameters, with one look at every tet for all laws and densities together.
[[nodiscard]] Eigen::VectorXd derivatives(Linearisation& at, const Adjoint& adjoint, std::span<const Parameter> by);

/// dq/dp of what each tet is made of, as if each had a material of its own. What a rigid plate or an object takes from
/// the stiffest material is not in it.
struct TetDerivatives {
    /// (most constants, tets) by each constant of the tet's own law, in the order of material::stress_by_constants();
    /// 0 where a law has fewer. By Young's modulus: times the direction of that number, material::parameters().
    Eigen::MatrixXd constants;
    Eigen::VectorXd density;  ///< (tets)
};
[[nodiscard]] TetDerivatives tet_derivatives(const Linearisation& at, const Adjoint& adjoint);
/// As above, where those are at hand.
[[nodiscard]] Eigen::VectorXd derivatives(Linearisation& at, const Adjoint& adjoint, std::span<const Parameter> by,
                                          const TetDerivatives& tets);

}  // namespace pliant::sim
