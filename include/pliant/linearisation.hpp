/// @file
/// Derivatives of a state of equilibrium with respect to inputs, parameters and the rest shape.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// A number that the state depends on.
struct Parameter {
    std::string name;  ///< for people, such as: cable "left": length
    std::string unit;  ///< SI; "" if dimensionless
    double value = 0;  ///< its value at the state
};

/// A guide point of a cable or spring.
struct GuidePoint {
    std::string name;  ///< for people, such as: cable "left": point 2
    Point place{};     ///< rest position, m
};

/// Optional parts of the gradient of a state.
struct StateGradientOptions {
    bool guide_points = false;  ///< also with respect to the guide points of cables and springs
};

/// First-order change of a state, per unit of its cause.
struct Change {
    std::vector<Point> positions;      ///< (nodes) m
    std::vector<double> tensions_N;    ///< (cables)
    std::vector<double> pressures_Pa;  ///< (chambers)
};

/// A function of the state, given by its first derivatives with respect to node positions, tensions and pressures. An
/// empty vector stands for zero.
struct Quantity {
    std::vector<Point> by_positions;   ///< (nodes)
    std::vector<double> by_tensions;   ///< (cables)
    std::vector<double> by_pressures;  ///< (chambers)
};

/// A scalar that can be measured on a robot, in SI units.
struct Measure {
    /// The measured quantity.
    enum class Of {
        marker,         ///< its coordinate along `direction`; m for a unit direction
        tension,        ///< of a cable, N
        pressure,       ///< of a chamber or a pressure load, Pa
        length,         ///< of a cable, m
        length_ratio,   ///< length of a cable over its rest length
        volume,         ///< of a chamber, m^3
        volume_ratio,   ///< volume of a chamber over its rest volume
        spring_length,  ///< m
        spring_force,   ///< N, positive where it pulls
        reaction,       ///< force of a support on the robot along `direction`; N for a unit direction
        contact_force,  ///< force of an obstacle on the robot along `direction`, with friction; N for a unit direction
        self_contact,   ///< sum of the magnitudes of the robot's normal forces on itself, N; needs no name
    };
    Of of = Of::marker;  ///< the measured quantity
    std::string name;    ///< what it is measured on, as in the robot file
    /// Of a marker, reaction or contact force; not zero. The value is the dot product with it: value and gradient scale
    /// with its length.
    Point direction{};
};

/// The equilibrium equations F(z) = 0, linearised at a state: elements, cables and chambers, follower pressure,
/// contact, friction as found at the state, inertia. The unknowns z are the coordinates of the unconstrained nodes,
/// three for each, followed by the multipliers that are not prescribed: cable tensions and minus the chamber pressures.
/// It works for one caller at a time: while it does, on another thread, its other members that are not const throw a
/// Failure.
///
/// Lagged quantities are held constant as found at the state: the normal forces and tangents of contact friction, and
/// the tension shares of cables with friction. Where contacts slide, or such cables move in their guides, a derivative
/// is therefore not that of the next step, which computes them again.
///
/// In a motion in time the equations are those of the last step: the state before it is held constant, its positions
/// and velocities, also in derivatives by a parameter that acted on it. gradient() of pliant/gradient.hpp
/// differentiates the whole motion.
class PLIANT_API Linearisation {
public:
    /// Linearises at a state returned by a Stepper.
    /// @throws Failure if the state is not physically possible, as with an inverted element, if it was reached with
    /// `integrator = "energy-conserving"`, or if the robot is in a [fluid].
    explicit Linearisation(const State& state);
    /// Moves; the moved-from object may only be assigned to or destroyed.
    Linearisation(Linearisation&&) noexcept;
    /// Moves; the moved-from object may only be assigned to or destroyed.
    Linearisation& operator=(Linearisation&&) noexcept;
    ~Linearisation();

    /// Number of unknowns.
    [[nodiscard]] std::size_t size() const;
    /// (unknowns) the product A v with the exact tangent A = dF/dz.
    /// @throws Failure if v has the wrong size or a number that is not finite.
    [[nodiscard]] std::vector<double> multiply(std::span<const double> v) const;
    /// (unknowns) the product A^T w.
    /// @throws Failure if w has the wrong size or a number that is not finite.
    [[nodiscard]] std::vector<double> multiply_transposed(std::span<const double> w) const;
    /// (unknowns) A^-1 b, as accurate as rounding allows: residuals of forces are 1e-12 of b, those of the few other
    /// rows, which have other units, 1e-7. Also at an unstable equilibrium. The first solve factorises A.
    /// @throws Failure if b has the wrong size or a number that is not finite, A is singular, or redundant cables have
    /// conflicting targets.
    [[nodiscard]] std::vector<double> solve(std::span<const double> b);
    /// (unknowns) A^-T b, as accurate as solve().
    /// @throws Failure as for solve().
    [[nodiscard]] std::vector<double> solve_transposed(std::span<const double> b);
    /// Translates a vector of unknowns into a change of the state.
    /// @throws Failure if the vector has the wrong size or a number that is not finite.
    [[nodiscard]] Change change(std::span<const double> unknowns) const;

    /// The inputs: a length or tension for each of Model::cables(), a volume, pressure or gas amount for each of
    /// Model::chambers(), then pressure loads, the progress of supports, loads, gravity and obstacles along their
    /// program, and the targets of driven joints. Cables and chambers have the quantity of their Drive at the state,
    /// not that of the target in the robot file.
    [[nodiscard]] const std::vector<Parameter>& inputs() const;
    /// The parameters of the robot and its surroundings: material constants, densities, springs, friction, loads,
    /// gravity, supports, contact. The constants of a material are those of its law, followed by Young's modulus and
    /// Poisson ratio where the law is given by them. A graded body has materials of its own, "soft with 60 % firm": the
    /// constants of "soft" itself are then those of what is wholly soft, and have no effect where nothing is.
    [[nodiscard]] const std::vector<Parameter>& parameters() const;

    /// The guide points of all cables, followed by those of all springs. Guide points placed at crossings are included.
    /// @throws Failure if a guide point is not attached to a tetrahedron.
    [[nodiscard]] const std::vector<GuidePoint>& guide_points();

    /// Derivative of the whole state with respect to one input. One linear solve.
    /// @throws Failure as for solve(), or if there is no such input.
    [[nodiscard]] Change response_to_input(std::size_t input);
    /// Derivative of the whole state with respect to one parameter. One linear solve.
    /// @throws Failure as for solve(), or if there is no such parameter.
    [[nodiscard]] Change response_to_parameter(std::size_t parameter);

    /// Derivatives of a quantity.
    struct Gradient {
        std::vector<double> inputs;         ///< (inputs)
        std::vector<double> parameters;     ///< (parameters)
        std::vector<Point> rest_positions;  ///< (nodes)
        /// (guide_points()) where requested: derivative with respect to the rest position of each guide point, which is
        /// re-attached to the mesh as it moves.
        std::vector<Point> guide_points{};
    };
    /// Gradient of a quantity, by one transposed solve. For derivatives with respect to the rest shape and guide
    /// points, prescribed lengths and volumes keep their values in m and m^3; with the rest shape, everything attached
    /// to nodes moves along.
    /// @throws Failure as for solve() and, with guide points, guide_points(), or if the quantity does not match the
    /// model in size or is not finite.
    [[nodiscard]] Gradient gradient(const Quantity& quantity, const StateGradientOptions& options = {});
    /// The coordinate of a marker along a direction; in m for a unit direction.
    /// @throws Failure if there is no such marker, or the direction is not finite.
    [[nodiscard]] Quantity marker_coordinate(std::size_t marker, const Point& direction) const;

    /// The value of a measure at this state.
    /// @throws Failure if the robot has nothing of that name, or the direction is not finite or, where one is needed,
    /// zero.
    [[nodiscard]] double value(const Measure& measure) const;
    /// Gradient of a measure, by one transposed solve. Unlike for a Quantity, the explicit dependence of the measure on
    /// a parameter is included. For derivatives with respect to the rest shape and guide points, prescribed lengths,
    /// volumes and amounts of gas change with the rest length or volume: by the same amount where the target in the
    /// robot file is `shortening` or `volume_change`, otherwise in proportion. The robot file decides, also where the
    /// state was reached with a Drive in m or m^3.
    /// @throws Failure as for solve(), value() and, with guide points, guide_points().
    [[nodiscard]] Gradient gradient(const Measure& measure, const StateGradientOptions& options = {});

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant
