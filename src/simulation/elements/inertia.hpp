// Implicit time stepping: mass and damping as terms of the energy that a step minimises.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/linalg/sparse.hpp"
#include "simulation/parts/robot_names.hpp"

namespace pliant::sim {

class Elements;

/// Where the robot has been: positions and velocities (3n) of the last two steps.
struct History {
    Eigen::VectorXd x, v;
    Eigen::VectorXd x_before, v_before;
    double dt_before = 0;   ///< 0: there is no step before the last
    bool is_still = false;  ///< of what holds loosely at equilibrium: whatever the steps before did, v is zero
    // For steps whose formula or length depends on the way (Scheme, time tolerance).
    int touching = 0;    ///< of the last steps, how many ended in contact
    double next_dt = 0;  ///< how long the next step may be for its error; 0: not known
};

/// How a step in time is computed.
enum class Scheme {
    even,        ///< BDF2 where the last step was as long, else implicit Euler
    euler,       ///< implicit Euler
    bdf2,        ///< BDF2 for two steps of any lengths
    conserving,  ///< the mean of the forces along the way, with the mean of the velocities at its ends
};

/// A symmetric matrix over free nodes. The pattern is the same for all steps.
struct StiffnessMatrix {
    std::shared_ptr<const linalg::SymmetricPattern> pattern;  ///< block 3
    std::vector<double> values;
};

/// The step that leads from a history to x. With steps of one length it is BDF2, else implicit Euler; both only
/// take energy out of a linear system (A-stable; Euler much, BDF2 little). In both v = c (x - p) and a = c (v - q), so
/// that the step's equations are the gradient of  c^2/2 |x - x~|_M^2 + c/2 |x - p|_C^2  with  x~ = p + q / c:
///   Euler  c = 1/h       p = x_n                    q = v_n
///   BDF2   c = 3/(2 h)   p = (4 x_n - x_{n-1})/3    q = (4 v_n - v_{n-1})/3
/// and for a step r times as long as the last one
///   BDF2   c = (1 + 2r)/((1 + r) h)   p = ((1 + r)^2 x_n - r^2 x_{n-1})/(1 + 2r)   q likewise
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II, chapter III; of steps of any length Hairer,
/// Norsett and Wanner I, III.5.
///
/// The conserving step has  x - x_n = h/2 (v_n + v)  and  M (v - v_n)/h = - mean of the forces on the straight way from
/// x_n to x, so that kinetic and potential energy together stay what they are (Harten, Lax and van Leer 1983; Quispel
/// and McLaren 2008, "A new class of energy-preserving numerical integration methods"). Whoever has forces takes their
/// mean (means()); it is the gradient of a potential, too, because the force at x_n + s (x - x_n) with the weight w is
/// that of the energy there times w/s. Inertia is then 2/h^2 M (x - x_n - h v_n), damping C (x - x_n)/h.
class Inertia {
public:
    /// `stiffness` may be null where there is no damping by stiffness; all must outlive the step.
    Inertia(const Elements& elements, const std::vector<int>& free_index, History history, double dt,
            const Damping& damping, std::shared_ptr<const StiffnessMatrix> stiffness, Scheme scheme = Scheme::even);

    /// A place on the way of a conserving step, as a share of it, and what the force there counts.
    struct Mean {
        double share, weight;
    };
    /// Gauss' two points, exact for energies of the fourth order in the positions (a rigid object's is one).
    static constexpr std::array<Mean, 2> gauss{{{0.21132486540518712, 0.5}, {0.78867513459481288, 0.5}}};
    /// Where forces are taken; empty: at the end alone.
    [[nodiscard]] std::span<const Mean> means() const {
        return scheme_ == Scheme::conserving ? std::span<const Mean>(gauss) : std::span<const Mean>();
    }
    [[nodiscard]] Scheme scheme() const { return scheme_; }
    /// (3n) about how far a step that ends at x is off: what it differs by from looking on from the last two states,
    /// times what theory says of both (Gresho, Griffiths and Silvester 2008, "Adaptive time-stepping for incompressible
    /// flow"). At the start of a motion it is too large.
    [[nodiscard]] Eigen::VectorXd error(const Eigen::VectorXd& x) const;

    [[nodiscard]] double energy(const Eigen::VectorXd& x) const;
    /// forces (3n) += gradient: inertia and damping.
    void add_gradient(const Eigen::VectorXd& x, Eigen::VectorXd& forces) const;
    /// For a pattern (block 3) that holds the elements' cliques; `index` (n) of each node in it, or -1.
    void add_hessian(const std::vector<int>& index, const linalg::SymmetricPattern& pattern,
                     std::span<double> values) const;

    /// What the step leads from, and how long it is.
    [[nodiscard]] const History& start() const { return start_; }
    [[nodiscard]] double dt() const { return dt_; }
    /// It stands in at equilibrium for what holds nothing.
    [[nodiscard]] bool is_tether() const { return start_.is_still; }
    /// (3n) what the mass matrix multiplies in the gradient: the acceleration, and damping by mass, m/s^2.
    [[nodiscard]] Eigen::VectorXd acceleration(const Eigen::VectorXd& x) const {
        return mass_rate_ * off(x) + rate_ * damping_.mass_per_s * (x - from_);
    }
    /// (3n) m/s^2 at the end of the step, if it ends at x; of a conserving step the mean.
    [[nodiscard]] Eigen::VectorXd true_acceleration(const Eigen::VectorXd& x) const { return mass_rate_ * off(x); }
    /// Velocity (3n) at the end of the step, if it ends at x.
    [[nodiscard]] Eigen::VectorXd velocity(const Eigen::VectorXd& x) const;
    /// That which damping takes: of a conserving step the mean, else as velocity().
    [[nodiscard]] Eigen::VectorXd damped_velocity(const Eigen::VectorXd& x) const { return rate_ * (x - from_); }
    [[nodiscard]] double rate() const { return rate_; }
    [[nodiscard]] const Damping& damping() const { return damping_; }
    /// (3n) M v, and K v with the stiffness that damping takes (zero without it).
    [[nodiscard]] Eigen::VectorXd mass_times(const Eigen::VectorXd& v) const;
    [[nodiscard]] Eigen::VectorXd stiffness_times(const Eigen::VectorXd& v) const;

    /// (3n) each, by what the step leads from: `force_weights` (3n) times the gradient and `velocity_weights` (3n)
    /// times the velocity, both at a given x. dt_before is not filled in. The stiffness that damping takes stays.
    [[nodiscard]] History start_weights(const Eigen::VectorXd& force_weights,
                                        const Eigen::VectorXd& velocity_weights) const;

    /// The same step from elsewhere, with the stiffness that damping takes here. Force and velocity are linear in x and
    /// the history together: from a change of the history they are what changes.
    [[nodiscard]] Inertia from(History history) const {
        return {*elements_, *free_index_, std::move(history), dt_, damping_, stiffness_, scheme_};
    }

private:
    [[nodiscard]] Eigen::VectorXd damping_force(const Eigen::VectorXd& motion) const;
    [[nodiscard]] Eigen::VectorXd off(const Eigen::VectorXd& x) const;
    void set_even();
    void set_uneven();
    void set_conserving();

    const Elements* elements_;
    const std::vector<int>* free_index_;
    History start_;
    double dt_;
    Scheme scheme_;
    bool even_ = false;      ///< BDF2 of steps of one length
    double rate_ = 0;        ///< c
    double mass_rate_ = 0;   ///< of the mass: c^2, or 2/h^2
    double mass_entry_ = 0;  ///< of the mass with its damping
    Eigen::VectorXd from_;   ///< p
    Eigen::VectorXd coast_;  ///< x~
    Damping damping_;
    std::shared_ptr<const StiffnessMatrix> stiffness_;
};

}  // namespace pliant::sim
