#include "simulation/identify/least_squares.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/linalg/dense.hpp"

namespace pliant::sim::identify {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Steps shorter than this in u are not tried, nor those with a smaller predicted relative decrease of |r|^2.
constexpr double shortest_step = 1e-10;
constexpr double least_gain = 1e-12;
/// A smaller predicted relative decrease that is not achieved is attributed to noise in the residuals.
constexpr double doubtful_gain = 1e-6, doubtful_step = 1e-6;
constexpr double largest_damping = 1e10;

class Minimiser {
public:
    Minimiser(const LeastSquaresProblem& problem, const VectorXd& start) : problem_(problem), u_(start) {}

    [[nodiscard]] Result<LeastSquaresEnd> run() {
        auto first = ask(u_);
        if (!first) return tl::unexpected(first.error());
        if (!*first) return failure("there is no solution where the search begins");
        r_ = std::move(**first);
        scale_ = VectorXd::Zero(u_.size());
        bool going_on = true;
        while (going_on) {
            auto jacobian = problem_.jacobian();
            if (!jacobian) return tl::unexpected(jacobian.error());
            J_ = std::move(*jacobian);
            for (Index j = 0; j < u_.size(); ++j) scale_[j] = std::max(scale_[j], J_.col(j).norm());
            const Result<bool> improved = improve();
            if (!improved) return tl::unexpected(improved.error());
            going_on = *improved;
        }
        return LeastSquaresEnd{u_, r_, J_, trials_, converged_};
    }

private:
    [[nodiscard]] Result<std::optional<VectorXd>> ask(const VectorXd& u) {
        ++trials_;
        return problem_.residuals(u);
    }

    /// Unknowns that have an effect, and that no bound blocks in the descent direction.
    [[nodiscard]] std::vector<Index> free() const {
        const VectorXd gradient = J_.transpose() * r_;
        const double largest = scale_.maxCoeff();
        std::vector<Index> all;
        for (Index j = 0; j < u_.size(); ++j) {
            const bool held =
                (u_[j] <= problem_.low[j] && gradient[j] > 0) || (u_[j] >= problem_.high[j] && gradient[j] < 0);
            if (!held && J_.col(j).norm() > 1e-13 * largest) all.push_back(j);
        }
        return all;
    }

    /// The damped step of the free unknowns, given that the others have moved by `whole`.
    [[nodiscard]] VectorXd step(const std::vector<Index>& free, const VectorXd& whole) const {
        const auto count = static_cast<Index>(free.size());
        MatrixXd A = MatrixXd::Zero(J_.rows() + count, count);
        VectorXd b = VectorXd::Zero(A.rows());
        b.head(J_.rows()) = -(r_ + J_ * whole);
        for (Index k = 0; k < count; ++k) {
            const Index j = free[static_cast<std::size_t>(k)];
            A.col(k).head(J_.rows()) = J_.col(j);
            A(J_.rows() + k, k) = std::sqrt(damping_) * scale_[j];
        }
        return linalg::least_squares(A, b);
    }

    /// Unknowns that would cross a bound are fixed there and the others re-optimised; finally the whole step is scaled
    /// to its limit.
    [[nodiscard]] VectorXd step_within_bounds(std::vector<Index> free) const {
        VectorXd whole = VectorXd::Zero(u_.size());
        while (!free.empty()) {
            const VectorXd s = step(free, whole);
            std::vector<Index> inside;
            VectorXd cut = whole;
            for (std::size_t k = 0; k < free.size(); ++k) {
                const Index j = free[k];
                const double end = u_[j] + s[static_cast<Index>(k)];
                cut[j] = std::clamp(end, problem_.low[j], problem_.high[j]) - u_[j];
                if (end >= problem_.low[j] && end <= problem_.high[j]) inside.push_back(j);
            }
            if (inside.size() == free.size()) {
                whole = cut;
                break;
            }
            for (const Index j : free) whole[j] = std::ranges::find(inside, j) == inside.end() ? cut[j] : 0;
            free = std::move(inside);
        }
        const double longest = whole.cwiseAbs().maxCoeff();
        return longest > problem_.longest_step ? VectorXd(problem_.longest_step / longest * whole) : whole;
    }

    /// Takes one step that decreases the residuals; false: there is none.
    [[nodiscard]] Result<bool> improve() {
        const double now = r_.squaredNorm();
        for (;;) {
            const std::vector<Index> unknowns = free();
            converged_ = true;
            if (unknowns.empty() || now == 0) return false;
            const VectorXd s = step_within_bounds(unknowns);
            const double size = s.cwiseAbs().maxCoeff();
            const double promised = now - (r_ + J_ * s).squaredNorm();
            if (!(size > shortest_step) || !(promised > least_gain * now)) return false;
            converged_ = trials_ < problem_.most_trials;
            if (!converged_) return false;
            auto next = ask((u_ + s).cwiseMax(problem_.low).cwiseMin(problem_.high));
            if (!next) return tl::unexpected(next.error());
            const double gain = *next ? now - (*next)->squaredNorm() : -1;
            if (gain > 0) {
                if (gain > 0.75 * promised) damping_ /= 10;
                if (gain < 0.25 * promised) damping_ *= 3;
                u_ = (u_ + s).cwiseMax(problem_.low).cwiseMin(problem_.high);
                r_ = std::move(**next);
                return true;
            }
            const bool doubtful = *next && (promised < doubtful_gain * now || size < doubtful_step);
            damping_ = std::max(damping_, 1e-6) * 10;
            if (doubtful || damping_ > largest_damping) return converged_ = true, false;
        }
    }

    const LeastSquaresProblem& problem_;
    VectorXd u_, r_, scale_;
    MatrixXd J_;
    double damping_ = 1e-4;
    int trials_ = 0;
    bool converged_ = false;
};

}  // namespace

Result<LeastSquaresEnd> minimise(const LeastSquaresProblem& problem, const VectorXd& start) {
    return Minimiser(problem, start).run();
}

}  // namespace pliant::sim::identify
