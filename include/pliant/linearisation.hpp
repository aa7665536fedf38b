/// @file
/// What a state answers to small changes: of what drives the robot, of what it is made of, of its rest shape.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// A number that a state is a function of.
struct Parameter {
    std::string name;  ///< for people: cable "left": length
    std::string unit;  ///< SI; "" for a plain number
    double value = 0;  ///< at the state
};

/// A point that a cable or spring goes through.
struct GuidePoint {
    std::string name;  ///< for people: cable "left": point 2
    Point place{};     ///< at rest, m
};

/// What the gradient of a state is wanted by, beside what always is.
struct StateGradientOptions {
    bool guide_points = false;  ///< of cables and springs
};

/// A small change of a state, for each unit of what causes it.
struct Change {
    std::vector<Point> positions;      ///< (nodes) m
    std::vector<double> tensions_N;    ///< (cables)
    std::vector<double> pressures_Pa;  ///< (chambers)
};

/// A function of the state, to first order: its derivatives by the positions of nodes, by tensions and by pressures.
/// What is left empty is zero.
struct Quantity {
    std::vector<Point> by_positions;   ///< (nodes)
    std::vector<double> by_tensions;   ///< (cables)
    std::vector<double> by_pressures;  ///< (chambers)
};

/// Something that can be measured on a robot: one number, SI.
struct Measure {
    /// What is measured.
    enum class Of {
        marker,         ///< its coordinate along `direction`, m
        tension,        ///< of a cable, N
        pressure,       ///< of a chamber or a load that presses, Pa
        length,         ///< of a cable, m
        length_ratio,   ///< of a cable, over that at rest
        volume,         ///< of a chamber, m^3
        volume_ratio,   ///< of a chamber, over that at rest
        spring_length,  ///< m
        spring_force,   ///< N, positive where it pulls
        reaction,       ///< force of a support on the robot along `direction`, N
        contact_force,  ///< force of an obstacle on the robot along `direction`, with friction, N
        self_contact,   ///< sum of the sizes of the robot's normal forces on itself, N; has no name
    };
    Of of = Of::marker;  ///< what is measured
    std::string name;    ///< on which, as in the robot file
    Point direction{};   ///< of any length
};

/// The equations of a state of equilibrium, F(z) = 0 in its unknowns z, linearised: elements, cables and chambers,
/// pressure that follows its wall, contact, friction as it was found, inertia. The unknowns are the positions of the
/// nodes that nothing holds, three by three, then the multipliers that are not given: tensions of cables and minus the
/// pressures of chambers. For one thread at a time.
class PLIANT_API Linearisation {
public:
    /// Of a state that a Stepper left.
    /// @throws Failure where the state is one that no body can have.
    explicit Linearisation(const State& state);
    /// Moves it; the other one is of no use afterwards.
    Linearisation(Linearisation&&) noexcept;
    /// Moves it; the other one is of no use afterwards.
    Linearisation& operator=(Linearisation&&) noexcept;
    ~Linearisation();

    /// Unknowns.
    [[nodiscard]] std::size_t size() const;
    /// (unknowns) A v with A = dF/dz. Exact.
    /// @throws Failure where v has another size.
    [[nodiscard]] std::vector<double> multiply(std::span<const double> v) const;
    /// (unknowns) A^T w.
    [[nodiscard]] std::vector<double> multiply_transposed(std::span<const double> w) const;
    /// (unknowns) A^-1 b, to 1e-12 of b; also where the equilibrium is unstable. The first solution factorises.
    /// @throws Failure where the matrix is singular, or cables that do the same are asked for different things.
    [[nodiscard]] std::vector<double> solve(std::span<const double> b);
    /// (unknowns) A^-T b.
    [[nodiscard]] std::vector<double> solve_transposed(std::span<const double> b);
    /// What a vector of unknowns is, as a change of the state.
    [[nodiscard]] Change change(std::span<const double> unknowns) const;

    /// What drives the robot: lengths, tensions, volumes, pressures, gas, and how far supports, loads, gravity and
    /// obstacles are on their way.
    [[nodiscard]] const std::vector<Parameter>& inputs() const;
    /// What the robot is made of and stands in: constants of materials, densities, springs, friction, loads, gravity,
    /// supports, contact. The constants of a material are Young's modulus and Poisson ratio, then those of its law.
    [[nodiscard]] const std::vector<Parameter>& parameters() const;

    /// The guide points of cables, then those of springs. With guides at crossings those count, too.
    /// @throws Failure where one is tied to no tetrahedron.
    [[nodiscard]] const std::vector<GuidePoint>& guide_points();

    /// What the whole state does for each unit of an input. One solution.
    /// @throws Failure as of solve(), or there is no such input.
    [[nodiscard]] Change response_to_input(std::size_t input);
    /// What the whole state does for each unit of a parameter. One solution.
    /// @throws Failure as of solve(), or there is no such parameter.
    [[nodiscard]] Change response_to_parameter(std::size_t parameter);

    /// What everything does to a quantity.
    struct Gradient {
        std::vector<double> inputs;         ///< (inputs)
        std::vector<double> parameters;     ///< (parameters)
        std::vector<Point> rest_positions;  ///< (nodes)
        /// (guide_points()) where wanted, by where each is at rest: the mesh then carries it elsewhere.
        std::vector<Point> guide_points{};
    };
    /// By one transposed solution. With the rest shape and with guide points, lengths and volumes that are driven stay
    /// as they are, in m and m^3; with the rest shape everything that is tied to nodes moves along.
    /// @throws Failure as of solve(), or the quantity has another size than the model.
    [[nodiscard]] Gradient gradient(const Quantity& quantity, const StateGradientOptions& options = {});
    /// Coordinate of a marker along a direction; m for a direction of length 1.
    /// @throws Failure where there is no such marker.
    [[nodiscard]] Quantity marker_coordinate(std::size_t marker, const Point& direction) const;

    /// The number at this state.
    /// @throws Failure where the robot has nothing of that name.
    [[nodiscard]] double value(const Measure& measure) const;
    /// By one transposed solution. Unlike that of a Quantity it knows what the measure itself has of a parameter, and
    /// with the rest shape and with guide points lengths and volumes that are wanted as a share of what they are at
    /// rest follow.
    /// @throws Failure as of solve() and value().
    [[nodiscard]] Gradient gradient(const Measure& measure, const StateGradientOptions& options = {});

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant
