#include "base/linalg/projected_gradients.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/linalg/dense.hpp"

namespace pliant::linalg {
namespace {

using Outcome = TwoLevel::Outcome;
using Index = Eigen::Index;

/// The constraints N^T x = d, what the preconditioner makes of them, Y = M^-1 N, and N^T Y. Normals may be of any
/// magnitude: they are scaled so that the diagonal of N^T Y is 1.
class Projection {
public:
    Projection(SmoothedLevels& levels, const TwoLevel::Constraints& constraints)
        : normals_(Eigen::Map<const Eigen::MatrixXd>(constraints.normals.data(), static_cast<Index>(levels.size()),
                                                     static_cast<Index>(constraints.wanted.size()))),
          moved_(normals_.rows(), normals_.cols()),
          scale_(normals_.cwiseAbs().colwise().maxCoeff().cwiseMax(smallest)) {
        normals_ *= scale_.cwiseInverse().asDiagonal();
        Interleaved<double> column;
        column.resize(levels.size());
        for (Index k = 0; k < normals_.cols(); ++k) {
            std::copy_n(normals_.col(k).data(), levels.size(), column.data());
            std::copy_n(levels.apply(column, 1).data(), levels.size(), moved_.col(k).data());
        }
        const Eigen::VectorXd stiffness =
            (normals_.cwiseProduct(moved_).colwise().sum().transpose()).cwiseMax(smallest).cwiseSqrt();
        for (Eigen::MatrixXd* of : {&normals_, &moved_}) *of *= stiffness.cwiseInverse().asDiagonal();
        scale_ = scale_.cwiseProduct(stiffness);
        wanted_ = Eigen::Map<const Eigen::VectorXd>(constraints.wanted.data(), scale_.size()).cwiseQuotient(scale_);
        coupling_ = normals_.transpose() * moved_;
        valid_ = symmetric_eigenpairs(coupling_).values[0] > least_independence;
        if (!valid_) return;
        inverse_ = pseudo_inverse(coupling_);
        start_ = solve(wanted_);
    }

    /// False: the normals depend on each other, or M is not positive definite.
    [[nodiscard]] bool valid() const { return valid_; }
    /// Multipliers of a motion that fulfils the constraints: Y times them.
    [[nodiscard]] const Eigen::VectorXd& start() const { return start_; }
    [[nodiscard]] Eigen::VectorXd motion(const Eigen::VectorXd& multipliers) const { return moved_ * multipliers; }
    /// Largest entry of the force that it takes in M.
    [[nodiscard]] double largest_start_force() const { return (normals_ * start_).cwiseAbs().maxCoeff(); }
    /// Its squared norm in M.
    [[nodiscard]] double squared_start() const { return wanted_.dot(start_); }
    /// Takes the part that violates the constraints out of `motion` = M^-1 force, and the same out of `force`; returns
    /// its multipliers.
    [[nodiscard]] Eigen::VectorXd project(Eigen::VectorXd& motion, Eigen::Ref<Eigen::VectorXd> force) const {
        Eigen::VectorXd multipliers = solve(normals_.transpose() * motion);
        motion -= moved_ * multipliers;
        force -= normals_ * multipliers;
        return multipliers;
    }
    /// Multipliers of the constraints as they were given.
    [[nodiscard]] Eigen::VectorXd unscaled(const Eigen::VectorXd& multipliers) const {
        return multipliers.cwiseQuotient(scale_);
    }

private:
    /// (N^T Y)^-1 measures. In single precision M is not quite symmetric, nor is N^T Y.
    [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& measures) const {
        const Eigen::VectorXd first = inverse_ * measures;
        return first + inverse_ * (measures - coupling_ * first);
    }

    static constexpr double smallest = 1e-300;          // a normal of zeros makes the projection invalid
    static constexpr double least_independence = 1e-6;  // of normals of unit length in M^-1, to single precision

    Eigen::MatrixXd normals_, moved_;     ///< (size, constraints) N, Y
    Eigen::MatrixXd coupling_, inverse_;  ///< N^T Y
    Eigen::VectorXd scale_, wanted_, start_;
    bool valid_ = false;
};

}  // namespace

Outcome project_gradients(SmoothedLevels& levels, CoarseQuality& quality, std::span<double> right_hand_side,
                          const TwoLevel::Constraints& constraints, std::span<double> multipliers, double tolerance,
                          int limit, int& iterations) {
    const Projection projection(levels, constraints);
    if (!projection.valid()) return Outcome::slow;
    const std::size_t size = levels.size();
    const Eigen::Map<Eigen::VectorXd> b(right_hand_side.data(), static_cast<Index>(size));
    const double scale = std::max(b.cwiseAbs().maxCoeff(), projection.largest_start_force());
    Eigen::Map<Eigen::VectorXd> y(multipliers.data(), static_cast<Index>(multipliers.size()));
    if (scale == 0) {
        y.setZero();
        return Outcome::solved;
    }

    Interleaved<double> residuals, directions, products;
    for (Interleaved<double>* v : {&residuals, &directions, &products}) v->resize(size);
    const auto view = [&](const Interleaved<double>& v) {
        return Eigen::Map<Eigen::VectorXd>(v.data(), static_cast<Index>(size));
    };
    Eigen::Map<Eigen::VectorXd> residual = view(residuals), direction = view(directions), product = view(products);
    Eigen::VectorXd solution = projection.motion(projection.start() / scale), correction;
    direction = solution;
    levels.matrix().multiply(directions.data(), products.data());
    residual = b / scale - product;

    Eigen::VectorXd held = Eigen::VectorXd::Zero(y.size());
    const auto precondition = [&] {
        correction = Eigen::Map<const Eigen::VectorXf>(levels.apply(residuals, 1).data(), static_cast<Index>(size))
                         .cast<double>();
        held += projection.project(correction, residual);
        return residual.dot(correction);
    };
    double left = precondition();
    const double begun = left + projection.squared_start() / (scale * scale);
    const double enough = tolerance * tolerance * begun;
    direction = correction;
    for (int k = 1; left > enough; ++k) {
        if (k > limit) return Outcome::slow;
        ++iterations;
        levels.matrix().multiply(directions.data(), products.data());
        const double curvature = direction.dot(product);
        if (!(curvature > 0)) return Outcome::indefinite;
        solution += left / curvature * direction;
        residual -= left / curvature * product;
        const double now = precondition();
        if (levels.is_turned() && now > enough && quality.is_outdated(k, begun, now, enough)) return Outcome::slow;
        if (!levels.is_turned() && now > 0 && now <= enough) quality.learn(k, begun, now);
        direction = correction + now / left * direction;
        left = now;
    }
    if (!(left >= 0)) return Outcome::slow;
    std::copy_n(solution.data(), size, right_hand_side.data());
    Eigen::Map<Eigen::VectorXd>(right_hand_side.data(), static_cast<Index>(size)) *= scale;
    y = scale * projection.unscaled(held);
    return Outcome::solved;
}

}  // namespace pliant::linalg
