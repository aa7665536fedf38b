// Moves the actuators until the goals of one waypoint are met: a Gauss-Newton method with bounds and a trust region,
// which accepts or rejects steps by equilibria that were actually solved for.
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

/// An equilibrium and its inputs.
struct Point {
    RobotState robot;
    Eigen::VectorXd inputs;  ///< (inputs) as shares of the ranges
};

/// Bounds of each input, as shares of its range.
struct Bounds {
    Eigen::VectorXd lower, upper;
    std::vector<bool> rate_lower, rate_upper;  ///< the bound comes from the rate, not from the range
};

/// What keeps the robot from its goals.
struct Limit {
    enum class Kind {
        lower,     ///< end of the range
        upper,     ///< likewise
        rate,      ///< largest rate of change
        slack,     ///< the cable is slack: it would have to push
        goals,     ///< goals contradict each other
        no_state,  ///< no equilibrium was found beyond this
        cancelled  ///< nothing: the search was cancelled
    };
    Kind kind = Kind::lower;
    std::string input;   ///< which input; empty for goals, no_state and cancelled
    std::string reason;  ///< for no_state; for goals their names
};

struct Found {
    Point point;
    double cost = 0;  ///< half the sum of squared residuals, without penalties
    std::vector<GoalState> goals;
    bool reached = false;
    bool cancelled = false;
    std::vector<Limit> limits;  ///< if not reached; empty: the actuators only move the robot in other directions
};

/// Cost of the search.
struct Work {
    int forward = 0;     ///< number of equilibria solved for
    int failed = 0;      ///< of these: not found
    int iterations = 0;  ///< of the solver, for all of them
    int linearised = 0;  ///< states at which the equations were linearised and factorised
    int solutions = 0;   ///< solves with those equations
};

/// Keeps its approximation of the sensitivities from one waypoint to the next.
class Seeker {
public:
    /// Both must outlive it.
    Seeker(Stepper& stepper, const InverseTask& task);

    [[nodiscard]] const InputSpace& space() const { return space_; }
    [[nodiscard]] const GoalRows& rows() const { return rows_; }
    [[nodiscard]] Work work() const;
    /// From here on the solver may take so many iterations: what needs more is not found, and a search ends where it
    /// is. 0: as many as it takes.
    void limit_iterations(int most);

    /// Solves for the equilibrium at these inputs and program time, ramping linearly from the current one. Empty: there
    /// is no equilibrium along the ramp, or it was cancelled; `why` says so. Slack is taken up within the bounds.
    [[nodiscard]] std::optional<Point> move(const Point& from, const Eigen::VectorXd& inputs, double time,
                                            const Bounds& bounds, const Progress& progress, std::string* why = nullptr);
    [[nodiscard]] Bounds whole_range() const;

    /// Searches from `start`, which is at the waypoint's time. `before`: the previous waypoint, or rest; changes of
    /// inputs are measured from it and, with friction, every path starts there, as a step of a program will.
    [[nodiscard]] Found seek(const Point& start, const Point& before, std::size_t waypoint, const Bounds& bounds,
                             const Progress& progress);

    /// Half the sum of the squared misses of the goals at a state, each in tolerances: what seek() makes small.
    [[nodiscard]] double cost(const Point& at, std::size_t waypoint) const;

private:
    struct Search;
    struct Trial;
    [[nodiscard]] StepReport drive(RobotState& robot, const Inputs& inputs, const Progress& progress,
                                   const State* expected = nullptr);
    [[nodiscard]] bool is_used_up() const { return last_iteration_ > 0 && work_.iterations >= last_iteration_; }
    void minimise(Search& search, const Progress& progress);
    void lower_price(Search& search, const Progress& progress);
    [[nodiscard]] bool linearise(Search& search);
    [[nodiscard]] bool treats_as_it_is(const Point& point) const;
    [[nodiscard]] Trial attempt(const Search& search, const Eigen::VectorXd& step, const Progress& progress);
    void use_rows(const Search& search);
    [[nodiscard]] BoundedStep bounded(const Search& search, const Eigen::VectorXd& residuals);
    [[nodiscard]] BoundedStep bent(const Search& search, const Eigen::VectorXd& beside);
    [[nodiscard]] double share_of_bend(const Search& search, const Eigen::VectorXd& step) const;
    [[nodiscard]] std::vector<std::size_t> pushing(const Search& search, const Eigen::VectorXd& step);
    [[nodiscard]] BoundedStep best_step(const Search& search);
    [[nodiscard]] bool is_at(const Point& point, const Eigen::VectorXd& inputs) const;
    [[nodiscard]] bool judge(Search& search, const BoundedStep& step, Trial trial);
    [[nodiscard]] std::vector<Limit> limits(const Search& search);
    /// What a tension of a slack cable would do, as far as that is known.
    enum class Help { pulls, pushes, none };
    [[nodiscard]] Help help_of(const Search& search, std::size_t cable);
    [[nodiscard]] std::optional<Limit> limit_of_slack(const Search& search, Eigen::Index i);
    [[nodiscard]] std::vector<Eigen::VectorXd> gradients_of_goals(const Search& search);
    [[nodiscard]] std::string contradicting_goals(const std::vector<Eigen::VectorXd>& gradients) const;
    [[nodiscard]] double cost_of(const Search& search, const Point& point, Eigen::VectorXd& residuals) const;

    Stepper* stepper_;
    const InverseTask* task_;
    InputSpace space_;
    GoalRows rows_;
    bool has_memory_;  ///< with friction the path matters
    std::optional<Sensitivity> sensitivity_;
    std::vector<bool> pulls_;  ///< (inputs) which cables the sensitivity treats as taut; true for all other inputs
    std::vector<std::size_t> slackened_;  ///< actuators that the current step takes for slack at its end
    double price_factor_ = 0;             ///< penalty factor in the sensitivity's rows
    bool is_proven_ = false;  ///< one step led to the last waypoint, so the sensitivity may be reused for the next one
    struct Bend {
        Eigen::VectorXd step;  ///< (inputs)
        Eigen::VectorXd miss;  ///< (rows) deviation of the solved residuals from the linear prediction
    };
    std::optional<Bend> bend_;  ///< of the first step from the previous waypoint
    Eigen::VectorXd last_end_;  ///< (inputs) at the end of the last search
    double radius_ = 0;
    Work work_;
    int last_iteration_ = 0;  ///< of `work_`; 0: no limit
};

}  // namespace pliant::sim::inverse
