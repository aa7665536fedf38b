// What can be measured on a robot at one state, and the derivatives of each measure.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/linearisation/linearisation.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

/// A scalar measure. Forces and positions are taken along `direction`, which need not be normalised.
struct Measure {
    enum class Kind {
        marker,         ///< coordinate, m
        point,          ///< coordinate of a point that rides on the mesh, m
        tension,        ///< of a cable, N, as results report it
        pressure,       ///< of a chamber or of a pressure load, Pa, as results report it
        length,         ///< of a cable, m
        length_ratio,   ///< over that at rest
        volume,         ///< of a chamber, m^3
        volume_ratio,   ///< over that at rest
        spring_length,  ///< m
        spring_force,   ///< N, positive where it pulls
        reaction,       ///< that a support exerts on the robot, N
        contact_force,  ///< that an obstacle exerts on the robot, N, with friction
        self_contact,   ///< sum of the magnitudes of the robot's normal forces on itself, N
    };
    Kind kind = Kind::marker;
    std::size_t index = 0;  ///< of the marker, cable, chamber, pressure load, spring, support or obstacle, in its list
    Vec3 direction{};
    Attachment point{};          ///< of Kind::point
    bool pressure_load = false;  ///< for Kind::pressure: of a pressure load, not of a chamber
};

/// A measured value and its first derivatives: with respect to the state, and explicit ones.
struct Slope {
    double value = 0;
    Quantity state;
    /// Explicit derivatives with respect to parameters, identified by kind, index and part; names and values are not
    /// filled in.
    std::vector<std::pair<Parameter, double>> direct{};
    /// Explicit derivatives with respect to an actuator's measure, now and at rest: already included in `state`, needed
    /// in addition for guide points and rest positions.
    struct ByMeasure {
        std::size_t actuator = 0;
        double now = 0, at_rest = 0;
    };
    std::vector<ByMeasure> by_measures{};
    std::vector<ByMeasure> by_springs{};  ///< the same for the lengths of springs
    Eigen::VectorXd by_rest{};            ///< (3n) explicit derivative with respect to rest positions, without that of
                                          ///< actuator measures; empty: none
    Eigen::VectorXd by_numbers{};         ///< (numbers) explicit derivative with respect to numbers of the drawing,
                                          ///< number_change.hpp; empty: none
};

/// Errors: there is nothing of that kind and index; the message uses the words of Measure.
[[nodiscard]] Status check(const Equilibrium& system, const Measure& measure);

/// Precondition: check() finds nothing wrong.
[[nodiscard]] Slope slope(const Equilibrium& system, const State& state, const Controls& controls,
                          const Measure& measure);
[[nodiscard]] Slope slope(const Linearisation& at, const Measure& measure);

/// The slope of a constant.
[[nodiscard]] Slope no_slope(const Equilibrium& system);
/// sum += factor * slope.
void add(const Slope& slope, double factor, Slope& sum);

}  // namespace pliant::sim
