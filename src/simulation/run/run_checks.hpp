// Checks of a run beyond equilibrium: jumps, unstable states, surfaces that intersect, gaps that have closed.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/run/stability.hpp"
#include "simulation/run/trajectory.hpp"
#include "simulation/stepper/stepper.hpp"

namespace pliant::sim {

/// State of the checks that carries over between steps.
struct ChecksState {
    Moment reported;                       ///< after the last step of the program
    double last_way = 0;                   ///< norm of the motion of all nodes in this step, m
    std::vector<std::size_t> before_jump;  ///< indices of the steps just before a jump
    std::set<std::size_t> warned;          ///< cables with a closed gap
};

/// Both must outlive it.
class RunChecks {
public:
    RunChecks(Stepper& stepper, const Program& program, const RobotState& rest);

    /// For quasi-static programs, after each step: detects whether the robot jumped. If the program gives an
    /// imperfection, it also moves on from an unstable equilibrium to a stable one.
    void after_step(RobotState& robot, Step& step, StepReport& report, std::vector<std::string>& warnings,
                    const Progress& progress);
    /// Warns of gaps that have closed between two guide points: from here on the flanks would touch.
    void warn_of_closed_gaps(const RobotState& robot, int step, std::vector<std::string>& warnings);
    /// Warns, once, of a static step that counts as converged although the loads are not carried: where they are within
    /// the rounding of much larger forces, as between very stiff and very soft materials.
    void warn_of_uncarried_loads(const RobotState& robot, int step, std::vector<std::string>& warnings) const;
    /// Checks for intersecting surfaces in every 32nd step and the last, because a search takes half as long as a step,
    /// and, once found, backwards to the last step without.
    void look_for_crossings(const RobotState& robot, std::vector<Step>& steps, bool last) const;
    /// At the end: checks what an equilibrium leaves free (left_open.hpp), and the stability of the last state and of
    /// those before a jump. The first unstable step is found by bisection; checking every step would take as long as
    /// the steps.
    void at_end(const RobotState& robot, Trajectory& result);

    [[nodiscard]] const ChecksState& state() const { return state_; }
    void set_state(ChecksState state) { state_ = std::move(state); }

private:
    [[nodiscard]] State state_of(const Step& step) const;
    void warn_of_open_places(const RobotState& robot, Trajectory& result) const;
    [[nodiscard]] bool is_unstable(const RobotState& robot, const Step& step);
    [[nodiscard]] bool jumped(const RobotState& robot, const Progress& progress);
    [[nodiscard]] bool leave(RobotState& robot, const Eigen::VectorXd& motion, StepReport& report,
                             const Progress& progress);

    Stepper& stepper_;
    const Equilibrium& system_;
    const Program& program_;
    Stability stability_;
    ChecksState state_;
    double size_ = 0;  ///< size of the robot at rest, m
};

/// Advice for a program that stopped before `time`; empty if none is known.
[[nodiscard]] std::string advice(Stepper& stepper, const Program& program, const RobotState& robot, double time,
                                 const Progress& progress);

}  // namespace pliant::sim
