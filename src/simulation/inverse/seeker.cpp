#include "simulation/inverse/seeker.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/text.hpp"

namespace pliant::sim::inverse {
namespace {

constexpr double aim = 0.7;            // of the tolerances: solver noise must not undo a reached goal
constexpr double first_radius = 0.25;  // shares of the ranges
constexpr double largest_radius = 1, smallest_radius = 1e-6;
constexpr double no_gain = 0.01;                         // of a tolerance: a further step would not help
constexpr double good = 0.75, poor = 0.25, none = 1e-4;  // ratios of actual to predicted decrease
constexpr double most_bent = 3;                          // times the length of the step at which the curvature was
                                                         // measured
constexpr double quick = 0.15;      // remaining cost after a step with a linearisation that may be reused
constexpr int slack_rounds = 3;     // per step: taking cables for slack may let others push
constexpr int most_moves = 60;      // for one waypoint
constexpr double price_room = 0.1;  // of the cost at one tolerance
constexpr double widened = 30;      // tolerances while the penalty is being lowered
constexpr int price_rounds = 4;
constexpr double cancels = 0.05;  // share of a sum's terms that may remain where they cancel: the search stops early

/// Distance from the goals, in tolerances.
double distance(double cost) {
    return std::sqrt(2 * std::max(cost, 0.0));
}

}  // namespace

/// One search for the minimum cost.
struct Seeker::Search {
    std::size_t waypoint;
    const Bounds* bounds;
    Point base;  ///< the waypoint before
    Point now;
    Eigen::VectorXd residuals;
    double cost = 0;
    PriceTerm price{};
    bool fresh = false;          ///< the sensitivity was computed at `now`
    Eigen::VectorXd gradient{};  ///< at `now`, where fresh
    std::string no_state{};      ///< why the last move failed; empty if it did not
    bool cancelled = false;
    int trials = 0;  ///< number of equilibria solved for
    [[nodiscard]] bool is_priced() const { return price.factor > 0; }
};

struct Seeker::Trial {
    std::optional<Point> point;  ///< the last state reached
    bool arrived = false;
    std::string reason;
};

Seeker::Seeker(Stepper& stepper, const InverseTask& task)
    : stepper_(&stepper),
      task_(&task),
      space_(stepper, task),
      rows_(stepper, task, space_),
      has_memory_(stepper.system().has_friction() || stepper.system().has_cable_friction()),
      radius_(first_radius) {}

Work Seeker::work() const {
    Work work = work_;
    if (sensitivity_) work.solutions += sensitivity_->solutions();
    return work;
}

Bounds Seeker::whole_range() const {
    const auto count = static_cast<std::size_t>(space_.size());
    return {Eigen::VectorXd::Zero(space_.size()), Eigen::VectorXd::Ones(space_.size()), std::vector<bool>(count, false),
            std::vector<bool>(count, false)};
}

void Seeker::limit_iterations(int most) {
    last_iteration_ = most > 0 ? work_.iterations + most : 0;
}

StepReport Seeker::drive(RobotState& robot, const Inputs& inputs, const Progress& progress, const State* expected) {
    ++work_.forward;
    const int left = last_iteration_ > 0 ? std::max(1, last_iteration_ - work_.iterations) : 0;
    StepReport report = stepper_->drive(robot, inputs, progress, expected, {}, left);
    work_.iterations += report.iterations;
    return report;
}

std::optional<Point> Seeker::move(const Point& from, const Eigen::VectorXd& inputs, double time, const Bounds& bounds,
                                  const Progress& progress, std::string* why) {
    Point to{from.robot, inputs};
    const StepReport report = drive(to.robot, space_.inputs(inputs, time), progress);
    if (!report.arrived) {
        ++work_.failed;
        if (why != nullptr) *why = report.reason;
        return std::nullopt;
    }
    space_.take_up(to.robot, to.inputs, bounds.lower, bounds.upper);
    return to;
}

double Seeker::cost(const Point& at, std::size_t waypoint) const {
    return 0.5 * rows_.values(at.robot, at.inputs, waypoint, PriceTerm{}).squaredNorm();
}

double Seeker::cost_of(const Search& search, const Point& point, Eigen::VectorXd& residuals) const {
    residuals = rows_.values(point.robot, point.inputs, search.waypoint, search.price);
    return 0.5 * residuals.squaredNorm();
}

Found Seeker::seek(const Point& start, const Point& before, std::size_t waypoint, const Bounds& bounds,
                   const Progress& progress) {
    Search search{waypoint, &bounds, before, start, {}};
    search.cost = cost_of(search, search.now, search.residuals);
    radius_ = std::max(radius_, first_radius);
    if (last_end_.size() == 0 || start.inputs != last_end_) bend_.reset();
    minimise(search, progress);
    is_proven_ = has_memory_ || search.trials <= 1;  // linearisations do not capture friction, but Broyden updates do
    last_end_ = search.now.inputs;
    Found found;
    const auto all_reached = [&] {
        found.goals = rows_.goals(search.now.robot, waypoint);
        return std::ranges::all_of(found.goals, [](const GoalState& goal) { return goal.reached; });
    };
    found.reached = all_reached();
    found.cost = search.cost;
    if (!found.reached)
        found.limits = search.cancelled ? std::vector<Limit>{{Limit::Kind::cancelled, "", ""}} : limits(search);
    else if (rows_.has_prices() && !search.cancelled) {
        lower_price(search, progress);
        found.reached = all_reached();
    }
    found.point = std::move(search.now);
    found.cancelled = search.cancelled;
    return found;
}

/// The solutions of the goals form curves, which can only be followed in long steps if the goals may be missed
/// slightly: each round first lowers the penalty with wider tolerances, then returns to the goals by the shortest step.
/// A round is discarded if it does not end at a lower penalty with all goals reached.
void Seeker::lower_price(Search& search, const Progress& progress) {
    search.price.before = search.base.inputs;
    double last = rows_.price(search.now.robot, search.now.inputs, search.price.before);
    for (int round = 0; round < price_rounds && last > 0 && !search.cancelled; ++round) {
        const Search kept = search;
        search.price.factor = price_room / last;
        search.price.goals = 1 / widened;
        search.cost = cost_of(search, search.now, search.residuals);
        minimise(search, progress);
        search.price.factor = 0;
        search.price.goals = 1;
        search.cost = cost_of(search, search.now, search.residuals);
        minimise(search, progress);
        const double price = rows_.price(search.now.robot, search.now.inputs, search.price.before);
        if (!(distance(search.cost) <= 1) || !(price < last)) {
            const bool cancelled = search.cancelled;
            search = kept;
            search.cancelled = cancelled;
            break;
        }
        if (price > 0.95 * last) break;
        last = price;
    }
}

/// True if the sensitivity treats every cable as it is, taut or slack.
bool Seeker::treats_as_it_is(const Point& point) const {
    for (Eigen::Index i = 0; i < space_.size(); ++i) {
        if (space_.is_slack(point.robot, i) == pulls_[static_cast<std::size_t>(i)]) return false;
    }
    return true;
}

void Seeker::use_rows(const Search& search) {
    sensitivity_->use(rows_.gradients(sensitivity_->at(), search.waypoint, search.price));
}

/// Linearises at `now`. The length of a slack cable has no effect until it is taut: cables that help by pulling are
/// treated as taut.
bool Seeker::linearise(Search& search) {
    const auto count = static_cast<std::size_t>(space_.size());
    std::vector<bool> pulled(count, false);
    std::vector<std::size_t> slack_inputs, slack_cables;
    for (std::size_t i = 0; i < count; ++i) {
        const auto at = static_cast<Eigen::Index>(i);
        if (!space_.is_slack(search.now.robot, at)) continue;
        const bool longer = space_.drives_longer(at);
        const double now = search.now.inputs[at];
        if (!(longer ? now > search.bounds->lower[at] : now < search.bounds->upper[at])) continue;
        slack_inputs.push_back(i);
        slack_cables.push_back(space_.input(at).actuator);
    }
    ++work_.linearised;
    if (sensitivity_) work_.solutions += sensitivity_->solutions();
    sensitivity_.reset();
    auto made = Sensitivity::create(*stepper_, space_, search.now.robot);
    if (!made) return false;
    sensitivity_.emplace(std::move(*made));
    use_rows(search);
    price_factor_ = search.price.factor;
    if (!slack_cables.empty()) {
        const Eigen::VectorXd by_tension = sensitivity_->by_tensions(search.residuals, slack_cables);
        std::vector<std::size_t> helpful;
        for (std::size_t k = 0; k < slack_inputs.size(); ++k) {
            if (!(by_tension[static_cast<Eigen::Index>(k)] < 0)) continue;
            pulled[slack_inputs[k]] = true;
            helpful.push_back(slack_cables[k]);
        }
        if (!helpful.empty()) {
            sensitivity_->tighten(space_, helpful);
            use_rows(search);
        }
    }
    pulls_.assign(count, true);
    for (std::size_t i = 0; i < count; ++i)
        pulls_[i] = pulled[i] || !space_.is_slack(search.now.robot, static_cast<Eigen::Index>(i));
    search.fresh = true;
    return true;
}

Seeker::Trial Seeker::attempt(const Search& search, const Eigen::VectorXd& step, const Progress& progress) {
    Eigen::VectorXd wanted = search.now.inputs + step;
    for (Eigen::Index i = 0; i < wanted.size(); ++i) {
        wanted[i] = std::clamp(wanted[i], search.bounds->lower[i], search.bounds->upper[i]);
        // Slack cables are paid out as the others move, and taken up again afterwards.
        if (!pulls_[static_cast<std::size_t>(i)])
            wanted[i] = space_.drives_longer(i) ? search.bounds->upper[i] : search.bounds->lower[i];
    }
    const Point& from = has_memory_ ? search.base : search.now;
    Trial trial;
    Point to{from.robot, wanted};
    std::optional<State> expected;  // with friction the result depends on the initial guess, as later in the program
    if (!has_memory_) expected = sensitivity_->expected(*stepper_, search.now.robot.now.state, step);
    const Inputs inputs = space_.inputs(wanted, task_->times[search.waypoint]);
    const StepReport report = drive(to.robot, inputs, progress, expected ? &*expected : nullptr);
    trial.arrived = report.arrived;
    trial.reason = report.reason;
    if (!report.arrived) {
        ++work_.failed;
        if (report.pieces == 0 || has_memory_) return trial;
        to.inputs = from.inputs + to.robot.now.along * (wanted - from.inputs);
    }
    space_.take_up(to.robot, to.inputs, search.bounds->lower, search.bounds->upper);
    trial.point = std::move(to);
    return trial;
}

/// The best step from residuals within the bounds and the trust region; inputs not treated as pulling stay fixed.
BoundedStep Seeker::bounded(const Search& search, const Eigen::VectorXd& residuals) {
    Eigen::VectorXd lower = search.bounds->lower - search.now.inputs, upper = search.bounds->upper - search.now.inputs;
    for (Eigen::Index i = 0; i < space_.size(); ++i) {
        const bool pulls = pulls_[static_cast<std::size_t>(i)];
        lower[i] = pulls ? std::clamp(lower[i], -radius_, 0.0) : 0.0;
        upper[i] = pulls ? std::clamp(upper[i], 0.0, radius_) : 0.0;
        // A cable that is only treated as taut has no effect when paid out.
        if (space_.is_slack(search.now.robot, i)) (space_.drives_longer(i) ? upper : lower)[i] = 0;
    }
    constexpr double accuracy = 1e-4;
    BoundedStep step = bounded_step(
        residuals, [&](const Eigen::VectorXd& v) { return sensitivity_->multiply(v); },
        [&](const Eigen::VectorXd& w) { return sensitivity_->multiply_transposed(w); }, lower, upper, accuracy,
        search.is_priced() ? 0 : 0.1 * aim);
    step.decrease = search.cost - 0.5 * (residuals + step.change).squaredNorm();
    return step;
}

/// Cables that are treated as taut and would push after the step.
std::vector<std::size_t> Seeker::pushing(const Search& search, const Eigen::VectorXd& step) {
    std::vector<std::size_t> cables;
    const Eigen::VectorXd expected = sensitivity_->expected_multipliers(search.now.robot.now.state, step);
    for (Eigen::Index i = 0; i < space_.size(); ++i) {
        const std::size_t a = space_.input(i).actuator;
        if (!pulls_[static_cast<std::size_t>(i)] || !space_.can_slacken(search.now.robot, i)) continue;
        if (expected[static_cast<Eigen::Index>(a)] < 0) cables.push_back(static_cast<std::size_t>(i));
    }
    return cables;
}

/// A step that takes the tension of cables below zero is computed again with these cables slack.
BoundedStep Seeker::best_step(const Search& search) {
    slackened_.clear();
    Eigen::VectorXd released = sensitivity_->release({}, search.now.robot.now.state);
    BoundedStep best = bent(search, released);
    const Eigen::VectorXd gradient = best.gradient;
    for (int round = 0; round < slack_rounds; ++round) {
        const std::vector<std::size_t> more = pushing(search, best.step);
        if (more.empty()) break;
        for (const std::size_t i : more) {
            pulls_[i] = false;
            slackened_.push_back(space_.input(static_cast<Eigen::Index>(i)).actuator);
        }
        sensitivity_->slacken(space_, slackened_);
        use_rows(search);
        released = sensitivity_->release(slackened_, search.now.robot.now.state);
        best = bent(search, released);
    }
    best.change += released;
    best.gradient = gradient;
    return best;
}

/// The best step with the residuals' nonlinear part as it was observed on the step to this waypoint, unless that makes
/// little sense here. `beside`: a change of the residuals besides that of the step.
BoundedStep Seeker::bent(const Search& search, const Eigen::VectorXd& beside) {
    const Eigen::VectorXd residuals = search.residuals + beside;
    const BoundedStep straight = bounded(search, residuals);
    const double share = share_of_bend(search, straight.step);
    if (share == 0) return straight;
    BoundedStep bent = bounded(search, residuals + share * share * bend_->miss);
    bent.gradient = straight.gradient;
    return bent.decrease > good * straight.decrease ? bent : straight;
}

/// A step's length along the one that the bend was observed on; 0 where that says nothing about it.
double Seeker::share_of_bend(const Search& search, const Eigen::VectorXd& step) const {
    if (has_memory_ || search.is_priced() || search.trials > 0 || !bend_) return 0;
    const double share = bend_->step.dot(step) / bend_->step.squaredNorm();
    return std::fabs(share) < most_bent ? share : 0;
}

/// True if the inputs are these, other than those of cables that are treated as slack.
bool Seeker::is_at(const Point& point, const Eigen::VectorXd& inputs) const {
    for (Eigen::Index i = 0; i < inputs.size(); ++i) {
        if (pulls_[static_cast<std::size_t>(i)] && !(std::fabs(point.inputs[i] - inputs[i]) < 1e-9)) return false;
    }
    return true;
}

/// Accepts the trial if it is better, and adapts the trust region. True: the sensitivity can be used for another step.
bool Seeker::judge(Search& search, const BoundedStep& step, Trial trial) {
    Eigen::VectorXd residuals;
    const double cost = trial.point ? cost_of(search, *trial.point, residuals) : 1e300;
    const double ratio = (search.cost - cost) / step.decrease;
    const double length = step.step.lpNorm<Eigen::Infinity>();
    if (!trial.arrived || (ratio < poor && search.fresh))
        radius_ = 0.3 * length;
    else if (ratio > good && length > 0.9 * radius_)
        radius_ = std::min(2 * radius_, largest_radius);
    search.no_state = trial.arrived ? "" : trial.reason;
    // Cables that were taken for slack at the end of a long step need not be so after a short one.
    if (!(ratio > none)) return search.fresh && slackened_.empty();
    const bool as_asked = trial.arrived && is_at(*trial.point, search.now.inputs + step.step);
    if (as_asked) {
        const Eigen::VectorXd miss = residuals - search.residuals - step.change;
        // The slope at the end of a parabola deviates by twice as much as the chord.
        sensitivity_->learn(step.step, 2 * miss);
        if (search.trials == 0 && !search.is_priced()) bend_ = Bend{step.step, miss};
    }
    const bool was_quick = cost <= quick * search.cost;
    search.now = std::move(*trial.point);
    search.residuals = std::move(residuals);
    search.cost = cost;
    search.fresh = false;
    return as_asked && was_quick && treats_as_it_is(search.now);
}

void Seeker::minimise(Search& search, const Progress& progress) {
    search.fresh = false;
    search.no_state.clear();
    bool usable = sensitivity_ && is_proven_ && price_factor_ == search.price.factor && treats_as_it_is(search.now);
    for (int moves = 0; moves < most_moves && radius_ > smallest_radius;) {
        if (!search.is_priced() && distance(search.cost) <= aim) return;
        if ((search.cancelled = progress.cancelled()) || is_used_up()) return;
        if (!usable && !linearise(search)) return;
        const BoundedStep step = best_step(search);
        const bool solved = sensitivity_->status().has_value();
        const double gain = distance(search.cost) - distance(search.cost - step.decrease);
        const bool worth_it = solved && (search.is_priced() ? step.decrease > no_gain * price_room : gain > no_gain);
        if (solved && search.fresh) search.gradient = step.gradient;
        if (!worth_it) {
            if (search.fresh) return;
            usable = false;  // the linearisation at the current state is needed
            continue;
        }
        ++moves;
        Trial trial = attempt(search, step.step, progress);
        if (progress.cancelled() && !trial.arrived) {
            search.cancelled = true;
            return;
        }
        usable = judge(search, step, std::move(trial));
        ++search.trials;
    }
}

Seeker::Help Seeker::help_of(const Search& search, std::size_t cable) {
    if (!search.fresh || !sensitivity_) return Help::pushes;
    const Eigen::VectorXd by_tension = sensitivity_->rows_by_tension(cable);
    const Eigen::VectorXd shares = search.residuals.cwiseProduct(by_tension);
    const double least = cancels * shares.lpNorm<1>();
    if (shares.sum() < -least) return Help::pulls;
    // None, too, where no goal depends on the tension, as before anything touches.
    return shares.sum() > least ? Help::pushes : Help::none;
}

/// A slack cable may be too long to pull, even at the short end of its bounds.
std::optional<Limit> Seeker::limit_of_slack(const Search& search, Eigen::Index i) {
    constexpr double rounding = 1e-9;
    const std::string& name = space_.input(i).name;
    const Help help = help_of(search, space_.input(i).actuator);
    if (help == Help::pushes) return Limit{Limit::Kind::slack, name, ""};
    const bool longer = space_.drives_longer(i);
    const double at = search.now.inputs[i];
    const bool shortest = longer ? at < search.bounds->lower[i] + rounding : at > search.bounds->upper[i] - rounding;
    if (help == Help::none || !shortest) return std::nullopt;
    const bool by_rate = (longer ? search.bounds->rate_lower : search.bounds->rate_upper)[static_cast<std::size_t>(i)];
    return Limit{by_rate ? Limit::Kind::rate : longer ? Limit::Kind::lower : Limit::Kind::upper, name, ""};
}

/// (goals) of (inputs): what each goal alone asks of the inputs, the gradient of its part of the cost. Empty if it is
/// not known, or with one goal.
std::vector<Eigen::VectorXd> Seeker::gradients_of_goals(const Search& search) {
    std::vector<Eigen::VectorXd> gradients;
    if (!search.fresh || !sensitivity_ || task_->goals.size() < 2) return gradients;
    const std::vector<std::size_t> goal_of_row = rows_.goals_of_rows(search.now.robot, search.waypoint);
    for (std::size_t g = 0; g < task_->goals.size(); ++g) {
        Eigen::VectorXd own = Eigen::VectorXd::Zero(search.residuals.size());
        for (std::size_t r = 0; r < goal_of_row.size(); ++r) {
            const auto at = static_cast<Eigen::Index>(r);
            if (goal_of_row[r] == g) own[at] = search.residuals[at];
        }
        gradients.push_back(sensitivity_->multiply_transposed(own));
        for (Eigen::Index i = 0; i < space_.size(); ++i) {
            // The length of a slack cable changes nothing, while a tension would.
            if (!space_.is_slack(search.now.robot, i) || pulls_[static_cast<std::size_t>(i)]) continue;
            gradients.back()[i] = sensitivity_->by_tensions(own, {space_.input(i).actuator})[0];
        }
    }
    return gradients;
}

/// The goals of which what brings one nearer takes another away; "" if there are none.
std::string Seeker::contradicting_goals(const std::vector<Eigen::VectorXd>& gradients) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(space_.size());
    double largest = 0, lengths = 0;
    for (const Eigen::VectorXd& gradient : gradients) {
        sum += gradient;
        largest = std::max(largest, gradient.norm());
        lengths += gradient.norm();
    }
    std::vector<std::string> names;
    for (std::size_t g = 0; g < gradients.size(); ++g)
        if (gradients[g].norm() > cancels * largest) names.push_back("\"" + task_->goals[g].name + "\"");
    return names.size() > 1 && sum.norm() < cancels * lengths ? join_names(names) : "";
}

std::vector<Limit> Seeker::limits(const Search& search) {
    std::vector<Limit> limits;
    constexpr double matters = 1e-3;  // of the largest entry that the gradient could have
    const double least = matters * search.gradient.lpNorm<Eigen::Infinity>();
    const std::vector<Eigen::VectorXd> of_goals = gradients_of_goals(search);
    const auto is_cancelled = [&](Eigen::Index i) {
        double asked = 0;
        for (const Eigen::VectorXd& gradient : of_goals) asked += std::fabs(gradient[i]);
        return std::fabs(search.gradient[i]) < cancels * asked;
    };
    for (Eigen::Index i = 0; i < search.gradient.size(); ++i) {
        const double downhill = -search.gradient[i];
        const auto k = static_cast<std::size_t>(i);
        const std::string& name = space_.input(i).name;
        constexpr double rounding = 1e-9;
        const bool wants_longer = (downhill > 0) == space_.drives_longer(i);
        const bool slack = space_.is_slack(search.now.robot, i);
        if (slack && (!pulls_[k] || wants_longer)) {
            if (std::optional<Limit> limit = limit_of_slack(search, i)) limits.push_back(*std::move(limit));
            continue;
        }
        if (!(std::fabs(downhill) > least) || is_cancelled(i)) continue;
        if (downhill > 0 && search.now.inputs[i] > search.bounds->upper[i] - rounding)
            limits.push_back({search.bounds->rate_upper[k] ? Limit::Kind::rate : Limit::Kind::upper, name, ""});
        if (downhill < 0 && search.now.inputs[i] < search.bounds->lower[i] + rounding)
            limits.push_back({search.bounds->rate_lower[k] ? Limit::Kind::rate : Limit::Kind::lower, name, ""});
    }
    if (limits.empty() && search.no_state.empty()) {
        if (std::string names = contradicting_goals(of_goals); !names.empty())
            limits.push_back({Limit::Kind::goals, "", std::move(names)});
    }
    if (!search.no_state.empty()) limits.push_back({Limit::Kind::no_state, "", search.no_state});
    return limits;
}

}  // namespace pliant::sim::inverse
