#include "simulation/inverse/follow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/core/stopwatch.hpp"
#include "simulation/run/describe.hpp"

namespace pliant::sim::inverse {
namespace {

Work operator-(const Work& a, const Work& b) {
    return {a.forward - b.forward, a.failed - b.failed, a.iterations - b.iterations, a.linearised - b.linearised,
            a.solutions - b.solutions};
}

/// Bounds of each input after `seconds`: its range, restricted by its rate.
Bounds bounds_from(const Seeker& seeker, const Point& before, double seconds) {
    Bounds bounds = seeker.whole_range();
    const Eigen::VectorXd change = seeker.space().largest_change(seconds);
    for (Eigen::Index i = 0; i < change.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        bounds.rate_lower[k] = before.inputs[i] - change[i] > 0;
        bounds.rate_upper[k] = before.inputs[i] + change[i] < 1;
        bounds.lower[i] = std::max(0.0, before.inputs[i] - change[i]);
        bounds.upper[i] = std::min(1.0, before.inputs[i] + change[i]);
    }
    return bounds;
}

/// The corners of the unit cube or, where these are many, its points with one input at one of its ends and all others
/// at rest.
std::vector<Eigen::VectorXd> corners(const Eigen::VectorXd& rest) {
    constexpr Eigen::Index few = 4;
    std::vector<Eigen::VectorXd> points;
    if (rest.size() <= few) {
        for (unsigned corner = 0; corner < (1U << static_cast<unsigned>(rest.size())); ++corner) {
            Eigen::VectorXd& point = points.emplace_back(rest.size());
            for (Eigen::Index i = 0; i < rest.size(); ++i) point[i] = (corner >> static_cast<unsigned>(i)) & 1U;
        }
        return points;
    }
    for (Eigen::Index i = 0; i < rest.size(); ++i) {
        for (const double end : {0.0, 1.0}) points.emplace_back(rest)[i] = end;
    }
    return points;
}

class Follower {
public:
    Follower(Stepper& stepper, const InverseTask& task, const FollowOptions& options, Progress& progress)
        : stepper_(stepper), task_(task), options_(options), progress_(progress), seeker_(stepper, task) {}

    InverseResult run() {
        for (std::size_t k = 0; k < task_.waypoints() && result_.message.empty(); ++k) {
            progress_.advance("finding inputs", static_cast<double>(k) / static_cast<double>(task_.waypoints()));
            Stopwatch watch;
            const Work before = seeker_.work();
            const std::optional<Found> found = k == 0 ? first() : next(k);
            if (!found) break;
            now_ = found->point;
            keep(*found, k, seeker_.work() - before, watch.read_s());
            if (found->cancelled) stop(k);
        }
        progress_.advance("finding inputs", 1);
        result_.reached = result_.waypoints.size() == task_.waypoints() &&
                          std::ranges::all_of(result_.waypoints, [](const Waypoint& w) { return w.reached; });
        return std::move(result_);
    }

private:
    void stop(std::size_t waypoint) {
        result_.cancelled = true;
        result_.message = fmt::format("cancelled at waypoint {} of {}", waypoint + 1, task_.waypoints());
    }

    /// Starts beside the search from rest share a number of iterations, and one of them may take only a part: where
    /// bodies buckle or fold, one equilibrium can take thousands. Robots with four actuators take 300 to 700 for all.
    /// True if there are some for one more, to which the seeker is then limited.
    bool may_start() {
        constexpr int of_all = 1500, of_one = 400;
        const int spent = seeker_.work().iterations - before_starts_;
        seeker_.limit_iterations(std::min(of_one, of_all - spent));
        given_up_ = spent >= of_all;
        return !given_up_;
    }

    /// Inputs in whose equilibria the goals of the first waypoint are nearest, of the corners of the ranges and of more
    /// points spread over them; the nearest first. Goals out of reach are often nearest to a corner, and searches from
    /// elsewhere may end in another one.
    std::vector<Eigen::VectorXd> nearest_places(const Point& rest, const Bounds& all) {
        constexpr int more_points = 16;
        constexpr std::size_t tried = 4;
        const Eigen::Index size = seeker_.space().size();
        std::vector<Eigen::VectorXd> places = corners(rest.inputs);
        constexpr double same = 1e-9;
        const auto is_rest = [&](const Eigen::VectorXd& p) {
            return (p - rest.inputs).lpNorm<Eigen::Infinity>() < same;
        };
        std::erase_if(places, is_rest);  // the search began there
        for (int n = 1; n <= more_points; ++n) places.push_back(spread_point(options_.starts + n, size));
        std::vector<std::pair<double, std::size_t>> by_cost;
        for (std::size_t k = 0; k < places.size() && !progress_.cancelled() && may_start(); ++k) {
            if (const auto at = seeker_.move(rest, places[k], task_.times[0], all, progress_))
                by_cost.emplace_back(seeker_.cost(*at, 0), k);
        }
        std::ranges::sort(by_cost);
        std::vector<Eigen::VectorXd> nearest;
        for (std::size_t k = 0; k < std::min(tried, by_cost.size()); ++k) nearest.push_back(places[by_cost[k].second]);
        return nearest;
    }

    std::optional<Found> first() {
        const Point rest{stepper_.rest(), seeker_.space().rest()};
        std::string why;
        const Bounds all = seeker_.whole_range();
        const auto begin = seeker_.move(rest, rest.inputs, task_.times[0], all, progress_, &why);
        std::optional<Found> best;
        if (begin) best = seeker_.seek(*begin, rest, 0, all, progress_);
        const double from_rest = best ? best->cost : 0;
        const auto is_done = [&] { return (best && best->reached) || progress_.cancelled(); };
        const auto try_from = [&](const Eigen::VectorXd& inputs, const std::string& name) {
            const auto start = seeker_.move(rest, inputs, task_.times[0], all, progress_);
            if (!start) return;
            Found other = seeker_.seek(*start, rest, 0, all, progress_);
            // Far goals are missed by much anyway, and nearer by a thousandth is nearer; less may be the solver's
            // noise.
            constexpr double clearly = 0.999;
            if (best && !other.reached && !(other.cost < clearly * best->cost)) return;
            if (begin && (other.reached || other.cost < clearly * from_rest))
                note_ =
                    fmt::format("from rest the path to the first waypoint ended further away; {} came nearer", name);
            best = std::move(other);
        };
        before_starts_ = seeker_.work().iterations;
        for (int n = 0; n < options_.starts && !is_done() && may_start(); ++n)
            try_from(spread_point(n + 1, seeker_.space().size()),
                     fmt::format("start {} of {} spread over the ranges", n + 1, options_.starts));
        if (options_.starts > 0 && !is_done() && may_start()) {
            for (const Eigen::VectorXd& inputs : nearest_places(rest, all))
                if (!is_done() && may_start()) try_from(inputs, "a start from the nearest of many more equilibria");
        }
        seeker_.limit_iterations(0);
        if (!note_.empty()) result_.notes.push_back(note_);
        if (given_up_ && !is_done())
            result_.notes.emplace_back(
                "not all starts were tried, since equilibria take long to find there; there may be inputs that come "
                "nearer to the first waypoint");
        if (progress_.cancelled() && !(best && best->reached)) {
            stop(0);
            return std::nullopt;
        }
        if (!best) result_.message = fmt::format("the robot has no equilibrium to begin with: {}", why);
        return best;
    }

    std::optional<Found> next(std::size_t k) {
        Point begin = now_;
        const double seconds = task_.times[k] - task_.times[k - 1];
        const Bounds bounds = bounds_from(seeker_, now_, seconds);
        if (seconds > 0) {
            std::string why;
            const auto moved = seeker_.move(now_, now_.inputs, task_.times[k], bounds, progress_, &why);
            if (!moved) {
                if (progress_.cancelled()) return stop(k), std::nullopt;
                result_.message = fmt::format("stopped at waypoint {} of {}: {}", k + 1, task_.waypoints(), why);
                return std::nullopt;
            }
            begin = *moved;
        } else {
            // What the rate left slack before may be taken up now.
            seeker_.space().take_up(begin.robot, begin.inputs, bounds.lower, bounds.upper);
        }
        return seeker_.seek(begin, now_, k, bounds, progress_);
    }

    void keep(const Found& found, std::size_t k, const Work& work, double wall_s) {
        Waypoint waypoint{found.reached, found.goals, {}, found.limits, {}, work, wall_s};
        const RobotState& robot = found.point.robot;
        for (Eigen::Index i = 0; i < found.point.inputs.size(); ++i)
            waypoint.values.push_back(seeker_.space().value(i, found.point.inputs[i]));
        waypoint.state.index = static_cast<int>(k) + 1;
        waypoint.state.time = task_.times[k];
        waypoint.state.wall_s = wall_s;
        describe(stepper_.model(), stepper_.system(), robot.now.state, robot.controls, robot.evaluation,
                 waypoint.state);
        result_.waypoints.push_back(std::move(waypoint));
    }

    Stepper& stepper_;
    const InverseTask& task_;
    FollowOptions options_;
    Progress& progress_;
    Seeker seeker_;
    Point now_;
    std::string note_;
    int before_starts_ = 0;  ///< iterations of the search from rest
    bool given_up_ = false;  ///< not all starts were tried
    InverseResult result_;
};

}  // namespace

InverseResult follow(Stepper& stepper, const InverseTask& task, const FollowOptions& options, Progress& progress) {
    return Follower(stepper, task, options, progress).run();
}

std::string text(const Limit& limit) {
    switch (limit.kind) {
        case Limit::Kind::lower:
            return limit.input + " is at the lower end of its range";
        case Limit::Kind::upper:
            return limit.input + " is at the upper end of its range";
        case Limit::Kind::rate:
            return limit.input + " changes as fast as its rate allows";
        case Limit::Kind::slack:
            return limit.input + " is slack, and would have to push";
        case Limit::Kind::goals:
            return "goals " + limit.reason + " contradict each other: what brings one nearer takes the other away";
        case Limit::Kind::cancelled:
            return "the search was cancelled here";
        case Limit::Kind::no_state:
            break;
    }
    return "no equilibrium was found further on: " + limit.reason;
}

bool Waypoint::is_unfinished() const {
    return std::ranges::any_of(limits, [](const Limit& limit) { return limit.kind == Limit::Kind::cancelled; });
}

std::vector<std::string> reasons(const Waypoint& waypoint) {
    std::vector<std::string> lines;
    for (const Limit& limit : waypoint.limits) lines.push_back(text(limit));
    if (!waypoint.reached && lines.empty()) lines.emplace_back("no small change of the inputs brings it nearer");
    return lines;
}

Eigen::VectorXd spread_point(int n, Eigen::Index size) {
    Eigen::VectorXd point(size);
    int base = 1;
    for (double& entry : point) {
        const auto is_prime = [](int p) {
            for (int q = 2; q * q <= p; ++q) {
                if (p % q == 0) return false;
            }
            return true;
        };
        do ++base;
        while (!is_prime(base));
        entry = 0;
        double digit = 1;
        for (int rest = n; rest > 0; rest /= base) {
            digit /= base;
            entry += digit * (rest % base);
        }
    }
    return point;
}

}  // namespace pliant::sim::inverse
