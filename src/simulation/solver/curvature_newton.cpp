#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/core/aligned_array.hpp"
#include "base/core/parallel.hpp"
#include "base/linalg/gmres.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/solver/body_rotation.hpp"
#include "simulation/solver/corner_nesting.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/factor_without_contact.hpp"
#include "simulation/solver/object_holds.hpp"
#include "simulation/solver/step_memory.hpp"
#include "simulation/solver/tangent_inverse.hpp"

namespace pliant::sim {
namespace {

using Effort = TangentInverse::Effort;

class Newton final : public Curvature, private NewtonRates {
public:
    Newton(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system),
          laplacian_(&laplacian),
          layout_(laplacian.tangent_layout()),
          rotation_(system, laplacian),
          without_contact_(system, laplacian) {
        corners_ = nest_in_corners(system.model());
        two_levels_ = starts_on_two_levels();
        inverse_ = make_inverse();
    }

    [[nodiscard]] Solver solver() const override { return Solver::newton; }
    [[nodiscard]] int default_iteration_limit() const override { return 100; }

    [[nodiscard]] double smallest_share() const override { return reused_ && !crawls() ? smallest_reused_share : 1e-7; }

    /// An inverse from an earlier step of the program is expected to perform as its predecessor did; this expectation
    /// fades, so that reuse is tried again eventually.
    void restart() override {
        hasty_ = false;
        left_by_new_ = 0;
        if (age_++ > 0) return;
        left_ = left_at_first_;
        left_at_first_ = hoped_left * std::pow(left_at_first_ / hoped_left, memory_of_first);
    }

    [[nodiscard]] bool refresh(const State& state, const Controls& controls, TangentChoice choice,
                               Errors errors) override {
        // Where no residual is named, a direction is all that is wanted.
        const double far = errors.wanted > 0 ? errors.residual / errors.wanted : 1;
        const bool reuse = choice == TangentChoice::quickest && usable_ && pays(far);
        if (!reuse && choice == TangentChoice::exact && !reused_)
            return false;  // it is already the exact one of this
                           // state
        if (reused_ && choice != TangentChoice::quickest) update_old_factor(most_left);
        reused_ = reuse;
        at_ = {&state, &controls};
        const double error = std::max(errors.residual, errors.violation);
        enough_ = solution_error(error, errors.wanted);
        straight_ = left_by_last_ < well_led && error * error < straight_share * errors.wanted;
        if (!reuse) return take_tangent(choice == TangentChoice::projected);
        remember();
        rotation_.follow(state.x);
        return true;
    }

    /// The error of a straight step grows with its square: a short step needs no rotation. A small residual means a
    /// short step, unless the body is extremely soft; then steps do not converge fast anyway.
    [[nodiscard]] Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) const override {
        const Eigen::VectorXd end = x + motion;
        return straight_ ? end : laplacian_->rotate(*system_, {.now = x.data(), .end = end.data()});
    }

    /// Without the skew part of torques, which solve_with_torques() adds.
    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override {
        StepPair pair{step, change};
        if (torques_.turns.cols() > 0)
            pair.change -= torques_.turns * (torques_.skew * (torques_.turns.transpose() * step));
        learnt_ = std::make_shared<const StepPair>(std::move(pair));
    }

    /// Without a tangent there is nothing to carry over. What is left of an earlier program, as the last rotation, must
    /// not get into it: equal steps give equal states.
    [[nodiscard]] std::shared_ptr<const SolverMemory> memory() const override {
        if (!tangent_) return nullptr;
        auto memory = std::make_shared<SolverMemory>();
        memory->tangent = tangent_;
        if (inverse_->keeps_matrix()) memory->base = base();
        memory->inverse = inverse_->memory();
        memory->rates = *this;
        memory->touching = room_for_;
        memory->forgets_touching = touching_.empty();
        memory->pairs = memory_.pairs();
        memory->learnt = learnt_;
        memory->followed = rotation_.followed();
        memory->layout = layout_;
        memory->analysis = analysis_;
        return memory;
    }

    void recall(const SolverMemory* memory) override {
        SolverMemory none;
        none.rates.two_levels_ = starts_on_two_levels();
        const SolverMemory& known = memory != nullptr ? *memory : none;
        const bool same_pattern = recall_pattern(known);
        const SolverMemory::Matrix base_at_hand = base();
        const bool is_at_hand = same_pattern && usable_ && tangent_ == known.tangent && share_ == known.rates.share_ &&
                                inverse_->memory().in_double == known.inverse.in_double &&
                                (!inverse_->keeps_matrix() || base_at_hand == known.base);
        if (!is_at_hand) has_tangent_ = has_projection_ = false;
        static_cast<NewtonRates&>(*this) = known.rates;
        tangent_ = known.tangent;
        memory_.set_pairs(known.pairs);
        learnt_ = known.learnt;
        if (!tangent_) {
            if (same_pattern) renew_inverse();  // without what the last one learned about its precision
            return;
        }
        rotation_.begin(tangent_->state.x);
        if (known.followed) rotation_.follow(*known.followed);
        if (!usable_) return;
        if (is_at_hand) return inverse_->restore(known.inverse);
        if (inverse_->keeps_matrix())
            recall_levels(known, same_pattern ? base_at_hand : SolverMemory::Matrix{});
        else
            recall_tangent(known.inverse);
    }

    void update_convergence(double before, double after) override {
        left_by_last_ = after / before;
        if (reused_) {
            ++uses_;
            return update_old_factor(std::clamp(after / before, least_left, most_left));
        }
        uses_ = 0;
        left_by_new_ = after < nearby ? after / before : 0;
        // If even the exact tangent reduces the error little, the state changes too much for an old one.
        left_ = after > hoped_left * before ? most_left : hoped_left;
        age_ = 0;
        tried_later_ = false;
    }

    void solve(Eigen::MatrixXd& columns) override {
        torques_ = system_->torque_skew(*at_.state, *at_.controls);
        if (system_->has_skew()) {
            for (Eigen::Index k = 0; k < columns.cols(); ++k) columns.col(k) = solve_with_skew(columns.col(k));
        } else if (torques_.turns.cols() > 0) {
            solve_with_torques(columns);
        } else {
            solve_symmetric(columns);
        }
    }

    [[nodiscard]] const Yielding* yielding_to(const Forces& forces) override {
        if (!usable_ || system_->has_skew() || system_->has_torques()) return nullptr;
        const YieldingOf of{tangent_, share_, inverse_->memory().in_double, forces.actuators};
        if (of == yielding_of_) return &yielding_;
        yielding_of_ = {};
        const Eigen::MatrixXd B = forces.at(tangent_->state.x, tangent_->controls);
        yielding_.motions = B;
        if (!inverse_->solve_plainly(yielding_.motions, largest_solution_error)) return nullptr;
        yielding_.compliance = B.transpose() * yielding_.motions;
        yielding_of_ = of;
        return &yielding_;
    }

    [[nodiscard]] Eigen::VectorXd push_forward(const Eigen::VectorXd& motion) const override {
        Eigen::MatrixXd column = motion;
        rotation_.push_forward_motions(column);
        return column;
    }

    [[nodiscard]] std::optional<Constrained> solve_constrained(const Eigen::VectorXd& force,
                                                               const Eigen::MatrixXd& normals,
                                                               const Eigen::VectorXd& wanted) override {
        if (reused_ || system_->has_skew() || system_->has_torques() || !inverse_->takes_constraints())
            return std::nullopt;
        using Outcome = TangentInverse::Outcome;
        Constrained found;
        for (;;) {
            found.motion = force;
            const Outcome outcome =
                inverse_->solve_constrained(found.motion, {normals, wanted}, found.multipliers, enough_);
            if (outcome == Outcome::solved) return found;
            if (outcome == Outcome::slow || share_ >= 1 ||
                !project(share_ == 0 ? smallest_share_of_projection : std::min(4 * share_, 1.0)))
                return std::nullopt;
        }
    }

    [[nodiscard]] const linalg::Cholesky* factor_without_contact() override {
        return reused_ || system_->has_skew() ? nullptr : without_contact_.at(tangent_);
    }

private:
    /// The skew part needs the inverse of the exact tangent.
    [[nodiscard]] std::unique_ptr<TangentInverse> make_inverse() {
        if (two_levels_) return make_levels_inverse(layout_->pattern, corners_);
        if (!analysis_) analysis_ = room_for_ ? linalg::analyse(layout_->pattern) : laplacian_->analysis();
        return make_direct_inverse(analysis_, system_->has_skew());
    }

    void renew_inverse() {
        inverse_ = make_inverse();
        set_ = base_ = {};
    }

    /// True if a factor from an earlier state is expected to reduce the error, which is `far` times the tolerance, at
    /// less than the cost of a new one. The skew part belongs to the state at which it was computed, and GMRES needs a
    /// single matrix.
    [[nodiscard]] bool pays(double far) const {
        if (system_->has_skew()) return false;
        if (crawls()) return true;
        return !hasty_ && std::max(1.0, std::log(far) / -std::log(left_)) <= inverse_->factorisation_cost();
    }

    /// True if, close to equilibrium, even the exact tangent makes little progress: it had to be made positive
    /// definite, which hides how soft the body is in its buckling direction. A few steps with one inverse reveal that
    /// (StepMemory), however short they are.
    [[nodiscard]] bool crawls() const {
        return share_ > 0 && left_by_new_ > hopeless && uses_ < static_cast<int>(most_steps);
    }

    /// Accuracy of the linear solve for a step (an inexact Newton method: Dembo, Eisenstat and Steihaug 1982). Far from
    /// equilibrium the step leaves a good part of the error however accurate the solve; close to it each further digit
    /// is one that the next step need not find.
    [[nodiscard]] static double solution_error(double now, double wanted) {
        if (now > nearby) return largest_solution_error;
        if (now <= 0) return 0;
        return std::min(share_of_wanted * wanted / now, largest_solution_error);
    }

    /// Records the error left by a step with an inverse from an earlier state.
    void update_old_factor(double left) {
        left_ = left;
        hasty_ = left > slow;
        if (age_ > 0 && !std::exchange(tried_later_, true)) left_at_first_ = left;
    }

    /// Stores the last step pair, rotated back to the state where the factor was made.
    void remember() {
        if (!learnt_) return;
        Eigen::VectorXd step = learnt_->step, change = learnt_->change;
        learnt_.reset();
        rotation_.pull_back_step(step, change);
        memory_.learn(step, change);
    }

    void solve_symmetric(Eigen::MatrixXd& columns) {
        rotation_.pull_back_forces(columns);
        memory_.apply(columns, [&](Eigen::MatrixXd& c) { solve_with_inverse(c); });
        rotation_.push_forward_motions(columns);
    }

    /// With the skew part of torques, which is of low rank, by the identity of Woodbury. Beside the resistance to their
    /// rotations it is not small where they bend a body far: about equal to it at a right angle.
    void solve_with_torques(Eigen::MatrixXd& columns) {
        const Eigen::MatrixXd& turns = torques_.turns;
        Eigen::MatrixXd all(columns.rows(), columns.cols() + turns.cols());
        all << columns, turns;
        solve_symmetric(all);
        columns = all.leftCols(columns.cols());
        const Eigen::MatrixXd yielding = all.rightCols(turns.cols());
        const Eigen::MatrixXd system =
            Eigen::MatrixXd::Identity(turns.cols(), turns.cols()) + torques_.skew * (turns.transpose() * yielding);
        columns -= yielding * system.partialPivLu().solve(torques_.skew * (turns.transpose() * columns)).eval();
    }

    void solve_with_inverse(Eigen::MatrixXd& columns) {
        using Outcome = TangentInverse::Outcome;
        const Eigen::MatrixXd right = columns;
        Outcome outcome = inverse_->solve(columns, enough_);
        if (outcome == Outcome::slow) {
            two_levels_ = false;
            renew_inverse();
            usable_ = false;
        }
        // Indefiniteness was only detected while solving.
        while (outcome == Outcome::indefinite && !reused_ && share_ < 1 &&
               project(share_ == 0 ? smallest_share_of_projection : std::min(4 * share_, 1.0))) {
            columns = right;
            outcome = inverse_->solve(columns, enough_);
        }
    }

    /// Sets the tangent itself or, if it is not positive definite, with the smallest sufficient share of its positive
    /// projection: a small share preserves the buckling direction, the full projection is safe but slow.
    [[nodiscard]] bool take_tangent(bool cautious) {
        make_room_for_contact();
        cautious_ = cautious;
        memory_.clear();
        learnt_.reset();
        rotation_.begin(at_.state->x);
        tangent_ = std::make_shared<const SolverMemory::Tangent>(SolverMemory::Tangent{*at_.state, *at_.controls});
        positions_ = system_->free_positions(at_.state->x);
        has_tangent_ = has_projection_ = false;
        share_ = 0;
        if (!inverse_->keeps_matrix()) assemble(false, values_);
        if (!cautious && (usable_ = set_tangent())) {
            share_wanted_ = smallest_share_of_projection;
            return true;
        }
        return project(cautious ? 1 : std::max(0.5 * share_wanted_, smallest_share_of_projection));
    }

    [[nodiscard]] bool set_tangent() {
        return inverse_->keeps_matrix() ? set_levels(0, linalg::Reuse::turned)
                                        : inverse_->set(values_.span(), positions_, Effort::usual);
    }

    /// Sets the tangent with `share` of its projection, or more if necessary.
    [[nodiscard]] bool project(double share) {
        if (share_ == 0 && !inverse_->keeps_matrix()) assemble(true, projected_);
        for (; share <= 1; share *= 2) {
            share_wanted_ = share;
            if (inverse_->keeps_matrix()) {
                usable_ = set_levels(share, linalg::Reuse::turned);
            } else {
                share_ = share;
                blend();
                usable_ = inverse_->set(blended_.span(), positions_, share < 1 ? Effort::little : Effort::all);
            }
            if (usable_) return true;
        }
        return false;
    }

    /// Sets the tangent with `share` of its projection: of a large body in the memory of one matrix, so that each share
    /// takes both to be assembled.
    [[nodiscard]] bool set_levels(double share, linalg::Reuse reuse) {
        base_ = base();
        set_ = {tangent_, share_ = share};
        const bool keep = layout_->pattern.entries() <= most_kept;
        if (!has_tangent_) assemble(false, values_);
        has_tangent_ = true;
        inverse_->take(values_.span(), positions_);
        if (share > 0) {
            AlignedArray<double>& projection = keep ? projected_ : values_;
            if (!has_projection_) assemble(true, projection);
            has_tangent_ = has_projection_ = keep;
            inverse_->move_towards(projection.span(), share);
        }
        return inverse_->prepare(reuse);
    }

    /// The matrix that the coarse level was made for.
    [[nodiscard]] SolverMemory::Matrix base() const { return inverse_->is_turned() ? base_ : set_; }

    /// (tangent + skew)^-1 b by GMRES, right-preconditioned with H^-1. If H is the tangent, the product is v + skew
    /// H^-1 v. If H had to be made positive definite it is not: the tangent's symmetric part may be indefinite although
    /// the body is stable, because pressure on a patch with a free rim has no potential, and steps with H alone would
    /// each make only partial progress. They are used only for the projected choice.
    [[nodiscard]] Eigen::VectorXd solve_with_skew(const Eigen::VectorXd& b) {
        const auto precondition = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
            Eigen::MatrixXd column = v;
            solve_with_inverse(column);
            return column;
        };
        const auto multiply = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
            const Eigen::VectorXd w = precondition(v);
            Eigen::VectorXd product = system_->apply_skew(tangent_->state, w);
            if (torques_.turns.cols() > 0)
                product += torques_.turns * (torques_.skew * (torques_.turns.transpose() * w));
            if (share_ == 0 || cautious_) return v + product;
            linalg::add_product(layout_->pattern, values_.span(), linalg::view(w), 1, linalg::view(product));
            return product;
        };
        return precondition(linalg::gmres(multiply, b, skew_tolerance, skew_limit));
    }

    /// Contact couples nodes that no element does: if a pair is new, the pattern is rebuilt and analysed again.
    void make_room_for_contact() {
        bool grown = false;
        for (std::vector<int>& clique : system_->contact_cliques(*at_.state, *at_.controls)) {
            if (holds(clique)) continue;
            touching_.push_back(std::move(clique));
            grown = true;
        }
        if (!grown) return;
        room_for_ = std::make_shared<const SolverMemory::Cliques>(touching_);
        layout_ = std::make_shared<const TangentLayout>(system_->lay_out_tangent(touching_));
        analysis_ = nullptr;
        renew_inverse();
        // Pairs that have separated are dropped next time, so that the pattern does not grow without bound.
        if (touching_.size() > most_remembered) touching_.clear();
    }

    /// True if the pattern couples all nodes of a clique.
    [[nodiscard]] bool holds(const std::vector<int>& clique) const {
        for (const int i : clique) {
            for (const int j : clique) {
                if (j < 0 || i < j) continue;
                if (!layout_->pattern.holds(i, j)) return false;
            }
        }
        return true;
    }

    /// Assembles at the state where the tangent was taken.
    void assemble(bool project, AlignedArray<double>& values) const {
        values.resize(layout_->pattern.entries());
        parallel_clear(values.span());
        system_->add_tangent(tangent_->state, tangent_->controls, *layout_, values.span(), project);
        add_object_holds(*system_, tangent_->state, tangent_->controls, *layout_, values.span());
    }

    [[nodiscard]] bool starts_on_two_levels() const {
        if (system_->has_skew()) return false;
        return levels_are_quicker(laplacian_->tangent_layout()->pattern, corners_.has_value(), laplacian_->work());
    }

    /// False if the inverse had to be rebuilt for it.
    [[nodiscard]] bool recall_pattern(const SolverMemory& known) {
        room_for_ = known.touching;
        touching_ = known.forgets_touching || !room_for_ ? SolverMemory::Cliques{} : *room_for_;
        auto layout = !room_for_     ? laplacian_->tangent_layout()
                      : known.layout ? known.layout
                                     : std::make_shared<const TangentLayout>(system_->lay_out_tangent(*room_for_));
        if (layout == layout_ && known.rates.two_levels_ == two_levels_) return true;
        layout_ = std::move(layout);
        analysis_ = room_for_ ? known.analysis : nullptr;
        two_levels_ = known.rates.two_levels_;
        renew_inverse();
        return false;
    }

    /// `at_hand`: the matrix that the present coarse level was made for.
    void recall_levels(const SolverMemory& known, const SolverMemory::Matrix& at_hand) {
        const SolverMemory::Matrix own{known.tangent, known.rates.share_};
        const SolverMemory::Matrix& base = known.base.tangent ? known.base : own;
        if (base == own) {
            set_again(own, base == at_hand ? linalg::Reuse::kept : linalg::Reuse::none);
        } else {
            if (base != at_hand) set_again(base, linalg::Reuse::none);
            set_again(own, linalg::Reuse::turned);
        }
        inverse_->restore(known.inverse);
    }

    void set_again(const SolverMemory::Matrix& matrix, linalg::Reuse reuse) {
        tangent_ = matrix.tangent;
        positions_ = system_->free_positions(tangent_->state.x);
        has_tangent_ = has_projection_ = false;
        if (!set_levels(matrix.share, reuse)) usable_ = false;  // of a state that was tampered with
    }

    void recall_tangent(const TangentInverse::Memory& memory) {
        positions_ = system_->free_positions(tangent_->state.x);
        assemble(false, values_);
        if (share_ > 0) {
            assemble(true, projected_);
            blend();
        }
        inverse_->recall(share_ > 0 ? blended_.span() : values_.span(), memory);
    }

    /// Adds its share of the projection to the tangent.
    void blend() {
        blended_.resize(values_.size());
        for (std::size_t k = 0; k < values_.size(); ++k)
            blended_[k] = values_[k] + share_ * (projected_[k] - values_[k]);
    }

    static constexpr double smallest_reused_share = 0.2;
    static constexpr std::size_t most_steps = 8;
    static constexpr double memory_of_first = 0.85;
    static constexpr double least_left = 1e-3, most_left = 0.95, slow = 0.4, hopeless = 0.9, nearby = 0.05;
    static constexpr double share_of_wanted = 0.02, largest_solution_error = 0.05;
    static constexpr double straight_share = 0.05;  // of the tolerance: error that a step without rotation may add
    static constexpr double well_led = 0.3;
    static constexpr std::size_t most_remembered = 20000;
    static constexpr std::size_t most_kept = 8000000;  // entries of a matrix that may be in memory twice
    static constexpr double skew_tolerance = 1e-8;
    static constexpr int skew_limit = 60;

    const Equilibrium* system_;
    const FactoredLaplacian* laplacian_;
    std::shared_ptr<const TangentLayout> layout_;
    std::shared_ptr<const linalg::Analysis> analysis_;  ///< of its pattern, computed on demand
    std::unique_ptr<TangentInverse> inverse_;
    AlignedArray<double> values_;                        ///< tangent, or the part of it that was set last
    AlignedArray<double> projected_;                     ///< its positive projection, computed on demand
    bool has_tangent_ = false, has_projection_ = false;  ///< on levels: whether they are those of this state
    AlignedArray<double> blended_;
    struct {
        const State* state;
        const Controls* controls;
    } at_{};                                  ///< the current state, until it is solved
    Equilibrium::TorqueSkew torques_;         ///< at the state that was solved last
    std::optional<linalg::Nesting> corners_;  ///< of quadratic tets, if they form the second level
    double enough_ = 0;                       ///< error of the next solution
    bool straight_ = false;                   ///< the next step needs no rotation
    Eigen::VectorXd positions_;               ///< of the free nodes, where the tangent was made
    Yielding yielding_;
    struct YieldingOf {
        std::shared_ptr<const SolverMemory::Tangent> tangent;
        double share = 0;
        bool in_double = false;
        std::vector<Eigen::Index> actuators{};
        bool operator==(const YieldingOf&) const = default;
    } yielding_of_;                           ///< the factor and the actuators that it was computed with
    BodyRotation rotation_;                   ///< since the factor was made
    FactorWithoutContact without_contact_;    ///< for the nodes that touch
    StepMemory memory_{most_steps};           ///< of the steps since then, rotated back to the state of the factor
    std::shared_ptr<const StepPair> learnt_;  ///< not yet in the memory
    SolverMemory::Cliques touching_;          ///< contact pairs to be included in the next pattern
    std::shared_ptr<const SolverMemory::Cliques> room_for_;  ///< those included in the current pattern
    std::shared_ptr<const SolverMemory::Tangent> tangent_;   ///< the state at which it was made
    SolverMemory::Matrix set_;                               ///< of levels: the matrix that was set last,
    SolverMemory::Matrix base_;                              ///< and that of their coarse level, if it was turned
};

}  // namespace

std::unique_ptr<Curvature> make_newton(const Equilibrium& system, const FactoredLaplacian& laplacian) {
    return std::make_unique<Newton>(system, laplacian);
}

}  // namespace pliant::sim
