#include <algorithm>

#include "linalg/cholesky.hpp"
#include "linalg/gmres.hpp"
#include "sim/curvature.hpp"
#include "sim/elements.hpp"
#include "sim/step_memory.hpp"

namespace pliant::sim {
namespace {

class Newton final : public Curvature {
public:
    Newton(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system),
          laplacian_(&laplacian),
          layout_(system.lay_out_tangent()),
          factor_(layout_.pattern, precision()) {}

    [[nodiscard]] Solver solver() const override { return Solver::newton; }
    [[nodiscard]] int default_iteration_limit() const override { return 100; }

    [[nodiscard]] double smallest_share() const override { return reused_ ? smallest_reused_share : 1e-7; }

    /// A step of the program turns the body, and turning makes the factor of the last step a poor one: a new step
    /// begins with a new factor, but for a try now and then, which shows whether its steps are small.
    void restart() override {
        stale_ = wait_ > 0;
        trying_ = wait_ == 0;
        if (wait_ > 0) --wait_;
    }

    [[nodiscard]] bool refresh(const State& state, const Controls& controls, Care care) override {
        // The skew part belongs to the state at which it was made, and GMRES wants one matrix.
        const bool reuse = care == Care::usual && usable_ && !stale_ && !system_->has_skew();
        if (!reuse && care == Care::exact && !reused_) return false;  // it is that of this state
        reused_ = reuse;
        return reuse || factorise(state, controls, care == Care::cautious);
    }

    [[nodiscard]] Eigen::VectorXd go(const Eigen::VectorXd& x, const Eigen::VectorXd& motion) const override {
        const Eigen::VectorXd end = x + motion;
        return laplacian_->turn(*system_, {.now = x.data(), .end = end.data()});
    }

    void learn(const Eigen::VectorXd& step, const Eigen::VectorXd& change) override { memory_.learn(step, change); }

    void judge(double before, double after) override {
        stale_ = after > worth_another * before;
        if (trying_ && reused_) {
            patience_ = stale_ ? std::min(2 * patience_ + 1, longest_wait) : 0;
            wait_ = patience_;
        }
        trying_ = false;
    }

    void solve(Eigen::MatrixXd& columns) override {
        if (!system_->has_skew()) {
            memory_.apply(columns, [&](Eigen::MatrixXd& c) { solve_with_factor(c); });
            return;
        }
        for (Eigen::Index k = 0; k < columns.cols(); ++k) columns.col(k) = solve_with_skew(columns.col(k));
    }

private:
    /// A Newton step needs few digits, but the skew part wants the inverse of the very tangent.
    [[nodiscard]] linalg::Precision precision() const {
        return needs_double_ || system_->has_skew() ? linalg::Precision::double_ : linalg::Precision::single_;
    }

    void use_double() {
        needs_double_ = true;
        factor_.use(linalg::Precision::double_);
    }
    [[nodiscard]] bool is_single() const { return factor_.precision() == linalg::Precision::single_; }

    [[nodiscard]] bool factorise(const std::vector<double>& values) {
        factorised_ = &values;
        untried_ = is_single();
        return factor_.factorise(values);
    }

    /// Of a matrix that single precision refuses, double knows whether it is indefinite or only ill-conditioned. It is
    /// asked now and then, for that costs.
    [[nodiscard]] bool factorise_in_double(const std::vector<double>& values) {
        if (!is_single() || ++refusals_ % refusals_until_asked != 0) return false;
        use_double();
        if (factorise(values)) return true;
        needs_double_ = false;
        factor_.use(linalg::Precision::single_);
        return false;
    }

    /// The first solution with a factor in single precision shows how good it is.
    void solve_with_factor(Eigen::MatrixXd& columns) {
        const std::span<double> all(columns.data(), static_cast<std::size_t>(columns.size()));
        const int count = static_cast<int>(columns.cols());
        if (!untried_) return factor_.solve(all, count);
        untried_ = false;
        const Eigen::MatrixXd right = columns;
        if (factor_.solve_and_refine(*factorised_, all, count, refined_error, most_refinements)) return;
        const Eigen::MatrixXd refined = columns;
        columns = right;
        use_double();
        if (factorise(*factorised_))
            factor_.solve(all, count);
        else
            columns = refined;
    }

    /// The tangent itself or, where it is not positive definite, as much of its positive projection as it takes: a
    /// little keeps the direction in which the body wants to buckle, all of it is safe but slow.
    [[nodiscard]] bool factorise(const State& state, const Controls& controls, bool cautious) {
        make_room_for_contact(state, controls);
        memory_.clear();
        stale_ = false;
        if (system_->has_skew()) state_ = state;
        assemble(state, controls, false, values_);
        if (!cautious && (usable_ = factorise(values_) || factorise_in_double(values_))) {
            share_ = smallest_share_of_projection;
            return true;
        }
        assemble(state, controls, true, projected_);
        for (double share = cautious ? 1 : std::max(0.5 * share_, smallest_share_of_projection);;
             share = std::min(2 * share, 1.0)) {
            blended_.resize(values_.size());
            for (std::size_t k = 0; k < values_.size(); ++k)
                blended_[k] = values_[k] + share * (projected_[k] - values_[k]);
            if ((usable_ = factorise(blended_))) {
                share_ = share;
                return true;
            }
            if (share < 1) continue;
            if (!is_single()) return false;
            use_double();  // and once more
        }
    }

    /// (H + skew)^-1 b: with H^-1 as preconditioner from the right the product is v + skew H^-1 v.
    [[nodiscard]] Eigen::VectorXd solve_with_skew(const Eigen::VectorXd& b) const {
        const auto precondition = [&](Eigen::VectorXd v) {
            factor_.solve({v.data(), static_cast<std::size_t>(v.size())}, 1);
            return v;
        };
        const auto multiply = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
            return v + system_->apply_skew(state_, precondition(v));
        };
        return precondition(linalg::gmres(multiply, b, skew_tolerance, skew_limit));
    }

    /// Contact couples nodes that no element does: where a pair is new, the pattern is made and analysed again.
    void make_room_for_contact(const State& state, const Controls& controls) {
        bool grown = false;
        for (std::vector<int>& clique : system_->contact_cliques(state, controls)) {
            if (holds(clique)) continue;
            touching_.push_back(std::move(clique));
            grown = true;
        }
        if (!grown) return;
        layout_ = system_->lay_out_tangent(touching_);
        factor_ = linalg::Cholesky(layout_.pattern, precision());
        // Pairs that have parted are forgotten next time, so that the pattern does not grow without end.
        if (touching_.size() > most_remembered) touching_.clear();
    }

    /// True if the pattern couples all nodes of a clique.
    [[nodiscard]] bool holds(const std::vector<int>& clique) const {
        for (const int i : clique) {
            for (const int j : clique) {
                if (j < 0 || i < j) continue;
                if (!layout_.pattern.holds(i, j)) return false;
            }
        }
        return true;
    }

    void assemble(const State& state, const Controls& controls, bool project, std::vector<double>& values) const {
        values.assign(layout_.pattern.entries(), 0.0);
        system_->add_tangent(state, controls, layout_, values, project);
    }

    /// Of a solution: the rate at which the last digits of a state then come.
    static constexpr double refined_error = 1e-3;
    static constexpr int refusals_until_asked = 4;
    static constexpr int most_refinements = 8;  // more of them, and double precision is quicker
    static constexpr double smallest_share_of_projection = 1.0 / 16;
    /// A factorisation costs as much as some ten steps with a factor that is at hand, and gains about two digits.
    static constexpr double worth_another = 0.4;
    static constexpr double smallest_reused_share = 0.2;
    static constexpr std::size_t most_steps = 8;
    static constexpr int longest_wait = 31;
    static constexpr std::size_t most_remembered = 20000;
    static constexpr double skew_tolerance = 1e-8;
    static constexpr int skew_limit = 60;

    const Equilibrium* system_;
    const FactoredLaplacian* laplacian_;
    bool needs_double_ = false;  ///< single precision is not good enough for this body
    TangentLayout layout_;
    std::vector<double> values_;     ///< tangent
    std::vector<double> projected_;  ///< its positive projection, where it was needed
    std::vector<double> blended_;
    const std::vector<double>* factorised_ = nullptr;  ///< the one of them that the factor is of
    double share_ = smallest_share_of_projection;      ///< of the projection that was needed last
    linalg::Cholesky factor_;
    StepMemory memory_{most_steps};           ///< of the steps since the factor was made
    bool untried_ = false;                    ///< nothing has been solved with this factor in single precision
    int refusals_ = 0;                        ///< by single precision
    bool usable_ = false;                     ///< the factor solves
    bool stale_ = false;                      ///< it did not lead on quickly
    bool reused_ = false;                     ///< the present direction is not from the tangent at hand
    bool trying_ = false;                     ///< this step of the program began with the factor of the last one
    int wait_ = 0;                            ///< steps of the program until the next try
    int patience_ = 0;                        ///< what the last try left of it
    std::vector<std::vector<int>> touching_;  ///< pairs in contact that the pattern has room for
    State state_;                             ///< where the tangent was made; kept only where its skew part is needed
};

}  // namespace

std::unique_ptr<Curvature> make_newton(const Equilibrium& system, const FactoredLaplacian& laplacian) {
    return std::make_unique<Newton>(system, laplacian);
}

}  // namespace pliant::sim
