#include "simulation/solver/prescribed_approach.hpp"

#include <algorithm>

namespace pliant::sim {
namespace {

constexpr int most_pieces = 30;
constexpr double least_piece = 0.01;      // of the remaining path; below it the robot does not yield
constexpr double probe_share = 1e-3;      // of the free path ahead, to probe the effect of the motion
constexpr double kept_J = 0.3;            // of the smallest det F
constexpr StepSettings between{1e-2, 8};  // approximate equilibrium is enough before the next increment

/// Increment by increment, for supports and obstacles alike.
class Approach {
public:
    Approach(const Equilibrium& system, const FactoredLaplacian& laplacian, const Controls& from, const Controls& to,
             State& state)
        : system_(system), newton_(make_newton(system, laplacian)), to_(to), now_(to), state_(state) {
        now_.obstacles = from.obstacles;
    }

    [[nodiscard]] bool run(const Progress& progress) {
        for (int piece = 0; piece < most_pieces && !progress.cancelled(); ++piece) {
            Eigen::VectorXd motion = ahead();
            if (!answer(motion)) return false;
            const double share = step(motion);
            if (share < least_piece) return false;
            if (share == 1) return true;
            (void)solve_step(system_, *newton_, now_, between, state_, progress);
        }
        return false;
    }

private:
    /// (3n) the remaining path of the supports.
    [[nodiscard]] Eigen::VectorXd ahead() const {
        Eigen::VectorXd end = state_.x;
        system_.place_supports(to_, end);
        return end - state_.x;
    }

    [[nodiscard]] Controls with_obstacles(double share) const {
        Controls controls = now_;
        controls.obstacles += share * (to_.obstacles - now_.obstacles);
        return controls;
    }

    [[nodiscard]] double free_share(const Eigen::VectorXd& motion) const {
        return system_.largest_step(state_.x, motion, now_, to_.obstacles - now_.obstacles);
    }

    /// Adds to the supports' motion the motion of the free nodes that keeps their forces unchanged: the change of force
    /// for a small share of it, solved with the tangent. False: there is no tangent, or the path ahead is blocked.
    [[nodiscard]] bool answer(Eigen::VectorXd& motion) {
        if (!newton_->refresh(state_, now_, TangentChoice::quickest, {})) return false;
        const double probe = probe_share * free_share(motion);
        State probed{state_.x + probe * motion, state_.multiplier};
        const Evaluation here = system_.evaluate(state_, now_), there = system_.evaluate(probed, with_obstacles(probe));
        if (!(probe > 0) || !here.possible() || !there.possible()) return false;
        Eigen::MatrixXd column = system_.restrict_to_free((there.out_of_balance - here.out_of_balance) / probe);
        newton_->solve(column);
        if (!column.allFinite()) return false;
        system_.add_free(column.col(0), -1, motion);
        return true;
    }

    /// Moves until something would touch or a tet would nearly invert; returns the share of the motion.
    [[nodiscard]] double step(const Eigen::VectorXd& motion) {
        const double least_J = kept_J * system_.evaluate(state_, now_).min_J;
        for (double share = free_share(motion); share >= least_piece; share *= 0.5) {
            State next{state_.x + share * motion, state_.multiplier};
            Controls controls = with_obstacles(share);
            if (share == 1) {
                controls.obstacles = to_.obstacles;
                system_.place_supports(to_, next.x);
            }
            const Evaluation there = system_.evaluate(next, controls);
            if (!there.possible() || !(there.min_J > least_J)) continue;
            state_ = std::move(next);
            now_ = std::move(controls);
            return share;
        }
        return 0;
    }

    const Equilibrium& system_;
    std::unique_ptr<Curvature> newton_;
    const Controls& to_;
    Controls now_;
    State& state_;
};

}  // namespace

bool approach(const Equilibrium& system, const FactoredLaplacian& laplacian, const Controls& from, const Controls& to,
              State& state, const Progress& progress) {
    return Approach(system, laplacian, from, to, state).run(progress);
}

}  // namespace pliant::sim
