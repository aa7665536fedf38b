#include "simulation/inverse/bounded_step.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::sim::inverse {
namespace {

class Solver {
public:
    Solver(const Eigen::VectorXd& residuals, const Product& multiply, const Product& multiply_transposed,
           const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double enough)
        : multiply_(multiply),
          multiply_transposed_(multiply_transposed),
          lower_(lower),
          upper_(upper),
          enough_(enough) {
        found_.step = Eigen::VectorXd::Zero(lower.size());
        found_.change = Eigen::VectorXd::Zero(residuals.size());
        found_.gradient = multiply_transposed(residuals);
        left_ = residuals;
        gradient_ = found_.gradient;
    }

    BoundedStep solve(double tolerance) {
        const double wanted = tolerance * projected(gradient_).norm();
        const Eigen::Index most_faces = 4 * lower_.size() + 4;
        for (Eigen::Index face = 0; face < most_faces && !done_; ++face) {
            const Eigen::VectorXd downhill = -projected(gradient_);
            if (!(downhill.norm() > wanted)) break;
            search_face(downhill, wanted);
        }
        const Eigen::VectorXd begin = left_ - found_.change;
        found_.decrease = std::max(0.0, 0.5 * (begin.squaredNorm() - left_.squaredNorm()));
        return std::move(found_);
    }

private:
    [[nodiscard]] bool is_free(Eigen::Index i, double gradient) const {
        const double at = found_.step[i];
        return gradient > 0 ? at > lower_[i] : at < upper_[i];
    }
    /// The gradient without components that point out of the bounds.
    [[nodiscard]] Eigen::VectorXd projected(const Eigen::VectorXd& gradient) const {
        Eigen::VectorXd p = gradient;
        for (Eigen::Index i = 0; i < p.size(); ++i) {
            if (!is_free(i, p[i])) p[i] = 0;
        }
        return p;
    }

    /// Conjugate gradients over the entries in which `downhill` is not zero, until convergence or until one reaches a
    /// bound.
    void search_face(const Eigen::VectorXd& downhill, double wanted) {
        Eigen::VectorXd direction = downhill;
        double square = downhill.squaredNorm();
        for (Eigen::Index k = 0; k < lower_.size() + 1; ++k) {
            const Eigen::VectorXd change = multiply_(direction);
            const double curvature = change.squaredNorm();
            const double room = largest_share(direction);
            const double best = curvature > 0 ? square / curvature : room;
            const double share = std::min(best, room);
            move(share, direction, change);
            const bool solved = k + 1 == (downhill.array() != 0).count() && best < room;
            done_ = left_.norm() <= enough_ || (solved && k + 1 == lower_.size());
            if (done_) return;
            gradient_ = multiply_transposed_(left_);
            if (best >= room) return;
            Eigen::VectorXd next = -gradient_;
            for (Eigen::Index i = 0; i < next.size(); ++i) {
                if (downhill[i] == 0) next[i] = 0;
            }
            const double next_square = next.squaredNorm();
            if (!(std::sqrt(next_square) > wanted)) return;
            direction = next + next_square / square * direction;
            square = next_square;
        }
    }

    [[nodiscard]] double largest_share(const Eigen::VectorXd& direction) const {
        double share = 1e300;
        for (Eigen::Index i = 0; i < direction.size(); ++i) {
            if (direction[i] == 0) continue;
            const double bound = direction[i] > 0 ? upper_[i] : lower_[i];
            share = std::min(share, (bound - found_.step[i]) / direction[i]);
        }
        return share;
    }

    void move(double share, const Eigen::VectorXd& direction, const Eigen::VectorXd& change) {
        for (Eigen::Index i = 0; i < direction.size(); ++i) {
            if (direction[i] == 0) continue;
            double& at = found_.step[i];
            const double bound = direction[i] > 0 ? upper_[i] : lower_[i];
            const bool meets = (bound - at) / direction[i] <= share;
            at = meets ? bound : at + share * direction[i];
        }
        found_.change += share * change;
        left_ += share * change;
    }

    const Product& multiply_;
    const Product& multiply_transposed_;
    const Eigen::VectorXd& lower_;
    const Eigen::VectorXd& upper_;
    double enough_;
    bool done_ = false;
    BoundedStep found_;
    Eigen::VectorXd left_, gradient_;  ///< residuals and gradient at the step so far
};

}  // namespace

BoundedStep bounded_step(const Eigen::VectorXd& residuals, const Product& multiply, const Product& multiply_transposed,
                         const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double tolerance, double enough) {
    return Solver(residuals, multiply, multiply_transposed, lower, upper, enough).solve(tolerance);
}

}  // namespace pliant::sim::inverse
