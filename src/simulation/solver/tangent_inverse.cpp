#include "simulation/solver/tangent_inverse.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/linalg/cholesky.hpp"
#include "base/linalg/two_level.hpp"
#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

using linalg::view;

/// The smallest error of a solve: it determines the convergence rate for the last digits of a state.
constexpr double least_error = 1e-3;

/// A Newton step needs few digits, so the factor is in single precision until that proves insufficient.
class DirectInverse final : public TangentInverse {
public:
    explicit DirectInverse(linalg::Cholesky factor) : factor_(std::move(factor)) {}

    [[nodiscard]] bool set(std::span<const double> values, const Eigen::VectorXd&, Effort effort) override {
        if (factorise(values)) return true;
        if (!is_single() || effort == Effort::little) return false;
        if (effort == Effort::usual && ++refusals_ % refusals_until_asked != 0) return false;
        // Double precision shows whether the matrix is indefinite or only ill-conditioned.
        factor_.use(linalg::Precision::double_);
        if (factorise(values)) return true;
        if (effort == Effort::usual) factor_.use(linalg::Precision::single_);
        return false;
    }

    /// The first solution with a single-precision factor is refined, unless the factor is known to be accurate enough.
    [[nodiscard]] Outcome solve(Eigen::MatrixXd& columns, double error) override {
        const int count = static_cast<int>(columns.cols());
        const double wanted = std::max(error, least_error);
        if (!std::exchange(untried_, false) || known_error_ <= wanted) {
            factor_.solve(view(columns), count);
            return Outcome::solved;
        }
        const Eigen::MatrixXd right = columns;
        if (const auto first = factor_.solve_and_refine(values_, view(columns), count, wanted, most_refinements)) {
            known_error_ = *first;
            trusted_ = trust;
            return Outcome::solved;
        }
        const Eigen::MatrixXd refined = std::exchange(columns, right);
        factor_.use(linalg::Precision::double_);
        if (factorise(values_))
            factor_.solve(view(columns), count);
        else
            columns = refined;
        return Outcome::solved;
    }

    [[nodiscard]] bool solve_plainly(Eigen::MatrixXd& columns, double error) const override {
        if (is_single() && !(known_error_ <= error)) return false;
        factor_.solve(view(columns), static_cast<int>(columns.cols()));
        return true;
    }

    [[nodiscard]] Memory memory() const override { return {!is_single(), untried_, known_error_, trusted_, refusals_}; }

    void recall(std::span<const double> values, const Memory& memory) override {
        factor_.use(memory.in_double ? linalg::Precision::double_ : linalg::Precision::single_);
        (void)factorise(values);
        restore(memory);
    }

    void restore(const Memory& memory) override {
        untried_ = memory.untried;
        known_error_ = memory.known_error;
        trusted_ = memory.trusted;
        refusals_ = memory.refusals;
    }

    /// A factorisation uses every number many times, a solve reads it a few times. Measured, in nanoseconds: 0.05 per
    /// multiply-add, and 3.5 per entry; setting up and solving are included in both.
    [[nodiscard]] double factorisation_cost() const override {
        return 1.3 + factor_.factor_work() / (70 * factor_.factor_entries());
    }

private:
    [[nodiscard]] bool is_single() const { return factor_.precision() == linalg::Precision::single_; }
    [[nodiscard]] bool factorise(std::span<const double> values) {
        values_ = values;
        untried_ = is_single();
        if (trusted_ > 0)
            --trusted_;
        else
            known_error_ = std::numeric_limits<double>::infinity();
        return factor_.factorise(values);
    }

    static constexpr int refusals_until_asked = 4;  // trying double precision is expensive
    static constexpr int most_refinements = 8;      // with more of them, double precision is faster
    static constexpr int trust = 3;                 // number of factors assumed to be as accurate after one was tested

    linalg::Cholesky factor_;
    std::span<const double> values_;  ///< of the factor
    bool untried_ = false;            ///< nothing has been solved with this factor, so it may need refinement
    double known_error_ = std::numeric_limits<double>::infinity();  ///< of its solutions, if known
    int trusted_ = 0;                                               ///< number of further factors that need no test
    int refusals_ = 0;                                              ///< by single precision
};

class LevelsInverse final : public TangentInverse {
public:
    LevelsInverse(linalg::TwoLevel levels, int most_iterations)
        : levels_(std::move(levels)), most_iterations_(most_iterations) {}

    [[nodiscard]] bool set(std::span<const double> values, const Eigen::VectorXd& positions, Effort) override {
        return levels_.set(values, view(positions));
    }
    [[nodiscard]] bool keeps_matrix() const override { return true; }
    void take(std::span<const double> values, const Eigen::VectorXd& positions) override {
        levels_.take(values, view(positions));
    }
    void move_towards(std::span<const double> values, double share) override { levels_.move_towards(values, share); }
    [[nodiscard]] bool prepare(linalg::Reuse reuse) override { return levels_.prepare(reuse); }
    [[nodiscard]] bool is_turned() const override { return levels_.is_turned(); }

    [[nodiscard]] Outcome solve(Eigen::MatrixXd& columns, double error) override {
        const int count = static_cast<int>(columns.cols());
        return outcome_of(levels_.solve(view(columns), count, std::max(error, least_error), most_iterations_));
    }

    [[nodiscard]] bool takes_constraints() const override { return true; }
    [[nodiscard]] Outcome solve_constrained(Eigen::VectorXd& column, const Constraints& constraints,
                                            Eigen::VectorXd& multipliers, double error) override {
        multipliers.resize(constraints.wanted.size());
        return outcome_of(levels_.solve_constrained(view(column), {view(constraints.normals), view(constraints.wanted)},
                                                    view(multipliers), std::max(error, least_error), most_iterations_));
    }

    [[nodiscard]] Memory memory() const override { return {.usual_gain = levels_.usual_gain()}; }
    void restore(const Memory& memory) override { levels_.set_usual_gain(memory.usual_gain); }

    /// Setting a new matrix is nearly free.
    [[nodiscard]] double factorisation_cost() const override { return 0; }

private:
    [[nodiscard]] static Outcome outcome_of(linalg::TwoLevel::Outcome outcome) {
        switch (outcome) {
            case linalg::TwoLevel::Outcome::solved:
                return Outcome::solved;
            case linalg::TwoLevel::Outcome::indefinite:
                return Outcome::indefinite;
            case linalg::TwoLevel::Outcome::slow:
                break;
        }
        return Outcome::slow;
    }

    linalg::TwoLevel levels_;
    int most_iterations_;
};

double pairs_of(const linalg::SymmetricPattern& pattern) {
    return 2 * static_cast<double>(pattern.node_row.size()) - pattern.nodes;
}

}  // namespace

std::unique_ptr<TangentInverse> make_direct_inverse(std::shared_ptr<const linalg::Analysis> analysis, bool exact) {
    return std::make_unique<DirectInverse>(
        linalg::Cholesky(std::move(analysis), 3, exact ? linalg::Precision::double_ : linalg::Precision::single_));
}

std::unique_ptr<TangentInverse> make_levels_inverse(const linalg::SymmetricPattern& pattern,
                                                    const std::optional<linalg::Nesting>& corners) {
    // Ten iterations do in a usual body. Of a body of few corners a factor would be faster than more than 40.
    constexpr int usual_limit = 100, limit_of_few_corners = 40;
    if (!corners) return std::make_unique<LevelsInverse>(linalg::TwoLevel(pattern), usual_limit);
    const bool few = corners->coarse_nodes <= linalg::most_factored_corners;
    return std::make_unique<LevelsInverse>(linalg::TwoLevel(pattern, *corners),
                                           few ? limit_of_few_corners : usual_limit);
}

bool levels_are_quicker(const linalg::SymmetricPattern& pattern, bool nested, double factor_work) {
    // Multiply-adds of a factorisation, per pair of nodes, that take as long as conjugate gradients on two levels
    // (measured: 10,000 with groups), and half as much again, because ill-conditioned bodies slow them down, but not a
    // factor.
    constexpr double even_with_groups = 15000, even_with_corners = 6000;
    return 27 * factor_work > (nested ? even_with_corners : even_with_groups) * pairs_of(pattern);
}

}  // namespace pliant::sim
