// The torque-free motion of a rigid object about its centre of mass: the reference of its steps in time.
#pragma once

#include <Eigen/Core>

#include "base/linalg/small.hpp"

namespace pliant::sim {

/// Four nodes of equal mass that turn together (AffineBody). Their angular momentum L is constant, and with the inertia
/// of the turned body
///     omega(t) = I(t)^-1 L      R' = omega x R      I(t) = R I R^T
/// (Euler's equations; Landau and Lifshitz, Mechanics, sections 35 and 36). R is integrated by the commutator-free Lie
/// group method of fourth order of Celledoni, Marthinsen and Owren 2003, "Commutator-free Lie group methods", section
/// 3: L is kept exactly, and so is R for a spin about a principal axis.
class FreeRotation {
public:
    using Nodes = Eigen::Matrix<double, 3, 4>;

    /// The motion at time 0: positions, m, not coplanar, and velocities, m/s. Velocities that deform the body have no
    /// part in it.
    FreeRotation(const Nodes& x, const Nodes& v);

    /// Relative to the centre of mass: m, m/s and m/s^2.
    struct Motion {
        Nodes x, v, a;
    };
    /// `time`: s, before or after.
    [[nodiscard]] Motion at(double time) const { return move(time, {}).now; }
    /// The derivative of at() times a change of the positions and velocities at time 0.
    [[nodiscard]] Motion change(double time, const Nodes& dx, const Nodes& dv) const;

private:
    /// The derivatives of what determines the motion.
    struct Change {
        Nodes arms = Nodes::Zero();
        linalg::Vector3 momentum = linalg::Vector3::Zero();
        linalg::Matrix3 inertia = linalg::Matrix3::Zero();
    };
    struct Varied {
        Motion now, change;
    };
    [[nodiscard]] Varied move(double time, const Change& by) const;

    Nodes arms_;                ///< from the centre of mass, m
    Nodes velocity_;            ///< relative to it, m/s
    linalg::Vector3 momentum_;  ///< L for unit masses, m^2/s
    linalg::Matrix3 inertia_;   ///< I for unit masses, m^2
    linalg::Matrix3 inverse_;   ///< I^-1
};

}  // namespace pliant::sim
