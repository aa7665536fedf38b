#include "simulation/solver/friction_rounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "simulation/solver/line_search.hpp"

namespace pliant::sim {
namespace {

constexpr double cable_share = 0.1;  // of the tolerance, for the length of a cable with friction
// A round is only solved as well as the friction that it is solved with is likely to be.
constexpr double first_tolerance = 30;    // of the tolerance, and the most that any round has
constexpr double share_of_misfit = 0.3;   // of the round before
constexpr double loose_residual = 10;     // of the tolerance, if sliding contact alternates between states
constexpr double loose_cable_length = 1;  // likewise

/// Difference between the friction used in the solve and that of the resulting state.
struct Misfit {
    double residual, length;
    [[nodiscard]] bool within(double tolerance, double most_residual, double most_length) const {
        return residual <= most_residual * tolerance && length <= most_length * tolerance;
    }
    [[nodiscard]] std::string text(double tolerance) const {
        std::string out =
            fmt::format("friction and the forces that it depends on do not settle: residual {:.2g}", residual);
        if (length > cable_share * tolerance)
            out += fmt::format(", a cable off by {:.2g} of its length at rest", length);
        return out + fmt::format(", tolerance {:.2g}", tolerance);
    }
};

/// Where contact friction is frozen for the next round: at the last solution or, where solutions alternate between two
/// states, at the point between them that Aitken's relaxation gives (Irons and Tuck 1969, for vectors).
class FrozenState {
public:
    explicit FrozenState(Eigen::VectorXd x) : x_(std::move(x)) {}

    /// `solution`: with friction frozen at x(). Whether x() then lies between solutions.
    [[nodiscard]] bool advance(const Eigen::VectorXd& solution) {
        const Eigen::VectorXd off = solution - x_;
        // The first one includes the motion of the step itself.
        if (rounds_++ > 1) {
            const Eigen::VectorXd change = off - off_;
            const double squared = change.squaredNorm();
            if (squared > 0) share_ = std::clamp(-share_ * off_.dot(change) / squared, least_share, 1.0);
            if (share_ > settles_anyway) share_ = 1;
        }
        off_ = off;
        if (share_ == 1)
            x_ = solution;
        else
            x_ += share_ * off;
        return share_ < 1;
    }
    [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }
    /// Friction is frozen at that solution after all.
    void restart(const Eigen::VectorXd& solution) { *this = FrozenState(solution); }

private:
    static constexpr double least_share = 0.3, settles_anyway = 0.75;
    Eigen::VectorXd x_, off_;
    double share_ = 1;
    int rounds_ = 0;
};

/// What lets sliding contact settle.
std::string remedy(const Equilibrium& system) {
    const contact::Contact* contact = system.model().contact(true);
    if (!system.has_friction() || contact == nullptr) return {};
    return fmt::format(". A longer contact.slip (here {:.3g} mm) or shorter steps let it settle",
                       1e3 * contact->settings().slip_m);
}

}  // namespace

bool rounds_are_vain(std::span<const double> misfits, int most, double wanted) {
    constexpr std::size_t rounds_to_judge = 8;
    const std::size_t done = misfits.size();
    if (done < rounds_to_judge) return false;
    const double now = misfits[done - 1], two_before = misfits[done - 3];
    const double pairs_left = (most - static_cast<double>(done)) / 2;
    return now > wanted && now * std::pow(now / two_before, pairs_left) > wanted;
}

StepOutcome settle_friction(const Equilibrium& system, SolverChain& solvers, const StepSettings& settings, int rounds,
                            const StepStart& start, Controls& controls, State& next, const Progress& progress,
                            std::optional<Evaluation> known) {
    const std::vector<Drive> wanted = controls.drives;
    const bool cables_drag = system.has_cable_friction(), rubs = cables_drag || system.has_friction();
    const bool in_rounds = rubs || !controls.object_stress.empty();
    controls.shares = start.controls.shares;
    if (cables_drag) system.freeze_cable_friction(next.x, wanted, start.drives, controls);
    controls.friction = system.freeze_friction(start.state, start.state, start.controls, start.controls);
    if (rubs) known.reset();
    StepOutcome total;
    std::vector<double> misfits;
    FrozenState frozen(start.state.x);
    StepSettings of_round = settings;
    if (cables_drag || (controls.friction && !controls.friction->pairs().empty()))
        of_round.tolerance *= first_tolerance;
    for (int round = 1; round <= rounds; ++round) {
        if (round == rounds) of_round.tolerance = settings.tolerance;
        StepOutcome outcome =
            solvers.solve(system, controls, of_round, next, progress, std::exchange(known, std::nullopt));
        outcome.iterations += total.iterations;
        outcome.history.insert(outcome.history.begin(), total.history.begin(), total.history.end());
        total = std::move(outcome);
        if (!total.converged || !in_rounds) break;
        const bool held = constraints_hold(total.evaluation, settings.tolerance);
        controls.friction = system.freeze_friction(next, start.state, controls, start.controls);
        if (cables_drag) system.freeze_cable_friction(next.x, wanted, start.drives, controls);
        if (!controls.object_stress.empty()) controls.object_stress = system.object_stress(start.state.x, next.x);
        total.evaluation = system.evaluate(next, controls);
        const Misfit misfit{total.evaluation.residual, system.cable_friction_error(next, wanted)};
        if (held && misfit.within(settings.tolerance, 1, cable_share)) break;
        misfits.push_back(misfit.residual);
        of_round.tolerance =
            std::clamp(share_of_misfit * misfit.residual, settings.tolerance, first_tolerance * settings.tolerance);
        if (round < rounds && !rounds_are_vain(misfits, rounds, loose_residual * settings.tolerance)) {
            if (controls.friction && frozen.advance(next.x)) {
                if (system.is_free(next.x, frozen.x() - next.x, controls))
                    controls.friction =
                        system.freeze_friction({frozen.x(), next.multiplier}, start.state, controls, start.controls);
                else
                    frozen.restart(next.x);
            }
            continue;
        }
        total.converged = total.loose = misfit.within(settings.tolerance, loose_residual, loose_cable_length);
        total.reason = misfit.text(settings.tolerance) + remedy(system);
        break;
    }
    return total;
}

}  // namespace pliant::sim
