// The linearised equations of a converged state: its first-order response to a change of any input or parameter.
//
//     const Equilibrium system(model);                          // state, controls: as a solver left them
//     auto at = Linearisation::create(system, state, controls);
//     const Quantity tip = marker_coordinate(system, 0, {0, 0, 1});
//     // One solve gives the response of everything to an input:
//     for (const Parameter& input : inputs(*at)) {
//         const Result<Change> change = at->response(derivative(*at, input));
//         fmt::print("{}: {} m per {}\n", input.name, tip.derivative(*change), input.unit);
//     }
//     // One transposed solve gives the derivatives of a quantity with respect to everything:
//     const Result<Adjoint> adjoint = at->adjoint(tip);
//     for (const Parameter& input : inputs(*at)) fmt::print("{}\n", adjoint->derivative(derivative(*at, input)));
//
// docs/theory.md, "Linearisation", has the equations.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/linearisation/linear_system.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

/// First-order change of a state, per unit of its cause.
struct Change {
    Eigen::VectorXd positions;    ///< (3n) m
    Eigen::VectorXd multipliers;  ///< (actuators) tension of cables, N; minus the pressure of air, Pa
};

/// Derivative of the equations with respect to a number p at fixed unknowns, and the direct effect of p on the state.
struct Derivative {
    Eigen::VectorXd equations;  ///< (unknowns) dF/dp
    Change direct;              ///< on held nodes, and on prescribed multipliers
    /// (3n), or with the nodes of obstacles after those of the robot: d/dp of the forces that balance at each node;
    /// `equations` contains those at free nodes. Excludes the effect of `direct`. Empty: zero.
    Eigen::VectorXd forces{};
};

/// A function q of the state, to first order: dq = by_positions . dx + by_multipliers . dm + by_forces . df.
struct Quantity {
    Eigen::VectorXd by_positions;    ///< (3n)
    Eigen::VectorXd by_multipliers;  ///< (actuators)
    /// (3n), or with the nodes of obstacles after those of the robot: with respect to the forces f that balance at each
    /// node, which are the reaction where it is held, and the force on the robot at each node of an obstacle. Empty:
    /// zero.
    Eigen::VectorXd by_forces{};
    /// Without the effect of the forces: Linearisation::with_forces() moves that into the other two.
    [[nodiscard]] double derivative(const Change& change) const {
        return by_positions.dot(change.positions) + by_multipliers.dot(change.multipliers);
    }
};

/// Coordinate of a marker along `direction`, m if it is of length 1.
[[nodiscard]] Quantity marker_coordinate(const Equilibrium& system, std::size_t marker, const Vec3& direction);
/// Multiplier of an actuator: the tension of a cable, minus the pressure of a chamber.
[[nodiscard]] Quantity multiplier_of(const Equilibrium& system, std::size_t actuator);

/// Adjoint of a quantity: weights w with A^T w = dq/dz, so that dq/dp = dq of the direct part - w . dF/dp.
struct Adjoint {
    Quantity quantity;        ///< with the effect of its forces moved into the rest: Linearisation::with_forces()
    Eigen::VectorXd weights;  ///< (unknowns)
    [[nodiscard]] double derivative(const Derivative& by) const {
        const Eigen::Index both = std::min(quantity.by_forces.size(), by.forces.size());
        return quantity.derivative(by.direct) - weights.dot(by.equations) +
               quantity.by_forces.head(both).dot(by.forces.head(both));
    }
};

/// What a solver already knows about the pattern of K; for states whose contact couples no further nodes.
struct KnownPattern {
    std::shared_ptr<const TangentLayout> layout;  ///< null: unknown
    std::shared_ptr<const linalg::Analysis> analysis;
    bool on_levels = false;  ///< a factorisation would take longer
};
/// `memory` may be null.
[[nodiscard]] KnownPattern known_pattern(const Equilibrium& system, const FactoredLaplacian& laplacian,
                                         const SolverMemory* memory);

/// The linearised equations F(z) = 0 in the unknowns z: the positions of the free nodes (3 free, in the order of
/// Model::free_index), then the multipliers of the actuators that are not prescribed, in ascending order. F has as many
/// rows:
///   of a free node         its out-of-balance force, N: elements, plates, springs, gap elements, inertia, contact,
///                          lagged friction, loads, and the multipliers' forces
///   driven by its measure  g - wanted, m or m^3; of a slack cable its tension m, N
///   of a sealed chamber    g - value / (p_ambient - m), m^3
/// Where a roller holds a free node in a direction, neither that unknown nor that row exists: the component is ignored
/// in the input and zero in the output. Cables with friction have the tension shares of the controls, and contact the
/// friction that is frozen there. Contact stiffness is that of the currently nearest features.
class Linearisation {
public:
    /// Copies state and controls; `system` must outlive it. The state need not be converged, but F is not zero then.
    /// `known` saves computing the elimination order; a larger target residual makes solves cheaper. Errors: the state
    /// is physically impossible.
    [[nodiscard]] static Result<Linearisation> create(const Equilibrium& system, const State& state,
                                                      const Controls& controls, const KnownPattern& known = {},
                                                      double residual = best_residual);

    [[nodiscard]] const Equilibrium& system() const { return *system_; }
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] const Controls& controls() const { return controls_; }
    [[nodiscard]] Eigen::Index size() const { return matrix_->size(); }
    /// Actuators with an unknown multiplier.
    [[nodiscard]] const std::vector<std::size_t>& solved() const { return solved_; }
    /// True for a cable that is driven by length and slack.
    [[nodiscard]] bool is_slack(std::size_t actuator) const;
    /// Treats slack cables as taut, as if they had just become so. Far cheaper than a new linearisation of that state,
    /// and as accurate.
    void tighten(const std::vector<std::size_t>& cables);
    /// Treats taut cables as slack, with the stiffness that their tensions add to K. As cheap.
    void slacken(const std::vector<std::size_t>& cables);

    /// F at another state and other controls, with the same slack cables; NaN if that state is impossible.
    [[nodiscard]] Eigen::VectorXd equations(const State& state, const Controls& controls) const {
        return equations(*system_, state, controls);
    }
    /// The same for a robot that differs only in its numbers or its shape; in the order of this one.
    [[nodiscard]] Eigen::VectorXd equations(const Equilibrium& system, const State& state,
                                            const Controls& controls) const;
    /// A v and A^T w with A = dF/dz; (unknowns) -> (unknowns). Exact.
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& v) const {
        return matrix_->multiply(v, Side::direct);
    }
    [[nodiscard]] Eigen::VectorXd multiply_transposed(const Eigen::VectorXd& w) const {
        return matrix_->multiply(w, Side::transposed);
    }
    /// A^-1 b and A^-T b, also where the equilibrium is unstable; precision and errors as of SystemSolver. The first
    /// call factorises.
    [[nodiscard]] Result<Eigen::VectorXd> solve(const Eigen::VectorXd& b) { return solver().solve(b, Side::direct); }
    [[nodiscard]] Result<Eigen::VectorXd> solve_transposed(const Eigen::VectorXd& b) {
        return solver().solve(b, Side::transposed);
    }

    /// Unknowns as a change of the state: held nodes and prescribed multipliers do not change.
    [[nodiscard]] Change change_of(const Eigen::VectorXd& unknowns) const;
    /// The entries of positions (3n) and multipliers (actuators) that are unknowns.
    [[nodiscard]] Eigen::VectorXd unknowns_of(const Change& change) const;
    /// The change of F with a motion (3n) of any nodes, including held ones. The first call assembles.
    [[nodiscard]] Eigen::VectorXd equations_of_motion(const Eigen::VectorXd& motion);
    /// (3n) its transpose times weights (unknowns).
    [[nodiscard]] Eigen::VectorXd motion_weights(const Eigen::VectorXd& weights);
    /// The same at nodes that a support holds, zero at others; assembles very little.
    [[nodiscard]] Eigen::VectorXd held_motion_weights(const Eigen::VectorXd& weights);

    /// Derivative of the whole state with respect to p: the direct part, and -A^-1 dF/dp.
    [[nodiscard]] Result<Change> response(const Derivative& by);
    [[nodiscard]] Result<Adjoint> adjoint(const Quantity& quantity);
    /// Several of them cost little more than one.
    [[nodiscard]] Result<std::vector<Change>> responses(const std::vector<Derivative>& by);
    [[nodiscard]] Result<std::vector<Adjoint>> adjoints(const std::vector<Quantity>& quantities);
    /// The same quantity, with the effect of positions and multipliers on the forces added to by_positions and
    /// by_multipliers; by_forces then only applies to other changes of the forces.
    [[nodiscard]] Quantity with_forces(const Quantity& quantity);
    /// (3n), or with the nodes of obstacles: derivative of the quantity with respect to a force added to those that
    /// balance at each node.
    [[nodiscard]] Eigen::VectorXd force_weights(const Adjoint& adjoint) const;

private:
    struct Whole;
    Linearisation() = default;
    [[nodiscard]] Change response_of(const Eigen::VectorXd& solved, const Derivative& by) const;
    void find_unknowns();
    void assemble(const KnownPattern& known);
    void set_constraint(LinearSystem& A, std::size_t k) const;
    void set_constraints(std::shared_ptr<LinearSystem> changed);
    [[nodiscard]] const Whole& whole();
    /// True if K is the tet stiffness plus parts with known nodes.
    [[nodiscard]] bool is_tets_and_more() const;
    [[nodiscard]] bool has_more_than_tets() const;
    /// result (3n) += K v over all nodes, or K^T v.
    void add_stiffness(const Eigen::VectorXd& v, Side side, Eigen::VectorXd& result);
    void add_stiffness_beside_tets(const Eigen::VectorXd& v, Eigen::VectorXd& result) const;
    [[nodiscard]] SystemSolver& solver();

    const Equilibrium* system_ = nullptr;
    State state_;
    Controls controls_;
    std::vector<std::size_t> solved_;
    std::vector<bool> slack_;  ///< (actuators)
    std::shared_ptr<LinearSystem> matrix_;
    std::shared_ptr<SystemSolver> solver_;
    std::shared_ptr<const Whole> whole_;
};

}  // namespace pliant::sim
