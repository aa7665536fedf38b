// All inputs of a robot, with interpolation and a distance between two sets.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

struct Inputs {
    double time = 0;                                    ///< program time: sets supports, loads, gravity and obstacles
    std::vector<Drive> drives;                          ///< (cables, then chambers)
    Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  ///< on the pulled point
};

/// Linear interpolation; share 1 is exactly `to`. Precondition: both drive each actuator by the same kind.
[[nodiscard]] Inputs between(const Inputs& from, const Inputs& to, double share);

/// Measures changes of inputs in units that are usually solved in one increment.
class InputUnits {
public:
    /// `time_unit`: of program time. `system` must outlive it.
    InputUnits(const Equilibrium& system, double time_unit);

    /// (time, force, drives)
    [[nodiscard]] Eigen::VectorXd change(const Inputs& from, const Inputs& to) const;
    /// The largest entry of the change, without that of the force.
    [[nodiscard]] double distance(const Inputs& from, const Inputs& to) const;
    [[nodiscard]] double tension_N() const { return tension_N_; }
    /// The change from `now` to `next` as a multiple of that from `before` to `now`; 0 if they are not nearly parallel.
    [[nodiscard]] double onward_share(const Inputs& before, const Inputs& now, const Inputs& next) const;

private:
    [[nodiscard]] double unit(std::size_t a, Drive::Kind kind) const;

    const Equilibrium& system_;
    double time_unit_;
    double tension_N_ = 1, pressure_Pa_ = 1;
};

}  // namespace pliant::sim
