// Moves the actuators until the goals of one waypoint are met: a Gauss-Newton method within bounds, in a trust region
// that decides on equilibria which have been solved for.
//
// docs/theory.md, "Inverse kinematics", has the equations.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/inverse/bounded_step.hpp"
#include "simulation/inverse/goal_rows.hpp"
#include "simulation/inverse/sensitivity.hpp"

namespace pliant::sim::inverse {

/// An equilibrium, and the inputs that it is of.
struct Point {
    RobotState robot;
    Eigen::VectorXd inputs;  ///< (inputs) shares of the ranges
};

/// Where each input may go, in shares of its range.
struct Bounds {
    Eigen::VectorXd lower, upper;
    std::vector<bool> rate_lower, rate_upper;  ///< it is the rate that ends there, not the range
};

/// What keeps the goals out of reach.
struct Limit {
    enum class Kind {
        lower,     ///< end of the range
        upper,     ///< likewise
        rate,      ///< largest change
        slack,     ///< it would have to push, and is a cable
        no_state,  ///< no equilibrium was found further on
    };
    Kind kind = Kind::lower;
    std::string input;   ///< which; empty for no_state
    std::string reason;  ///< of no_state
};

struct Found {
    Point point;
    double cost = 0;  ///< half the sum of squared residuals, without prices
    std::vector<GoalState> goals;
    bool reached = false;
    bool cancelled = false;
    std::vector<Limit> limits;  ///< where not reached; empty: the actuators only move the robot in other directions
};

/// How much work it was.
struct Work {
    int forward = 0;     ///< equilibria that were solved for
    int failed = 0;      ///< of them, not found
    int linearised = 0;  ///< states whose equations were linearised and factorised
    int solutions = 0;   ///< with those equations
};

/// Keeps what it knows of the sensitivities from one waypoint to the next.
class Seeker {
public:
    /// Both must outlive it.
    Seeker(Stepper& stepper, const InverseTask& task);

    [[nodiscard]] const InputSpace& space() const { return space_; }
    [[nodiscard]] const GoalRows& rows() const { return rows_; }
    [[nodiscard]] Work work() const;

    /// The robot under these inputs at this time of the program, on a straight way from where it is. Nothing: there is
    /// no equilibrium on the way, or it was cancelled; `why` says so.
    [[nodiscard]] std::optional<Point> move(const Point& from, const Eigen::VectorXd& inputs, double time,
                                            const Progress& progress, std::string* why = nullptr);
    [[nodiscard]] Bounds whole_range() const;

    /// From `start`, which is at the waypoint's time. `before`: the waypoint before, or rest, from which changes count
    /// and, where friction acts, every way begins, as a step of a program will.
    [[nodiscard]] Found seek(const Point& start, const Point& before, std::size_t waypoint, const Bounds& bounds,
                             const Progress& progress);

private:
    struct Search;
    struct Trial;
    void minimise(Search& search, const Progress& progress);
    void lower_price(Search& search, const Progress& progress);
    [[nodiscard]] bool linearise(Search& search);
    [[nodiscard]] bool treats_as_it_is(const Point& point) const;
    [[nodiscard]] Trial attempt(const Search& search, const Eigen::VectorXd& step, const Progress& progress);
    [[nodiscard]] BoundedStep best_step(const Search& search);
    [[nodiscard]] bool judge(Search& search, const BoundedStep& step, Trial trial);
    [[nodiscard]] std::vector<Limit> limits(const Search& search) const;
    [[nodiscard]] double cost_of(const Search& search, const Point& point, Eigen::VectorXd& residuals) const;

    Stepper* stepper_;
    const InverseTask* task_;
    InputSpace space_;
    GoalRows rows_;
    bool has_memory_;  ///< friction: the way there matters
    std::optional<Sensitivity> sensitivity_;
    std::vector<bool> pulls_;  ///< (inputs) cables that the sensitivity takes for taut, and all other inputs
    double price_factor_ = 0;  ///< that the sensitivity's rows have
    bool is_proven_ = false;   ///< one step led to the last waypoint: the sensitivity may serve for the next one
    struct Bend {
        Eigen::VectorXd step;  ///< (inputs)
        Eigen::VectorXd miss;  ///< (rows) what was found beyond what is linear
    };
    std::optional<Bend> bend_;  ///< of the step that led off from the waypoint before
    Eigen::VectorXd last_end_;  ///< (inputs) where the last search ended
    double radius_ = 0;
    Work work_;
};

}  // namespace pliant::sim::inverse
