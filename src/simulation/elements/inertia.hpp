// Implicit time stepping: inertia and damping as terms of the energy that a step minimises.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "simulation/elements/free_rotation.hpp"
#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

class BlockSums;
class Elements;

/// Motion so far: positions and velocities (3n) of the last two steps.
struct History {
    Eigen::VectorXd x, v;
    Eigen::VectorXd x_before, v_before;
    double dt_before = 0;   ///< 0: there is no earlier step
    bool is_still = false;  ///< v is always zero: a tether at equilibrium
    // For steps whose formula or length depends on the way (Scheme, time tolerance).
    int touching = 0;    ///< number of the last steps that ended in contact
    double next_dt = 0;  ///< largest next step for the error tolerance; 0: unknown
};

/// Time integration scheme of a step.
enum class Scheme {
    even,        ///< BDF2 if the last step was equally long, else implicit Euler
    euler,       ///< implicit Euler
    bdf2,        ///< BDF2 for two steps of any length
    conserving,  ///< mean of the forces along the path, with the mean of the velocities at its ends
};

/// A symmetric matrix over all nodes: those that supports hold move too, and what moves as a whole is not damped. The
/// pattern is the same for all steps.
struct StiffnessMatrix {
    std::shared_ptr<const linalg::SymmetricPattern> pattern;  ///< block 3
    std::vector<double> values;
};

/// The step from a history to x. With constant step length it is BDF2, otherwise implicit Euler; both only dissipate
/// energy in a linear system (A-stable; Euler much, BDF2 little). In both v = c (x - p) and a = c (v - q), so that the
/// step's equations are the gradient of  c^2/2 |x - x~|_M^2 + c/2 |x - p|_C^2  with  x~ = p + q / c:
///   Euler  c = 1/h       p = x_n                    q = v_n
///   BDF2   c = 3/(2 h)   p = (4 x_n - x_{n-1})/3    q = (4 v_n - v_{n-1})/3
/// and for a step r times as long as the last one
///   BDF2   c = (1 + 2r)/((1 + r) h)   p = ((1 + r)^2 x_n - r^2 x_{n-1})/(1 + 2r)   q likewise
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II, chapter III; for variable steps Hairer,
/// Norsett and Wanner I, III.5.
///
/// Both would brake the rotation of rigid objects, since their nodes move on arcs. For the nodes of an object these
/// formulas therefore apply to the deviation from the motion that it would have from x_n and v_n without a torque
/// (FreeRotation; the centre of mass moves uniformly in it, which the formulas render exactly):
///     v = c (x - p) + d_v      d_v = v° - c (x° - p°)
///     a = c (v - q) + d_a      d_a = a° - c (v° - q°)
/// where x°, v° and a° are those of the free motion at the end, and p° and q° are formed from it, backwards in time
/// too. This shifts p by -d_v/c and x~ by -d_v/c - d_a/c^2. A free object then follows its free motion, and forces have
/// their effect with the order and the damping of the formulas (defect correction: Stetter 1978, "The defect correction
/// principle and discretization methods").
///
/// The conserving step has  x - x_n = h/2 (v_n + v)  and  M (v - v_n)/h = - mean of the forces on the straight path
/// from x_n to x, so that the sum of kinetic and potential energy is conserved (Harten, Lax and van Leer 1983; Quispel
/// and McLaren 2008, "A new class of energy-preserving numerical integration methods"). Each force evaluates its own
/// mean (means()); this is the gradient of a potential, too, because the force at x_n + s (x - x_n) with the weight w
/// is that of the energy there times w/s. Inertia is then 2/h^2 M (x - x_n - h v_n), damping C (x - x_n)/h.
class Inertia {
public:
    /// `stiffness` is over all nodes, or null where there is no damping by stiffness; all must outlive the step.
    Inertia(const Elements& elements, const std::vector<int>& free_index, History history, double dt,
            const Damping& damping, std::shared_ptr<const StiffnessMatrix> stiffness, Scheme scheme = Scheme::even);

    /// A point on the path of a conserving step, as a share of it, and the weight of the force there.
    struct Mean {
        double share, weight;
    };
    /// Two-point Gauss rule, exact for energies of fourth order in the positions (such as that of a rigid object).
    static constexpr std::array<Mean, 2> gauss{{{0.21132486540518712, 0.5}, {0.78867513459481288, 0.5}}};
    /// Positions as a sum of those of a history: from x on for a time.
    struct Place {
        double x, v, x_before;  ///< factors
        [[nodiscard]] Eigen::VectorXd of(const History& h) const { return x * h.x + v * h.v + x_before * h.x_before; }
    };
    /// Where the stiffness used for damping is taken: in the middle of the step where velocities are differences of its
    /// ends, else at its end, foretold by the velocity at the start. With a stiffness taken at the start a body that
    /// turns would be braked, the more the longer the step is. The velocities of conserving steps oscillate about their
    /// mean over a step: there it is that of the last one.
    [[nodiscard]] static Place damping_place(const History& history, double dt, Scheme scheme);
    [[nodiscard]] Place damping_place() const { return damping_place(start_, dt_, scheme_); }
    /// Points at which forces are evaluated; empty: at the end only.
    [[nodiscard]] std::span<const Mean> means() const {
        return scheme_ == Scheme::conserving ? std::span<const Mean>(gauss) : std::span<const Mean>();
    }
    /// (3n) the point at `share` of the straight path from the start of the step to x.
    [[nodiscard]] Eigen::VectorXd on_path(const Eigen::VectorXd& x, double share) const {
        return start_.x + share * (x - start_.x);
    }
    [[nodiscard]] Scheme scheme() const { return scheme_; }
    /// (3n) estimated error of a step that ends at x: its difference from extrapolating the last two states, times the
    /// factor from theory (Gresho, Griffiths and Silvester 2008, "Adaptive time-stepping for incompressible flow"); for
    /// objects that of their deviation from the free motion. At the start of a motion it is too large.
    [[nodiscard]] Eigen::VectorXd error(const Eigen::VectorXd& x) const;

    /// Energy of inertia and damping at x, J; forces (3n) += its gradient.
    double evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& forces) const;
    /// For a pattern (block 3) that holds the elements' cliques, of which these are the sums; `index` (n) of each node
    /// in it, or -1.
    void add_hessian(const BlockSums& sums, const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                     std::span<double> values) const;

    /// History at the start of the step, and the length of the step.
    [[nodiscard]] const History& start() const { return start_; }
    [[nodiscard]] double dt() const { return dt_; }
    /// True for a tether, which stabilises parts that nothing holds at equilibrium.
    [[nodiscard]] bool is_tether() const { return start_.is_still; }
    /// (3n) the factor of the mass matrix in the gradient: acceleration and mass damping, m/s^2.
    [[nodiscard]] Eigen::VectorXd acceleration(const Eigen::VectorXd& x) const {
        return mass_rate_ * off(x) + rate_ * damping_.mass_per_s * (x - from_);
    }
    /// (3n) acceleration at the end of the step, if it ends at x, m/s^2; for a conserving step the mean.
    [[nodiscard]] Eigen::VectorXd true_acceleration(const Eigen::VectorXd& x) const { return mass_rate_ * off(x); }
    /// Velocity (3n) at the end of the step, if it ends at x.
    [[nodiscard]] Eigen::VectorXd velocity(const Eigen::VectorXd& x) const;
    /// Velocity used for damping: for a conserving step the mean, else as velocity().
    [[nodiscard]] Eigen::VectorXd damped_velocity(const Eigen::VectorXd& x) const { return rate_ * (x - from_); }
    [[nodiscard]] double rate() const { return rate_; }
    [[nodiscard]] const Damping& damping() const { return damping_; }
    /// (3n) M v, and K v with the stiffness used for damping (zero without it).
    [[nodiscard]] Eigen::VectorXd mass_times(const Eigen::VectorXd& v) const;
    [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;

    /// (3n) each: derivative with respect to the history of `force_weights` (3n) times the gradient plus
    /// `velocity_weights` (3n) times the velocity, both at a given x. dt_before is not filled in. The stiffness used
    /// for damping is held fixed: linearisation/damping_stiffness.hpp has its part.
    [[nodiscard]] History start_weights(const Eigen::VectorXd& force_weights,
                                        const Eigen::VectorXd& velocity_weights) const;

    /// Derivative of the step with respect to its history, times a change of it (dt_before and is_still are not read):
    /// force and velocity of the result, with the change of x, are the changes of this step's. The stiffness used for
    /// damping is held fixed.
    [[nodiscard]] Inertia change(History by) const;

private:
    [[nodiscard]] Eigen::VectorXd damping_force(const Eigen::VectorXd& motion) const;
    [[nodiscard]] Eigen::VectorXd off(const Eigen::VectorXd& x) const;
    void set_scheme();
    void set_even();
    void set_uneven();
    void set_conserving();

    /// An object in its free motion.
    struct Turning {
        std::array<int, 4> nodes;
        FreeRotation motion;
    };
    /// d_v and d_a of an object, or their changes.
    struct Defect {
        FreeRotation::Nodes v, a;
    };
    [[nodiscard]] std::vector<Turning> turning_objects() const;
    [[nodiscard]] Defect defect(const Turning& object) const;
    [[nodiscard]] Defect defect_change(const Turning& object, const FreeRotation::Nodes& dx,
                                       const FreeRotation::Nodes& dv) const;
    [[nodiscard]] Defect defect_of(const FreeRotation::Motion& before, const FreeRotation::Motion& now,
                                   const FreeRotation::Motion& after) const;
    void shift(const Turning& object, const Defect& by);
    void add_defect_weights(const Eigen::VectorXd& by_v, const Eigen::VectorXd& by_a, History& weights) const;
    template <class Vectors>
    [[nodiscard]] Vectors error_from(const Vectors& x_end, const Vectors& v_end, const Vectors& x, const Vectors& v,
                                     const Vectors& v_before) const;

    const Elements* elements_;
    const std::vector<int>* free_index_;
    History start_;
    double dt_;
    Scheme scheme_;
    bool even_ = false;        ///< BDF2 with constant step length
    double share_now_ = 1;     ///< of x_n in p and of v_n in q
    double share_before_ = 0;  ///< of x_{n-1} and v_{n-1}
    double rate_ = 0;          ///< c
    double mass_rate_ = 0;     ///< factor of the mass: c^2, or 2/h^2
    double mass_entry_ = 0;    ///< factor of the mass with its damping
    Eigen::VectorXd from_;     ///< p, shifted for objects
    Eigen::VectorXd coast_;    ///< x~, likewise
    Damping damping_;
    std::shared_ptr<const StiffnessMatrix> stiffness_;
    std::vector<Turning> turning_;  ///< empty for a tether and a conserving step
};

}  // namespace pliant::sim
