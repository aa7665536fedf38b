#include "simulation/solver/step_solver.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <utility>

#include "base/core/counted.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/dense.hpp"
#include "base/linalg/extents.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/contact_step.hpp"
#include "simulation/solver/line_search.hpp"
#include "simulation/solver/solved_actuators.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

SolvedActuators solved_actuators(const Equilibrium& system, const Controls& controls) {
    std::vector<bool> only_pulls;
    std::vector<double> rest_measures;
    for (const Actuator& actuator : system.actuators()) {
        only_pulls.push_back(actuator.only_pulls());
        rest_measures.push_back(actuator.rest_measure());
    }
    return {controls.drives, only_pulls, rest_measures};
}

class StepSolver {
public:
    StepSolver(const Equilibrium& system, Curvature& curvature, const Controls& controls, State& state,
               std::optional<Evaluation> known)
        : system_(system),
          curvature_(curvature),
          controls_(controls),
          state_(state),
          evaluation_(known ? std::move(*known) : system.evaluate(state, controls)),
          solved_(solved_actuators(system, controls)),
          search_(solved_, system.actuators().size(),
                  {system.conservative(), system.has_skew(), system.energy_rounding_J()}) {
        for (const Eigen::Index a : solved_.actuators()) by_gaps_ = by_gaps_ || actuator(a).gaps() != nullptr;
        if (evaluation_.possible()) state_.multiplier = evaluation_.multiplier;
    }

    [[nodiscard]] const Evaluation& evaluation() const { return evaluation_; }
    /// Accepted step length of the last direction.
    [[nodiscard]] double alpha() const { return alpha_; }
    [[nodiscard]] Evaluation::Flaw obstacle() const { return search_.obstacle(); }
    [[nodiscard]] bool converged(double tolerance) const { return is_converged(evaluation_, tolerance); }

    /// One iteration; false if no acceptable step was found.
    bool iterate(TangentChoice choice, double tolerance) {
        const Errors errors{std::max(evaluation_.residual, tolerance), evaluation_.violation, tolerance};
        if (!curvature_.refresh(state_, controls_, choice, errors)) return false;
        const Terms terms = terms_here();
        const Direction direction = find_direction(terms);
        if (!direction.dx.allFinite()) return false;
        SearchLine line = line_along(direction);
        const bool blocked = line.is_blocked();
        const double longest = line.longest();
        if (!blocked && search(direction, line, {longest, 0.5 * longest})) return true;
        if (step_through_contact(terms, blocked)) return true;
        return search(direction, line, {blocked ? longest : 0.5 * longest, curvature_.smallest_share() * longest});
    }

private:
    [[nodiscard]] const Actuator& actuator(Eigen::Index a) const {
        return system_.actuators()[static_cast<std::size_t>(a)];
    }

    using AddGradient = void (Actuator::*)(std::span<const double>, double, std::span<double>,
                                           std::span<const double>) const;
    /// Of the actuators with unknown multipliers, on free nodes: (3 free, solved), divided by the measure at rest.
    [[nodiscard]] Eigen::MatrixXd gradients_of(AddGradient add_gradient) const {
        return gradients_of(add_gradient, state_.x, controls_);
    }
    [[nodiscard]] Eigen::MatrixXd gradients_of(AddGradient add_gradient, const Eigen::VectorXd& x,
                                               const Controls& controls) const {
        Eigen::MatrixXd gradients(3 * system_.model().free_count(), solved_.count());
        for (Eigen::Index k = 0; k < solved_.count(); ++k) {
            Eigen::VectorXd full = Eigen::VectorXd::Zero(state_.x.size());
            const Eigen::Index a = solved_.actuators()[static_cast<std::size_t>(k)];
            const Actuator& one = actuator(a);
            (one.*add_gradient)(view(x), 1 / one.rest_measure(), view(full),
                                controls.shares[static_cast<std::size_t>(a)]);
            gradients.col(k) = system_.restrict_to_free(full);
        }
        return gradients;
    }

    /// Motion of the free nodes and change of the scaled multipliers of the solved actuators.
    struct Move {
        Eigen::VectorXd dx, change;
    };

    /// Of the equations at the state, over the free nodes and the solved actuators.
    struct Terms {
        Eigen::VectorXd gradient;     ///< of the energy and of the constraints with their multipliers
        Eigen::MatrixXd forces;       ///< (3 free, solved) of the constraints
        Eigen::VectorXd multipliers;  ///< (solved) scaled
    };
    [[nodiscard]] Terms terms_here() const {
        return {system_.restrict_to_free(evaluation_.out_of_balance), gradients_of(&Actuator::add_gradient),
                solved_.scaled(state_.multiplier)};
    }

    [[nodiscard]] Direction find_direction(const Terms& terms) {
        std::optional<Move> move;
        if (!solved_.empty()) move = solve_constrained(terms);
        if (!move) move = solve_by_columns(terms);
        return direction_of(std::move(*move), terms);
    }

    [[nodiscard]] Direction direction_of(Move move, const Terms& terms) const {
        Direction direction{std::move(move.dx), state_.multiplier, 0};
        solved_.add(move.change, direction.multiplier);
        Eigen::VectorXd energy_gradient = terms.gradient;
        for (Eigen::Index k = 0; k < solved_.count(); ++k) {
            if (solved_.all()[static_cast<std::size_t>(k)].drives_measure)
                energy_gradient -= terms.forces.col(k) * terms.multipliers[k];
        }
        direction.slope_J = energy_gradient.dot(direction.dx);
        return direction;
    }

    [[nodiscard]] Eigen::VectorXd compliances() const {
        return solved_.compliances(controls_.drives, state_.multiplier,
                                   system_.model().description().ambient_pressure_Pa);
    }

    /// Without the cables that are slack, unless one of them would become too long.
    [[nodiscard]] Move solve_by_columns(const Terms& terms) {
        if (by_gaps_) return solve_by_columns(terms, gradients_of(&Actuator::add_measure_gradient), solved_.list());
        const Eigen::VectorXd violation = evaluation_.constraint_violation(solved_.actuators());
        const std::vector<bool> taut = solved_.taut(terms.multipliers, violation);
        SolvedActuators::List acting = solved_.list();
        std::erase_if(acting, [&](Eigen::Index k) { return !taut[static_cast<std::size_t>(k)]; });
        const auto with = [&](auto&& solve) {
            const Move move = solve(acting);
            if (!solved_.is_too_long_beside(acting, violation + terms.forces.transpose() * move.dx)) return move;
            return solve(solved_.list());
        };
        const auto by_each = [&](const auto& some) { return solve_by_columns(terms, terms.forces, some); };
        if (solved_.count() < several) return with(by_each);
        Eigen::MatrixXd gradient = terms.gradient;
        curvature_.solve(gradient);
        const Curvature::Yielding* yielding =
            curvature_.yielding_to({solved_.actuators(), [&](const Eigen::VectorXd& x, const Controls& controls) {
                                        return gradients_of(&Actuator::add_gradient, x, controls);
                                    }});
        if (yielding == nullptr) return with(by_each);
        return with([&](const auto& some) { return solve_with(*yielding, terms, gradient, some); });
    }

    /// With the same responses to the constraints' forces in many steps: so one solution is enough, however many
    /// constraints there are. `gradient`: H^-1 times it.
    [[nodiscard]] Move solve_with(const Curvature::Yielding& yielding, const Terms& terms,
                                  const Eigen::VectorXd& gradient, const SolvedActuators::List& acting) const {
        Move move{-gradient, Eigen::VectorXd::Zero(solved_.count())};
        if (acting.empty()) return move;
        const Eigen::VectorXd change = change_after(gradient, acting, terms.forces(Eigen::all, acting),
                                                    yielding.compliance(acting, acting), terms.multipliers);
        move.change(acting) = change;
        move.dx -= curvature_.push_forward(yielding.motions(Eigen::all, acting) * change);
        return move;
    }

    /// One solution for the gradient and one for each acting actuator; then the multipliers that combine them. `A`:
    /// gradients of the measures.
    [[nodiscard]] Move solve_by_columns(const Terms& terms, const Eigen::MatrixXd& A,
                                        const SolvedActuators::List& acting) {
        const auto count = static_cast<Eigen::Index>(acting.size());
        Eigen::MatrixXd columns(terms.gradient.size(), 1 + count);
        columns.col(0) = terms.gradient;
        columns.rightCols(count) = terms.forces(Eigen::all, acting);
        curvature_.solve(columns);
        return combine({columns.col(0), columns.rightCols(count), acting}, A, terms.multipliers);
    }

    struct Solutions {
        Eigen::VectorXd gradient;      ///< H^-1 gradient
        Eigen::MatrixXd forces;        ///< (3 free, acting) H^-1 times the forces of constraints
        SolvedActuators::List acting;  ///< whose they are
    };
    /// `A`: gradients of the measures; `now`: scaled multipliers.
    [[nodiscard]] Move combine(const Solutions& solutions, const Eigen::MatrixXd& A, const Eigen::VectorXd& now) const {
        Move move{-solutions.gradient, Eigen::VectorXd::Zero(solved_.count())};
        const SolvedActuators::List& acting = solutions.acting;
        if (acting.empty()) return move;
        const Eigen::MatrixXd acting_A = A(Eigen::all, acting);
        const Eigen::VectorXd change =
            change_after(solutions.gradient, acting, acting_A, acting_A.transpose() * solutions.forces, now);
        move.change(acting) = change;
        move.dx -= solutions.forces * change;
        return move;
    }

    /// (acting) change of the scaled multipliers `now` after a step of -`gradient`. `A`: (3 free, acting) gradients of
    /// the measures; `S`: how these yield to the multipliers.
    [[nodiscard]] Eigen::VectorXd change_after(const Eigen::VectorXd& gradient, const SolvedActuators::List& acting,
                                               const Eigen::MatrixXd& A, const Eigen::MatrixXd& S,
                                               const Eigen::VectorXd& now) const {
        const Eigen::VectorXd violation =
            evaluation_.constraint_violation(solved_.actuators())(acting) - A.transpose() * gradient;
        return solved_.change(acting, with_gas(S, acting), violation, now(acting));
    }

    /// With the compliance of sealed gas.
    [[nodiscard]] Eigen::MatrixXd with_gas(Eigen::MatrixXd S, const SolvedActuators::List& acting) const {
        S.diagonal() += compliances()(acting);
        return S;
    }

    /// One solution with all constraints, where the curvature offers that. Cables that turn out to push become slack,
    /// those that turn out too long are pulled, and it is repeated.
    [[nodiscard]] std::optional<Move> solve_constrained(const Terms& terms) {
        if (by_gaps_ || compliances().any()) return std::nullopt;
        const auto& [gradient, forces, now] = terms;
        const Eigen::VectorXd violation = evaluation_.constraint_violation(solved_.actuators());
        std::vector<bool> holds = solved_.taut(now, violation);
        for (Eigen::Index round = 0; round < 2 * solved_.count() + 2; ++round) {
            std::vector<Eigen::Index> held;
            Move move{{}, -now};  // slack cables lose their tension
            for (Eigen::Index k = 0; k < solved_.count(); ++k) {
                if (!holds[static_cast<std::size_t>(k)]) continue;
                held.push_back(k);
                move.change[k] = 0;
            }
            if (held.empty()) return std::nullopt;
            auto found = curvature_.solve_constrained(-gradient - forces * move.change, forces(Eigen::all, held),
                                                      -violation(held));
            if (!found) return std::nullopt;
            move.dx = std::move(found->motion);
            move.change(held) = found->multipliers;
            if (solved_.settle(holds, now + move.change, violation + forces.transpose() * move.dx)) return move;
        }
        return std::nullopt;
    }

    /// A step whose contact and friction are solved as they are, for a direction of which the whole cannot be taken.
    /// `cut_short`: because it leads through something. Pairs further away are taken in until none of them is met
    /// unseen.
    bool step_through_contact(const Terms& terms, bool cut_short) {
        if (system_.model().contact(controls_.met) == nullptr || by_gaps_ || controls_.of_means()) return false;
        const bool rubs = controls_.friction && !controls_.friction->pairs().empty();
        if (!cut_short && !rubs && !system_.touches(state_, controls_)) return false;
        for (const double beyond : {0.5, 1.0, 2.0, 4.0}) {
            const ContactStep contact(system_, state_, controls_, beyond);
            if (contact.size() > most_contact) return false;
            if (contact.nodes().empty() || holds_rollers(contact.nodes())) continue;
            std::optional<Reduced> reduced = reduce_to(contact, terms);
            if (!reduced) return false;
            const auto pressed = contact.solve(reduced->compliance, reduced->without_m);
            if (!pressed) continue;
            const std::optional<Direction> direction = find_direction_under(*pressed, *std::move(reduced), terms);
            if (!direction) return false;
            SearchLine line = line_along(*direction);
            return search(*direction, line, {line.longest(), smallest_contact_share * line.longest()});
        }
        return false;
    }

    /// Rollers are held along some directions, in which they have no compliance.
    [[nodiscard]] bool holds_rollers(const std::vector<int>& nodes) const {
        return std::ranges::any_of(system_.rollers(), [&](const FreeRoller& roller) {
            return std::ranges::binary_search(nodes, static_cast<int>(roller.free));
        });
    }

    /// A step without contact, and what is left of it at the nodes that touch.
    struct Reduced {
        const linalg::Cholesky* factor;  ///< of the tangent of everything except contact
        Eigen::VectorXd others;          ///< (3 free) gradient of everything except contact
        Solutions solutions;             ///< for it, and for the constraints
        Eigen::MatrixXd compliance;      ///< of the nodes that touch
        Eigen::VectorXd without_m;       ///< their motion
    };
    [[nodiscard]] std::optional<Reduced> reduce_to(const ContactStep& contact, const Terms& terms) {
        Reduced reduced{curvature_.factor_without_contact(), terms.gradient - contact.gradient(), {}, {}, {}};
        if (reduced.factor == nullptr) return std::nullopt;
        const Eigen::Index solved = solved_.count();
        Eigen::MatrixXd columns(reduced.others.size(), 1 + solved);
        columns.col(0) = reduced.others;
        columns.rightCols(solved) = terms.forces;
        reduced.factor->solve(view(columns), static_cast<int>(columns.cols()));
        reduced.solutions = {columns.col(0), columns.rightCols(solved), solved_.list()};
        const Move without = combine(reduced.solutions, terms.forces, terms.multipliers);

        const std::vector<int> rows = contact.rows();
        reduced.without_m = without.dx(rows);
        Eigen::MatrixXd& compliance = reduced.compliance;
        compliance.resize(contact.size(), contact.size());
        reduced.factor->inverse_part(rows, view(compliance));
        hold(rows, reduced.solutions, terms.forces, terms.multipliers + without.change, compliance);
        return reduced;
    }

    /// The step under the forces (3 free) that contact has at its end.
    [[nodiscard]] std::optional<Direction> find_direction_under(const Eigen::VectorXd& pressed, Reduced reduced,
                                                                const Terms& terms) const {
        reduced.solutions.gradient = reduced.others + pressed;
        reduced.factor->solve(view(reduced.solutions.gradient), 1);
        Direction direction = direction_of(combine(reduced.solutions, terms.forces, terms.multipliers), terms);
        if (!direction.dx.allFinite()) return std::nullopt;
        return direction;
    }

    /// The compliance of some rows, less what the constraints that hold prevent. `multipliers`: a cable without tension
    /// does not hold.
    void hold(const std::vector<int>& rows, const Solutions& solutions, const Eigen::MatrixXd& forces,
              const Eigen::VectorXd& multipliers, Eigen::MatrixXd& compliance) const {
        std::vector<Eigen::Index> held;
        for (Eigen::Index k = 0; k < solved_.count(); ++k) {
            if (multipliers[k] > 0 || !solved_.all()[static_cast<std::size_t>(k)].only_pulls) held.push_back(k);
        }
        if (held.empty()) return;
        const Eigen::MatrixXd S = with_gas(forces.transpose() * solutions.forces, solutions.acting)(held, held);
        const Eigen::MatrixXd yielding = solutions.forces(rows, held);  // to the multipliers
        // Not by the inverse of S: cables may be parallel.
        const Eigen::MatrixXd prevented = yielding * (linalg::pseudo_inverse(S) * yielding.transpose());
        compliance -= 0.5 * (prevented + prevented.transpose());
    }

    class SearchLine;
    [[nodiscard]] SearchLine line_along(const Direction& direction) const {
        Eigen::VectorXd motion = Eigen::VectorXd::Zero(state_.x.size());
        system_.add_free(direction.dx, 1, motion);
        return SearchLine(*this, std::move(motion));
    }

    struct Shares {
        double first, smallest;  ///< of the direction: which are tried
    };
    bool search(const Direction& direction, SearchLine& line, const Shares& shares) {
        const LineSearch::Path path{shares.first, shares.smallest, [&](double alpha) { return line.at(alpha); }};
        std::optional<LineSearch::Found> found = search_.search(
            state_, evaluation_, direction, path, [&](const State& next) { return system_.evaluate(next, controls_); });
        if (found) accept(std::move(*found));
        return found.has_value();
    }

    /// The path of a direction, as far as the robot is large: what hangs without tension has next to no stiffness, and
    /// its direction may be many times longer. The solver's retraction may rotate the body; if that path meets
    /// something, the straight one is used, up to the largest step without contact.
    class SearchLine {
    public:
        SearchLine(const StepSolver& solver, Eigen::VectorXd motion)
            : solver_(solver), motion_(std::move(motion)), whole_(share_within_reach(solver.state_.x, motion_)) {
            rotated_ = free_end(whole_);
            longest_ = rotated_ ? whole_ : straight_share(whole_) * whole_;
        }
        [[nodiscard]] double longest() const { return longest_; }
        /// By something that the straight path meets.
        [[nodiscard]] bool is_blocked() const { return longest_ < whole_; }
        /// Precondition: alpha is at most longest(), and decreases from call to call.
        [[nodiscard]] Eigen::VectorXd at(double alpha) {
            if (alpha == whole_ && rotated_) return *std::exchange(rotated_, std::nullopt);
            if (std::optional<Eigen::VectorXd> end = free_end(alpha)) return std::move(*end);
            // The straight path is known to be free up to longest() only if the whole rotated path was not free.
            const double share = is_blocked() ? 1 : straight_share(alpha);
            return solver_.state_.x + share * alpha * motion_;
        }

    private:
        [[nodiscard]] static double share_within_reach(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) {
            const double reach_m = linalg::diagonal(view(x));
            const double longest_m = linalg::longest(view(motion));
            return longest_m > reach_m ? reach_m / longest_m : 1;
        }

        /// Of the straight path for this share of the direction: what meets nothing.
        [[nodiscard]] double straight_share(double alpha) const {
            return solver_.system_.largest_step(solver_.state_.x, alpha * motion_, solver_.controls_);
        }

        /// End of the retraction for this share, if its path meets nothing.
        [[nodiscard]] std::optional<Eigen::VectorXd> free_end(double alpha) const {
            const Eigen::VectorXd& x = solver_.state_.x;
            Eigen::VectorXd end = solver_.curvature_.retract(x, alpha * motion_);
            if (!solver_.system_.is_free(x, end - x, solver_.controls_)) return std::nullopt;
            return end;
        }

        const StepSolver& solver_;
        Eigen::VectorXd motion_;
        double whole_;                            ///< share of the direction that is looked at
        std::optional<Eigen::VectorXd> rotated_;  ///< end of its retraction
        double longest_;                          ///< share that meets nothing
    };

    void accept(LineSearch::Found found) {
        // The quasi-Newton pair needs both forces at the same multipliers.
        const Eigen::VectorXd old_force =
            solved_.empty() ? evaluation_.out_of_balance : force_at(found.state.multiplier);
        curvature_.learn(system_.restrict_to_free(found.state.x - state_.x),
                         system_.restrict_to_free(found.evaluation.out_of_balance - old_force));
        curvature_.update_convergence(evaluation_.error(), found.evaluation.error());
        state_ = std::move(found.state);
        evaluation_ = std::move(found.evaluation);
        alpha_ = found.alpha;
    }

    /// Out-of-balance force at the current positions with other multipliers.
    [[nodiscard]] Eigen::VectorXd force_at(const Eigen::VectorXd& multiplier) const {
        Eigen::VectorXd force = evaluation_.out_of_balance;
        for (const Eigen::Index a : solved_.actuators()) {
            actuator(a).add_gradient(view(state_.x), multiplier[a] - state_.multiplier[a], view(force),
                                     controls_.shares[static_cast<std::size_t>(a)]);
        }
        return force;
    }

    /// Number of constraints from which on solving for the forces of each takes longer than a step less accurate.
    static constexpr Eigen::Index several = 2;
    /// Coordinates of the nodes that touch. With more of them the dense problem takes as much time as the steps that
    /// are saved.
    static constexpr Eigen::Index most_contact = 240;
    static constexpr double smallest_contact_share = 1e-2;  // of such a step

    const Equilibrium& system_;
    Curvature& curvature_;
    const Controls& controls_;
    State& state_;
    Evaluation evaluation_;
    double alpha_ = 0;
    const SolvedActuators solved_;
    LineSearch search_;
    bool by_gaps_ = false;  ///< the force of one of them is not the gradient of its measure
};

/// Counts iterations without progress.
class Patience {
public:
    Patience(int limit, double error) : limit_(limit), best_(error) {}
    [[nodiscard]] bool is_at_end(double error) {
        if (error < 0.9 * best_) {
            best_ = error;
            idle_ = 0;
        } else {
            ++idle_;
        }
        return limit_ > 0 && idle_ >= limit_;
    }

private:
    int limit_;
    double best_;
    int idle_ = 0;
};

}  // namespace

IterationRecord record(Solver solver, int iteration, const Evaluation& e, double alpha) {
    return {.solver = solver,
            .iteration = iteration,
            .residual = e.residual,
            .violation = e.violation,
            .energy_J = e.energy_J,
            .alpha = alpha,
            .min_J = e.min_J};
}

std::string no_convergence(int iterations, double residual) {
    return fmt::format("no convergence in {}, residual {:.2e}",
                       counted(static_cast<std::size_t>(iterations), "iteration"), residual);
}

std::string no_step(Evaluation::Flaw obstacle, double residual) {
    if (obstacle == Evaluation::Flaw::none) return fmt::format("no step lowers the energy, residual {:.2e}", residual);
    return fmt::format("every step that lowers the energy {}, residual {:.2e}", name(obstacle), residual);
}

StepOutcome solve_step(const Equilibrium& system, Curvature& curvature, const Controls& controls,
                       const StepSettings& settings, State& state, const Progress& progress,
                       std::optional<Evaluation> known) {
    StepSolver solver(system, curvature, controls, state, std::move(known));
    StepOutcome outcome;
    outcome.solver = curvature.solver();
    outcome.history.push_back(record(outcome.solver, 0, solver.evaluation(), 0));
    const int limit = settings.iteration_limit > 0 ? settings.iteration_limit : curvature.default_iteration_limit();
    Patience patience(settings.patience, solver.evaluation().error());
    const auto residual = [&] { return solver.evaluation().residual; };
    while (!(outcome.converged = solver.converged(settings.tolerance))) {
        if (progress.cancelled()) {
            outcome.reason = "cancelled";
            break;
        }
        if (outcome.iterations == limit) {
            outcome.reason = no_convergence(limit, residual());
            break;
        }
        ++outcome.iterations;
        if (!solver.iterate(TangentChoice::quickest, settings.tolerance) &&
            !solver.iterate(TangentChoice::exact, settings.tolerance) &&
            !solver.iterate(TangentChoice::projected, settings.tolerance)) {
            outcome.reason = no_step(solver.obstacle(), residual());
            break;
        }
        outcome.history.push_back(record(outcome.solver, outcome.iterations, solver.evaluation(), solver.alpha()));
        if (patience.is_at_end(solver.evaluation().error()) && !solver.converged(settings.tolerance)) {
            outcome.reason = fmt::format("no progress in {}, residual {:.2e}",
                                         counted(static_cast<std::size_t>(settings.patience), "iteration"), residual());
            break;
        }
    }
    outcome.evaluation = solver.evaluation();
    return outcome;
}

}  // namespace pliant::sim
